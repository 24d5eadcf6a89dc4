// The motion in a cell with several contacts: displacements of the masses, then displacement, force and loop of each.

import { DRAWN, colour, massColour } from "./axes.js";
import { around, draw } from "./chart.js";
import { keyLine, make, nameOfMass, paragraph, spaced } from "./dom.js";
import { row } from "./packet.js";

/** A canvas in a frame that marks a moment over it. */
function canvas(className, label) {
  const made = make("canvas", { className, role: "img" });
  made.setAttribute("aria-label", label);
  return make("div", { className: "plot" }, made);
}

/** Charts of one contact, under its name. */
function figureOf(name, still) {
  const key = keyLine(colour("stop"), still, "solid", 9);
  const caption = make("figcaption", {}, ...spaced([make("b", {}, name), keyLine(colour("ink"), "z"), keyLine(colour("warm"), "friction"), key]));
  const time = make("div", {}, canvas("of-contact", `displacement in ${name} over time`), canvas("of-contact", `friction force in ${name} over time`));
  return make("figure", {}, caption, make("div", { className: "history" }, time, canvas("of-loop", `friction force over displacement in ${name}`)));
}

/** Make the charts of a motion. @param {HTMLElement} element @param {object} motion  as the server sends it */
export function layOut(element, motion) {
  const masses = make("figure", {}, make("figcaption", {}, ...spaced(namesOf(motion))), canvas("of-masses", "displacements of the masses over time"));
  const { contacts, listed, still } = motion;
  const missing = contacts.length - listed.length;
  const note = missing > 0 ? [paragraph(`The charts and numbers are of ${listed.length} of ${contacts.length} contacts, those that move first. Choose a contact to see its own.`)] : [];
  element.replaceChildren(masses, ...note, ...listed.map((k) => figureOf(contacts[k], still[k])));
}

function namesOf({ x, dofs }) {
  const count = Math.min(x.shape[0], DRAWN);
  return Array.from({ length: count }, (_, k) => keyLine(massColour(k), count === 1 ? "x, mass" : nameOfMass(dofs[k])));
}

/** Name of the axis of time. */
export function clockOf({ clock = "excitation period" }) {
  return `time / ${clock}`;
}

/** Times in excitation periods, or what else the clock of a motion is. */
export function timeOf({ tau }) {
  return Float32Array.from(tau, (value) => value / (2 * Math.PI));
}

/** Phases without sliding, as bands. */
export function bandsOf(direction, time) {
  const bands = [];
  let from = null;
  for (let k = 0; k <= direction.length; k += 1) {
    const stuck = k < direction.length && direction[k] === 0;
    if (stuck && from === null) from = time[k];
    if (!stuck && from !== null) {
      bands.push({ from, to: time[Math.min(k, time.length - 1)], colour: colour("stop") });
      from = null;
    }
  }
  return bands;
}

/** Draw the charts that were laid out, in the current colours and size; a moment marks them. */
export function drawContacts(element, motion, moment) {
  const time = timeOf(motion);
  const x = [0, time.at(-1)];
  const masses = Array.from({ length: Math.min(motion.x.shape[0], DRAWN) }, (_, k) => ({ x: time, y: row(motion.x, k), colour: massColour(k) }));
  const ofMasses = element.querySelector(".of-masses");
  moment.line(ofMasses, draw(ofMasses, { x, y: around(...masses.map((line) => line.y)), lines: masses, yName: motion.units.length, xName: clockOf(motion) }), time);
  const loops = element.querySelectorAll(".of-loop");
  const histories = element.querySelectorAll(".of-contact");
  motion.listed.forEach((contact, k) => {
    const [z, friction] = [row(motion.z, contact), row(motion.friction, contact)];
    const bands = bandsOf(row(motion.direction, contact), time);
    const chart = (place, y, ink) => moment.line(place, draw(place, { x, y: around(y), lines: [{ x: time, y, colour: ink, width: 1.8 }], bands, left: 38 }), time);
    chart(histories[2 * k], z, colour("ink"));
    chart(histories[2 * k + 1], friction, colour("warm"));
    moment.dot(loops[k], draw(loops[k], { x: around(z), y: around(friction), lines: [{ x: z, y: friction, colour: colour("warm"), width: 1.8 }], left: 38 }), z, friction);
  });
}
