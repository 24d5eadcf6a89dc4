// The motion in a cell: description, time histories, phase portrait, loop, spectrum, numbers; other initial states.

import { DRAWN, colour, massColour, short } from "./axes.js";
import { around, draw } from "./chart.js";
import { bandsOf, clockOf, drawContacts, layOut, timeOf } from "./contacts.js";
import { Drawing } from "./drawing.js";
import { groupRow, keyLine, make, nameOfMass, paragraph, spaced, tableRow } from "./dom.js";
import { eventsOf } from "./events.js";
import { Moment, sampled } from "./moment.js";
import { row } from "./packet.js";
import { Player } from "./player.js";

const REGIMES = {
  unresolved: "Not resolved",
  permanent_sticking: "Permanent sticking",
  stick_slip: "Stick-slip",
  continuous: "Continuous sliding",
  one_way_sliding: "One-way sliding",
};

/** Words under the motion that the page opens with. */
const HINT = "Point at the map, or tap it, to see other motions. Click to select a cell.";

/** Decades of the spectrum. */
const DECADES = 5;

const TEMPLATE = `
  <h2><i></i><span class="regime"></span> <small class="where"></small></h2>
  <figure class="live">
    <svg class="drawing" role="img"></svg>
    <figcaption class="states"></figcaption>
    <div class="player">
      <button type="button" class="play"></button>
      <input type="range" class="time" min="0" step="1" aria-label="time">
      <button type="button" class="event" aria-label="Step to the next event" title="Next event (e): the contact stops, slides on or turns">▸❙</button>
      <select class="pace" aria-label="speed"></select>
      <span class="slowed" role="status"></span>
    </div>
  </figure>
  <div class="words"></div>
  <figure class="moves">
    <figcaption class="names"></figcaption>
    <div class="plot"><canvas class="displacement" role="img" aria-label="displacements over time"></canvas></div>
    <div class="plot"><canvas class="force" role="img" aria-label="friction force over time"></canvas></div>
  </figure>
  <div class="pair moves">
    <figure><figcaption><b>phase portrait</b> z′ over z</figcaption>
      <div class="plot"><canvas class="portrait" role="img" aria-label="velocity over displacement in the contact"></canvas></div></figure>
    <figure><figcaption><b>friction loop</b> force over z</figcaption>
      <div class="plot"><canvas class="loop" role="img" aria-label="friction force over displacement in the contact"></canvas></div></figure>
  </div>
  <figure class="moves"><figcaption class="spectrum-names"></figcaption>
    <canvas class="spectrum" role="img" aria-label="harmonics of displacement and friction force"></canvas></figure>
  <div class="contacts" hidden></div>
  <div class="others" hidden></div>
  <table><tbody></tbody></table>`;

/** Format a ratio in its unit, in brackets, if that is known. */
function inUnits(value, one) {
  return one && Number.isFinite(value) ? ` (${short(value * one.factor)} ${one.unit})` : "";
}

export class MotionPanel {
  /** @param {HTMLElement} panel */
  constructor(panel) {
    this.panel = panel;
    this.motion = null;
    this.other = null;
    this.moment = new Moment();
    this.player = new Player((place) => this.#show(place));
  }

  #part(name) {
    return this.panel.querySelector(name);
  }

  /** Show a text instead of a motion. */
  say(text) {
    this.motion = null;
    this.player.load(null);
    this.panel.replaceChildren(make("p", { className: "hint" }, text));
  }

  /** Show the system at rest until there is a motion. @param {object} drawing  as the server describes it */
  wait(drawing, text) {
    this.say(text);
    const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    svg.classList.add("drawing");
    svg.setAttribute("role", "img");
    this.panel.prepend(svg);
    const drawn = new Drawing(svg);
    drawn.show(atRest(drawing));
    drawn.set(0);
    svg.setAttribute("aria-label", svg.getAttribute("aria-label").replace("of the motion", "of the system at rest"));
  }

