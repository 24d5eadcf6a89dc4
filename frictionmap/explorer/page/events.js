// Events of a motion: what the contacts begin to do, in order of time.

const RIGID = { stick: "stops", slide: "begins to slide", turn: "turns without a stop", open: "opens", close: "closes and slides" };
const ELASTIC = { stick: "holds", slide: "begins to slip", turn: "slips the other way", open: "opens", close: "closes and slips" };

/** State of an open contact, beside its directions. */
export const OPEN = 2;

/** What begins between two states of a contact; "" if nothing does. */
function change(before, after) {
  if (before === after) return "";
  if (after === OPEN) return "open";
  if (after === 0) return "stick";
  if (before === OPEN) return "close";
  return before === 0 ? "slide" : "turn";
}

/**
 * Events by the first sample after them; those of one sample are one.
 * @param {object} motion  as the server sends it
 * @returns {{place: number, text: string}[]}
 */
export function eventsOf({ states, tau, drawing: { contacts } }) {
  const found = [];
  for (let k = 1; k < tau.length; k += 1) {
    const words = contacts.flatMap(({ row, name, elastic }) => {
      const kind = change(states[row * tau.length + k - 1], states[row * tau.length + k]);
      return kind ? [`${name || "the contact"} ${(elastic ? ELASTIC : RIGID)[kind]}`] : [];
    });
    if (words.length) found.push({ place: k, text: words.join("; ") });
  }
  return found;
}
