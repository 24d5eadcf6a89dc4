// A goal of a design: as it stands in an address and in a query, and its answer in sentences.

import { short } from "./axes.js";

/**
 * A question about the friction over a band of frequencies.
 * @typedef {object} Goal
 * @property {string} ask               a key of `GOALS`; "": nothing
 * @property {[number, number]} band    frequency ratios
 * @property {string} of                key of a subject: a mass or a contact
 * @property {number | null} limit      largest response that is allowed, a ratio
 */

/** Goals by their keys, as the server offers them: label, whether they are about a response, whether it has a limit. */
export const GOALS = {};

export function offer(goals) {
  for (const goal of goals) GOALS[goal.key] = goal;
}

/** Whether a goal is about the response of a mass or a contact. */
export function isOfResponse({ ask }) {
  return GOALS[ask]?.response ?? false;
}

/** Whether a goal has a largest response that is allowed. */
export function hasLimit({ ask }) {
  return GOALS[ask]?.limit ?? false;
}

/** No goal, and the band that it begins with. @returns {Goal} */
export function noGoal(scene) {
  const [low, high] = scene.r;
  return { ask: "", band: [low || Number((0.1 * high).toPrecision(1)), high], of: scene.subjects?.[0].key ?? "", limit: null };
}

/** Whether all that a goal needs is known. */
export function isComplete({ ask, limit }) {
  return ask !== "" && (!hasLimit({ ask }) || limit !== null);
}

/** A goal as keys of a query. */
export function queryOfGoal({ ask, band, of, limit }) {
  const query = { goal: ask, band: band.join(",") };
  if (isOfResponse({ ask })) query.of = of;
  if (hasLimit({ ask })) query.limit = limit;
  return query;
}

/** A goal as it stands in an address; "" if there is none. */
export function textOf({ ask, band, of, limit }) {
  if (!ask) return "";
  const parts = [ask, band.join(",")];
  if (isOfResponse({ ask })) parts.push(of);
  if (hasLimit({ ask }) && limit !== null) parts.push(String(limit));
  return parts.join(":");
}

/** What the goal of an address looks like, for a message. */
export const VALID = "GOAL:FROM,TO:OF:LIMIT, such as least-peak:0.3,2.2:mass-1";

/** The goal of an address; null if it is invalid. @returns {Goal | null} */
export function goalOf(text, scene) {
  const [ask, band = "", of = noGoal(scene).of, limit] = text.split(":");
  const ends = band.split(",").map(Number);
  const known = Object.hasOwn(GOALS, ask) && ends.length === 2 && ends[0] > 0 && ends[0] < ends[1] && Number.isFinite(ends[1]);
  const most = limit === undefined ? null : Number(limit);
  return known && (most === null || most > 0) ? { ask, band: ends, of, limit: most } : null;
}

/** A ratio, and in its unit in brackets if that is known. */
export function inUnits(value, one) {
  return one ? `${short(value)} (${short(value * one.factor)} ${one.unit})` : short(value);
}

/** Lengths over P/k1 or Y, and in their unit. */
export function lengthOf(value, { units, physical }) {
  return physical.length ? `${short(value)} ${units.length} (${short(value * physical.length.factor)} ${physical.length.unit})` : `${short(value)} ${units.length}`;
}

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** A friction ratio, and the friction force if that is known. */
function friction(beta, { physical }) {
  return `β = ${inUnits(beta, physical.force)}`;
}

function place(r, { physical }) {
  return `r = ${inUnits(r, physical.frequency)}`;
}

/** A range of friction in words. */
function rangeOf([low, high], answer) {
  const { force } = answer.physical;
  if (high === null) return low === 0 ? "any friction" : `friction at or above ${friction(low, answer)}`;
  return `β from ${inUnits(low, force)} to ${inUnits(high, force)}`;
}

function rangesOf(answer) {
  return answer.ranges.map((range) => rangeOf(range, answer)).join(", and for ");
}

