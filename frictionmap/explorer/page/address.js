// The view in the address, so that a link restores it, and in requests to the server.

import { hasUnit } from "./field.js";

/**
 * What the page shows.
 * @typedef {object} View
 * @property {[number, number]} r          range across: of the frequency ratio, or of the belt speed without a load
 * @property {[number, number]} beta       range of the friction ratio
 * @property {number} mu                   static over kinetic friction
 * @property {string} start                "rest" or "moving"
 * @property {string} contact              key of the contact
 * @property {Object<string, number>} numbers  what sliders have changed
 * @property {string} quantity             what the cells are coloured by
 * @property {[number, number] | null} cell    the cell that is kept, r and beta
 * @property {"" | "r" | "beta"} cut       along what the response curve goes
 * @property {"" | "on"} lecture           whether type is large, and little else than map and motion is shown
 */

/** The view that a scene begins with. @returns {View} */
export function firstView(scene) {
  return {
    r: [...scene.r],
    beta: [...scene.beta],
    mu: scene.mu,
    start: scene.start,
    contact: scene.contacts[0].key,
    numbers: {},
    quantity: scene.quantities[0].key,
    cell: null,
    cut: "",
    lecture: "",
  };
}

/** A key or a value of an address; commas, colons and brackets stay readable. */
function escaped(text) {
  return encodeURIComponent(text).replace(/%(2C|3A|5B|5D)/g, (code) => decodeURIComponent(code));
}

function joined(pairs) {
  return pairs.map(([key, value]) => `${escaped(key)}=${escaped(String(value))}`).join("&");
}

/** Keys of a view that determine its cells, as sent to the server. */
function pairsOf(view, scene) {
  const pairs = [[scene.across.key, view.r.join(",")], ["beta", view.beta.join(",")]];
  if (scene.sliders.some(({ key }) => key === "mu")) pairs.push(["mu", view.mu]);
  if (view.start !== scene.start) pairs.push(["start", view.start]);
  if (view.contact !== scene.contacts[0].key) pairs.push(["contact", view.contact]);
  return [...pairs, ...Object.entries(view.numbers)];
}

/** Key of the system of a view: equal keys give the same motion in a cell. @param {View} view */
export function systemKey({ mu, start, contact, numbers }) {
  return JSON.stringify([mu, start, contact, Object.entries(numbers).sort()]);
}

/** Key of the colours of cells: system and quantity. @param {View} view */
export function cellsKey(view) {
  return `${systemKey(view)} ${view.quantity}`;
}

/** Key of a picture: cells and ranges. @param {View} view */
export function pictureKey(view) {
  return `${cellsKey(view)} ${view.r} ${view.beta}`;
}

/** The query of a view, with further keys. @param {View} view */
export function queryOf(view, scene, further = {}) {
  return joined([...pairsOf(view, scene), ...Object.entries(further)]);
}

/** The query of typed numbers: units depend on the contact of the view. @param {View} view */
export function typedQuery(view, scene, given) {
  const contact = view.contact === scene.contacts[0].key ? {} : { contact: view.contact };
  return joined(Object.entries({ ...contact, ...given }));
}

/** The part of an address behind #. @param {View} view */
export function hashOf(view, scene) {
  const pairs = pairsOf(view, scene);
  if (view.quantity !== scene.quantities[0].key) pairs.push(["quantity", view.quantity]);
  if (view.cell) pairs.push(["cell", view.cell.join(",")]);
  if (view.cut) pairs.push(["cut", view.cut]);
  if (view.lecture) pairs.push(["lecture", view.lecture]);
  return `#${joined(pairs)}`;
}