  /**
   * @param {object} motion  as the server sends it, in the units of its system
   * @param {{colour: string}} look  of the cell's class
   * @param {string} kind    "selected", "example" or "" of a cell that is pointed at
   * @param {string} key   key of the motion: the system and the cell
   */
  show(motion, look, kind, key) {
    if (!this.#part("h2")) this.#layOut();
    [this.motion, this.other, this.key] = [motion, null, key];
    const none = "none" in motion;
    this.#part("h2 i").style.background = look.colour;
    this.#part(".regime").textContent = none ? REGIMES.unresolved : REGIMES[motion.regime] ?? motion.regime;
    const { across: { symbol, measure }, physical } = motion;
    const place = `${symbol} = ${short(motion.r)}${inUnits(motion.r, physical[measure])}, β = ${short(motion.beta)}${inUnits(motion.beta, physical.force)}`;
    this.#part(".where").textContent = `${kind && `${kind}: `}${place}${motion.contact ? `; ${motion.contact}` : ""}`;
    this.#part(".words").replaceChildren(...(none ? [motion.none] : [...motion.summary, motion.comment]).filter(Boolean).map(paragraph));
    if (kind === "example") this.#part(".words").append(make("p", { className: "hint" }, `${HINT} `, tourButton()));
    this.#part(".live").hidden = none;
    if (!none) this.#enliven();
    const several = !none && motion.contacts.length > 0;
    for (const figure of this.panel.querySelectorAll(".moves")) figure.hidden = none || several;
    if (!motion.z_harmonics) this.#part(".spectrum").parentNode.hidden = true;
    this.#part(".contacts").hidden = !several;
    if (several) this.#layOutContacts();
    this.#part(".others").hidden = true;
    this.#part("tbody").replaceChildren(...(none ? [] : motion.entries.flatMap((entry, k, all) => this.#entry(entry, motion.numbers[k], all[k - 1]))));
    this.moment.clear(); // its charts are of the motion before
    this.player.load(none ? null : motion, none ? [] : eventsOf(motion));
    this.draw();
  }

  #layOut() {
    this.panel.innerHTML = TEMPLATE;
    this.drawing = new Drawing(this.#part(".drawing"));
    this.player.mount(this.panel);
  }

  #layOutContacts() {
    const element = this.#part(".contacts");
    layOut(element, this.motion);
    for (const frame of element.querySelectorAll(".plot")) this.player.follow(frame);
  }