/** Where the least peak is reached, and what the contact does there. */
function reached({ kind, peaks, ...answer }) {
  const places = peaks.map(({ r, regime, stops }) => {
    const counted = stops > 0 ? `, ${short(stops)} stops per cycle` : "";
    return `at ${place(r, answer)}: ${regime}${counted}`;
  });
  if (kind === "threshold") return "With this friction or more it does not move, at any frequency of the band.";
  if (kind === "two equal peaks") return `Two equal peaks, ${places.join("; and ")}.`;
  const more = { plateau: " More friction changes nothing.", "at the bound": " It is at the end of the friction that was searched." };
  return `It is reached ${places[0]}.${more[kind] ?? ""}`;
}

/** With static friction above kinetic friction: what holds from some starts only. */
function fromSome(words, { some, ...answer }) {
  return typeof some === "number" ? [`${words} ${friction(some, answer)}: from some starts only.`] : [];
}

const cautionOf = ({ caution }) => (caution ? [`Caution: ${caution}.`] : []);

const SENTENCES = {
  "least-peak": (answer, label) => [
    `Least peak of ${label}: ${lengthOf(answer.peak ?? Infinity, answer)}, at ${friction(answer.beta, answer)}.`,
    reached(answer),
    ...(answer.peak ? [`At most 5 % above it for ${rangesOf(answer)}.`] : []),
    ...cautionOf(answer),
  ],
  "at-most": (answer, label) => [
    `${capital(label)} stays within ${lengthOf(answer.limit, answer)} for ${rangesOf(answer)}.`,
    `Least peak: ${lengthOf(answer.peak ?? Infinity, answer)}, at ${friction(answer.beta, answer)}. ${reached(answer)}`,
    ...cautionOf(answer),
  ],
  "no-stop": (answer) => {
    if (!answer.ranges.length) return [`Any friction causes stops in the band; ${place(answer.r, answer)} decides.`];
    if (answer.beta === null) return ["No stops with any friction."];
    const tried = answer.some === undefined ? "" : " from any start that was tried";
    return [
      `No stops${tried} up to ${friction(answer.beta, answer)}; ${place(answer.r, answer)} decides.`,
      ...fromSome("Without stops up to", answer),
    ];
  },
  stuck: (answer) => answer.ranges.length
    ? [
      `Always stuck at or above ${friction(answer.beta, answer)}${answer.some === undefined ? "" : ", whatever the start"}; ${place(answer.r, answer)} decides.`,
      ...fromSome("Stuck at or above", answer),
    ]
    : [`No friction holds over the whole band: stuck, the structure resonates without damping at ${place(answer.r, answer)}.`],
};

/** The rows of a summary: of goals without sentences of their own. */
const listed = ({ rows }) => rows.map(([name, text]) => `${capital(name)}: ${text}.`);

/** Describe the result for a goal in sentences. @param {object} answer  as the server sends it  @param {string} label  of its subject */
export function sentencesOf(answer, label) {
  return (SENTENCES[answer.goal] ?? listed)(answer, label);
}

/** The optimum in a few words. */
export function shortly(answer) {
  const { beta, peak } = answer;
  if (beta === null) return "no friction";
  const size = peak === undefined ? "" : `, peak ${lengthOf(peak ?? Infinity, answer)}`;
  return `${friction(beta, answer)}${size}`;
}

/** A goal in a few words. */
export function wordsOf(goal, label, about) {
  const { frequency } = about.physical;
  const [low, high] = goal.band.map((r) => short(frequency ? r * frequency.factor : r));
  const band = frequency ? `${low} to ${high} ${frequency.unit}` : `r ${low} to ${high}`;
  const limit = hasLimit(goal) && goal.limit !== null ? ` ${lengthOf(goal.limit, about)},` : "";
  return `${GOALS[goal.ask].label}${limit}${isOfResponse(goal) ? ` ${label}` : ""}, ${band}`;
}