/** Keys whose values differ in two addresses. */
export function changedKeys(before, after) {
  const [old, now] = [before, after].map((hash) => new URLSearchParams(hash.replace(/^#/, "")));
  return [...new Set([...old.keys(), ...now.keys()])].filter((key) => old.get(key) !== now.get(key)).sort().join();
}

/** Keys of an address whose numbers may have units, with those of a query. */
function keysWithUnits(scene) {
  const { key: across } = scene.across;
  return new Map([[across, across], ["beta", "beta"], ["cell", "at"], ...scene.sliders.map(({ key }) => [key, key])]);
}

/** Whether a number of an address has a unit. */
export function addressHasUnits(hash, scene) {
  const keys = keysWithUnits(scene);
  return [...new URLSearchParams(hash.replace(/^#/, ""))].some(([key, text]) => keys.has(key) && text.split(",").some(hasUnit));
}

/**
 * An address with ratios in the place of numbers with units; what the server refuses is left out.
 * @param {(given: object) => Promise<object>} convert
 * @returns {Promise<{hash: string, wrong: string[]}>}
 */
export async function addressInRatios(hash, scene, convert) {
  const keys = keysWithUnits(scene);
  const wrong = [];
  const pairs = [];
  for (const pair of hash.replace(/^#/, "").split("&")) {
    const [[key, text] = ["", ""]] = new URLSearchParams(pair);
    if (!keys.has(key) || !text.split(",").some(hasUnit)) {
      pairs.push(pair);
      continue;
    }
    try {
      const name = keys.get(key);
      pairs.push(joined([[key, (await convert({ [name]: text }))[name]]]));
    } catch (error) {
      wrong.push(error.message);
    }
  }
  return { hash: `#${pairs.join("&")}`, wrong };
}

/** Longest invalid value that a message quotes. */
const LONGEST = 40;

/** Numbers with commas between them, if they are so many, finite and right; else undefined. */
function numbersOf(text, count, right) {
  const parts = text.split(",");
  const numbers = parts.map(Number);
  const known = parts.length === count && parts.every((part) => part.trim()) && numbers.every(Number.isFinite);
  return known && right(...numbers) ? numbers : undefined;
}

/**
 * Parser and valid values of a key of an address.
 * @typedef {object} Key
 * @property {(text: string) => any} read  the value, or undefined
 * @property {string} valid                valid values, in words
 */

/** @returns {Key} */
function range() {
  const read = (text) => numbersOf(text, 2, (low, high) => low >= 0 && low < high);
  return { read, valid: "two increasing numbers >= 0 separated by a comma" };
}

/** @returns {Key} */
function cell() {
  return { read: (text) => numbersOf(text, 2, (r, beta) => r > 0 && beta >= 0), valid: "r > 0 and beta >= 0 separated by a comma" };
}

/** @returns {Key} */
function choice(words) {
  return { read: (text) => (words.includes(text) ? text : undefined), valid: `one of ${words.join(", ")}` };
}

/** A number as a slider has it: only mass and stiffness ratios may lie below the slider's least. @returns {Key} */
function number({ least, scale }) {
  const ratio = scale === "log";
  const right = (value) => (ratio ? value > 0 : value >= least);
  return { read: (text) => numbersOf(text, 1, right)?.[0], valid: `a number ${ratio ? "> 0" : `>= ${least}`}` };
}

/** One of the places of a slider that has no others. @returns {Key} */
function place(places) {
  return { read: (text) => numbersOf(text, 1, (value) => places.includes(value))?.[0], valid: `one of ${places.join(", ")}` };
}

/** The keys of an address; a page that keeps maps for some places of its sliders has no others to offer. @returns {Map<string, Key>} */
function validKeys(scene, places) {
  const shown = [[scene.across.key, range()], ["beta", range()], ["quantity", choice(scene.quantities.map(({ key }) => key))], ["cell", cell()]];
  const lecture = ["lecture", choice(["on"])];
  if (places) return new Map([...shown, lecture, ...scene.sliders.map(({ key }) => [key, place(places[key])])]);
  return new Map([
    ...shown,
    ["start", choice(["rest", "moving"])],
    ["contact", choice(scene.contacts.map(({ key }) => key))],
    ...(scene.unloaded ? [] : [["cut", choice(["r", "beta"])]]),
    lecture,
    ...scene.sliders.map((slider) => [slider.key, number(slider)]),
  ]);
}

/** What a view has under a key of an address. */
function valueIn(view, key, scene) {
  const slider = scene.sliders.find((one) => one.key === key);
  const value = key === scene.across.key ? view.r : key in view ? view[key] : view.numbers[key] ?? slider.value;
  return String(value ?? "") || "none";
}

/** Message about an invalid key of an address, and the value used instead. */
function fault(view, scene, keys, key, text) {
  const got = text.length > LONGEST ? `${text.slice(0, LONGEST)}…` : text;
  if (!keys.has(key)) return `unknown key '${key.slice(0, LONGEST)}', ignored; valid: ${[...keys.keys()].join(", ")}`;
  return `${key} must be ${keys.get(key).valid}; got ${got || "nothing"}; used: ${valueIn(view, key, scene)}`;
}

/**
 * The view of an address; missing and invalid keys have the values with which the scene begins.
 * @param {Object<string, number[]> | null} [places]  those of the sliders, if maps are kept for them only
 * @returns {{view: View, wrong: string[]}}  one message for each invalid key
 */
export function viewOf(hash, scene, places = null) {
  const view = firstView(scene);
  const keys = validKeys(scene, places);
  const faults = [];
  for (const [key, text] of new URLSearchParams(hash.replace(/^#/, ""))) {
    const value = keys.get(key)?.read(text);
    if (value === undefined) faults.push([key, text]);
    else if (key === scene.across.key) view.r = value;
    else if (key in view) view[key] = value;
    else view.numbers[key] = value;
  }
  return { view, wrong: faults.map(([key, text]) => fault(view, scene, keys, key, text)) };
}

/** Ends of a range with no more digits than can be seen. */
export function tidy([low, high]) {
  const digits = Math.min(15, Math.max(0, 4 - Math.floor(Math.log10(high - low))));
  return [Number(Math.max(0, low).toFixed(digits)), Number(high.toFixed(digits))];
}