  /** Lay out the drawing, and the names of the contacts under it. */
  #enliven() {
    const { motion } = this;
    this.drawing.show(motion);
    const { contacts } = motion.drawing;
    const several = contacts.length > 1;
    const lights = contacts.map(({ row: number, name }) => make("span", {}, make("i", { className: "lamp" }), several ? `${number + 1} ${name}: ` : "contact: ", make("b")));
    const missing = motion.states.shape[0] - contacts.length;
    const note = missing > 0 ? [`and ${missing} contacts that are not drawn`] : [];
    this.#part(".states").replaceChildren(...spaced([...lights, ...note]));
  }

  /** Show a moment, a place between samples, in the drawing and the charts; returns it in words. */
  #show(place) {
    const { motion } = this;
    const stuck = this.drawing.set(place);
    this.moment.set(place);
    const { contacts } = motion.drawing;
    const words = contacts.map(({ elastic }, k) => (this.drawing.open[k] ? "open" : stuck[k] ? (elastic ? "no slip" : "stuck") : elastic ? "slips" : "slides"));
    [...this.#part(".states").children].forEach((light, k) => {
      if (light.lastChild.textContent === words[k]) return;
      light.lastChild.textContent = words[k];
      light.classList.toggle("lit", stuck[k]);
    });
    const x = motion.drawing.rows.slice(0, 3).map((row, k) => `${nameOfMass(motion.drawing.names[k])} = ${short(sampled(motion.x, place, row * motion.tau.length), 3)}`);
    return [...x, ...contacts.map(({ name }, k) => `${name || "contact"} ${words[k]}`)].join(", ");
  }

  /** Rows of a number: a heading first, where it begins those of a contact. */
  #entry(entry, value, before) {
    const heading = entry.group && entry.group !== before?.group ? [groupRow(entry.group)] : [];
    return [...heading, this.#numberRow(entry, value)];
  }

  #numberRow(entry, value) {
    const { units } = this.motion;
    const { length, energy, force } = units;
    const unit = { length, energy, force, frequency: "ω₁", growth: "ω₁", velocity: `ω₁${length}` }[entry.unit] ?? entry.unit;
    const physical = this.motion.physical[entry.unit === "energy" ? "work" : entry.unit];
    if (entry.why) return tableRow(entry.label, `none: ${entry.why}`, "text");
    return tableRow(entry.label, `${short(value, 6)}${Number.isFinite(value) && unit ? ` ${unit}` : ""}${inUnits(value, physical)}`);
  }

  /** Add stability and the motion from the other initial state. */
  add(others) {
    const words = this.#part(".others");
    const start = others.start === "moving" ? "a large sliding motion" : "rest";
    const sentences = others.same
      ? [`From ${start} the same motion results.`]
      : [`From ${start} another motion results (dashed): ${others.summary.map(uncapped).join(" ")}`];
    if (others.reachable.length > 1) {
      sentences.push(`Stable regimes in this cell: ${others.reachable.map((name) => REGIMES[name].toLowerCase()).join(", ")}.`);
    }
    words.replaceChildren(...sentences.map(paragraph));
    words.hidden = false;
    if (Number.isFinite(others.multiplier[0])) {
      const rate = others.multiplier[0];
      const value = `${short(rate, 4)} (${rate < 1 ? "stable" : "not stable"})`;
      this.#part("tbody").append(tableRow("largest Floquet multiplier", value));
    }
    this.other = others.tau ? others : null;
    if (this.other) this.draw();
  }

  /** Draw again, in the current colours and size. */
  draw() {
    if (!this.motion?.tau) return;
    this.moment.clear();
    if (this.motion.contacts.length) {
      drawContacts(this.#part(".contacts"), this.motion, this.moment);
      this.player.show();
      return;
    }
    const names = this.#drawTime();
    this.#drawLoops();
    const harmonics = this.#drawSpectrum();
    this.#part(".names").replaceChildren(...spaced(names)); // last, as it changes the layout of the page
    this.#part(".spectrum-names").replaceChildren(...spaced(harmonics));
    this.player.show();
  }

  /** Times in excitation periods, and stops as bands behind them. */
  #time() {
    const time = timeOf(this.motion);
    const bands = bandsOf(this.motion.direction, time);
    return { time, bands };
  }

  /** The motion from the other initial state, over the same time. */
  #otherLine(name, time) {
    const { other } = this;
    const x = Float32Array.from(other.tau, (value) => value / (2 * Math.PI));
    const [length, end] = [x.at(-1), time.at(-1)];
    const [xs, ys] = [[], []];
    for (let shift = 0; shift < end; shift += length) {
      for (let k = 0; k < x.length && x[k] + shift <= end * 1.0001; k += 1) {
        xs.push(x[k] + shift);
        ys.push(other[name][k]);
      }
    }
    return { x: xs, y: ys, colour: colour("second"), dash: [5, 3], width: 1.5 };
  }

  /** Displacements and force; the names of their lines. */
  #drawTime() {
    const { motion, other } = this;
    const { time, bands } = this.#time();
    const ink = colour("ink");
    const masses = Math.min(motion.x.shape[0], DRAWN);
    const lines = [];
    for (let k = 0; k < masses; k += 1) lines.push({ x: time, y: row(motion.x, k), colour: massColour(k), width: 1.3 });
    lines.push({ x: time, y: motion.z, colour: ink, width: 2.1, dash: masses === 1 ? [1, 3] : [] });
    if (other) lines.push(this.#otherLine("z", time));
    const x = [0, time.at(-1)];
    const [upper, lower] = [this.#part(".displacement"), this.#part(".force")];
    this.moment.line(upper, draw(upper, { x, y: around(...lines.map((line) => line.y)), lines, bands, yName: motion.units.length }), time);
    const forces = [{ x: time, y: motion.friction, colour: colour("warm"), width: 1.8 }];
    if (other) forces.push(this.#otherLine("friction", time));
    const drawn = draw(lower, {
      x, y: around(...forces.map((line) => line.y)), lines: forces, bands, xName: clockOf(motion), yName: motion.units.force,
    });
    this.moment.line(lower, drawn, time);
    const names = [];
    for (let k = 0; k < masses; k += 1) names.push(keyLine(massColour(k), masses === 1 ? "x, mass" : nameOfMass(motion.dofs[k])));
    names.push(keyLine(ink, "z, contact", masses === 1 ? "dotted" : "solid"));
    if (lower.checkVisibility()) names.push(keyLine(colour("warm"), "friction"));
    if (bands.length) names.push(keyLine(colour("stop"), motion.still[0], "solid", 9));
    if (other) names.push(keyLine(colour("second"), other.start === "moving" ? "from sliding" : "from rest", "dashed"));
    return names;
  }

  #drawLoops() {
    const { motion, other } = this;
    const second = (name) => (other ? [{ x: other.z, y: other[name], colour: colour("second"), dash: [5, 3], width: 1.5 }] : []);
    const loop = (canvas, name, ink) => {
      const lines = [{ x: motion.z, y: motion[name], colour: ink, width: 1.8 }, ...second(name)];
      const place = this.#part(canvas);
      const drawn = draw(place, { x: around(...lines.map((line) => line.x)), y: around(...lines.map((line) => line.y)), lines, left: 38 });
      this.moment.dot(place, drawn, motion.z, motion[name]);
    };
    loop(".portrait", "z_rate", colour("accent"));
    loop(".loop", "friction", colour("warm"));
  }

  /** Moduli of harmonics; the names of the bars. */
  #drawSpectrum() {
    const { z_harmonics: z, friction_harmonics: friction } = this.motion;
    if (!z) return [];
    const [one, other] = [colour("accent"), colour("warm")];
    const top = Math.max(1e-12, ...[...z, ...friction].filter(Number.isFinite)) * 1.6;
    const bars = [];
    z.forEach((value, n) => bars.push({ x: n - 0.17, y: value, colour: one }, { x: n + 0.17, y: friction[n], colour: other }));
    draw(this.#part(".spectrum"), {
      x: [-0.6, z.length - 0.4], y: [top / 10 ** DECADES, top], log: true, bars: bars.filter((bar) => bar.y > 0),
      xTicks: Array.from(z, (_, n) => ({ value: n, text: String(n) })), xName: "harmonic of the excitation; 0 is the mean",
    });
    return [make("b", {}, "spectrum"), keyLine(one, "z"), keyLine(other, "friction")];
  }
}

/** A motion in which nothing moves, for a drawing. */
function atRest(drawing) {
  const still = (rows) => new Float32Array(2 * Math.max(1, rows));
  const { contacts, masses } = drawing;
  const rows = Math.max(0, ...contacts.map(({ row: number }) => number + 1));
  return {
    drawing, tau: Float32Array.of(0, 2 * Math.PI), x: still(masses), z: still(1), base: still(1), load: still(drawing.loaded.length),
    states: new Int8Array(2 * rows), stretched: still(rows),
  };
}

/** A button that begins the tour. */
function tourButton() {
  const made = make("button", { type: "button", className: "link", textContent: "Take the tour" });
  made.dataset.tour = "";
  return made;
}

function uncapped(text) {
  return text.charAt(0).toLowerCase() + text.slice(1);
}
