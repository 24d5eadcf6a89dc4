// The view in the address, so that a link brings it back; and as the server is asked for it.

/**
 * What the page shows.
 * @typedef {object} View
 * @property {[number, number]} r          range of the frequency ratio
 * @property {[number, number]} beta       range of the friction ratio
 * @property {number} mu                   static over kinetic friction
 * @property {string} start                "rest" or "moving"
 * @property {string} contact              key of the contact
 * @property {Object<string, number>} numbers  what sliders have changed
 * @property {string} quantity             what the cells are coloured by
 * @property {[number, number] | null} cell    the cell that is kept, r and beta
 * @property {"" | "r" | "beta"} cut       along what the response curve goes
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
  };
}

/** A key or a value of an address; commas, colons and brackets stay readable. */
function escaped(text) {
  return encodeURIComponent(text).replace(/%(2C|3A|5B|5D)/g, (code) => decodeURIComponent(code));
}

function joined(pairs) {
  return pairs.map(([key, value]) => `${escaped(key)}=${escaped(String(value))}`).join("&");
}

/** What of a view decides its cells, as the server is asked. */
function pairsOf(view, scene) {
  const pairs = [["r", view.r.join(",")], ["beta", view.beta.join(",")], ["mu", view.mu]];
  if (view.start !== scene.start) pairs.push(["start", view.start]);
  if (view.contact !== scene.contacts[0].key) pairs.push(["contact", view.contact]);
  return [...pairs, ...Object.entries(view.numbers)];
}

/** The query of a view, with further keys. @param {View} view */
export function queryOf(view, scene, further = {}) {
  return joined([...pairsOf(view, scene), ...Object.entries(further)]);
}

/** The part of an address behind #. @param {View} view */
export function hashOf(view, scene) {
  const pairs = pairsOf(view, scene);
  if (view.quantity !== scene.quantities[0].key) pairs.push(["quantity", view.quantity]);
  if (view.cell) pairs.push(["cell", view.cell.join(",")]);
  if (view.cut) pairs.push(["cut", view.cut]);
  return `#${joined(pairs)}`;
}

function isRange(numbers) {
  return numbers.length === 2 && numbers.every(Number.isFinite) && numbers[0] >= 0 && numbers[0] < numbers[1];
}

function isCell(numbers) {
  return numbers.length === 2 && numbers.every(Number.isFinite) && numbers[0] > 0 && numbers[1] >= 0;
}

/** The view of an address; what it leaves out or what is wrong in it is as the scene begins. @returns {View} */
export function viewOf(hash, scene) {
  const view = firstView(scene);
  const given = new URLSearchParams(hash.replace(/^#/, ""));
  const numbers = (key) => (given.get(key) ?? "").split(",").filter(Boolean).map(Number);
  const one = (key, legal) => {
    const value = given.get(key);
    if (value !== null && legal.includes(value)) view[key] = value;
  };
  if (isRange(numbers("r"))) view.r = numbers("r");
  if (isRange(numbers("beta"))) view.beta = numbers("beta");
  if (isCell(numbers("cell"))) view.cell = numbers("cell");
  if (Number(given.get("mu")) >= 1) view.mu = Number(given.get("mu"));
  one("start", ["rest", "moving"]);
  one("contact", scene.contacts.map((contact) => contact.key));
  one("quantity", scene.quantities.map((quantity) => quantity.key));
  one("cut", ["r", "beta"]);
  for (const slider of scene.sliders) {
    const value = given.get(slider.key);
    if (slider.key !== "mu" && value && Number.isFinite(Number(value))) view.numbers[slider.key] = Number(value);
  }
  return view;
}

/** Ends of a range with no more digits than can be seen. */
export function tidy([low, high]) {
  const digits = Math.min(15, Math.max(0, 4 - Math.floor(Math.log10(high - low))));
  return [Number(Math.max(0, low).toFixed(digits)), Number(high.toFixed(digits))];
}
