// The motion in a cell: description, time histories, phase portrait, loop, spectrum, numbers; other initial states.

import { DRAWN, colour, massColour, short } from "./axes.js";
import { around, draw } from "./chart.js";
import { bandsOf, drawContacts, layOut, timeOf } from "./contacts.js";
import { groupRow, keyLine, make, paragraph, tableRow } from "./dom.js";
import { row } from "./packet.js";

const REGIMES = {
  unresolved: "Not resolved",
  permanent_sticking: "Permanent sticking",
  stick_slip: "Stick-slip",
  continuous: "Continuous sliding",
};

/** Decades of the spectrum. */
const DECADES = 5;

const TEMPLATE = `
  <h2><i></i><span class="regime"></span><small class="where"></small></h2>
  <div class="words"></div>
  <figure class="moves">
    <figcaption class="names"></figcaption>
    <canvas class="displacement" role="img" aria-label="displacements over time"></canvas>
    <canvas class="force" role="img" aria-label="friction force over time"></canvas>
  </figure>
  <div class="pair moves">
    <figure><figcaption><b>phase portrait</b> z′ over z</figcaption>
      <canvas class="portrait" role="img" aria-label="velocity over displacement in the contact"></canvas></figure>
    <figure><figcaption><b>friction loop</b> force over z</figcaption>
      <canvas class="loop" role="img" aria-label="friction force over displacement in the contact"></canvas></figure>
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
  }

  #part(name) {
    return this.panel.querySelector(name);
  }

  /** Show a text instead of a motion. */
  say(text) {
    this.motion = null;
    this.panel.replaceChildren(make("p", { className: "hint" }, text));
  }

  /**
   * @param {object} motion  as the server sends it, in the units of its system
   * @param {{colour: string}} look  of the cell's class
   * @param {boolean} kept   whether the cell is selected
   * @param {string} asked   key of the motion: the system and the cell
   */
  show(motion, look, kept, asked) {
    if (!this.#part("h2")) this.panel.innerHTML = TEMPLATE;
    [this.motion, this.other, this.asked] = [motion, null, asked];
    const none = "none" in motion;
    this.#part("h2 i").style.background = look.colour;
    this.#part(".regime").textContent = none ? REGIMES.unresolved : REGIMES[motion.regime] ?? motion.regime;
    const { frequency, force } = motion.physical;
    const place = `r = ${short(motion.r)}${inUnits(motion.r, frequency)}, β = ${short(motion.beta)}${inUnits(motion.beta, force)}`;
    this.#part(".where").textContent = `${kept ? "selected: " : ""}${place}${motion.contact ? `; ${motion.contact}` : ""}`;
    this.#part(".words").replaceChildren(...(none ? [motion.none] : [...motion.summary, motion.comment]).filter(Boolean).map(paragraph));
    const several = !none && motion.contacts?.length > 0;
    for (const figure of this.panel.querySelectorAll(".moves")) figure.hidden = none || several;
    this.#part(".contacts").hidden = !several;
    if (several) layOut(this.#part(".contacts"), motion);
    this.#part(".others").hidden = true;
    this.#part("tbody").replaceChildren(...(none ? [] : motion.entries.flatMap((entry, k, all) => this.#entry(entry, motion.numbers[k], all[k - 1]))));
    if (!none) this.draw();
  }

  /** Rows of a number: a heading first, where it begins those of a contact. */
  #entry(entry, value, before) {
    const heading = entry.group && entry.group !== before?.group ? [groupRow(entry.group)] : [];
    return [...heading, this.#numberRow(entry, value)];
  }

  #numberRow(entry, value) {
    const { units } = this.motion;
    const unit = { length: units.length, energy: units.energy }[entry.unit] ?? entry.unit;
    const physical = this.motion.physical[{ length: "length", energy: "work" }[entry.unit]];
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
    if (this.motion.contacts?.length) {
      drawContacts(this.#part(".contacts"), this.motion);
      return;
    }
    const names = this.#drawTime();
    this.#drawLoops();
    const harmonics = this.#drawSpectrum();
    this.#part(".names").replaceChildren(...names); // last, as it changes the layout of the page
    this.#part(".spectrum-names").replaceChildren(...harmonics);
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
    draw(this.#part(".displacement"), { x, y: around(...lines.map((line) => line.y)), lines, bands, yName: motion.units.length });
    const forces = [{ x: time, y: motion.friction, colour: colour("warm"), width: 1.8 }];
    if (other) forces.push(this.#otherLine("friction", time));
    draw(this.#part(".force"), {
      x, y: around(...forces.map((line) => line.y)), lines: forces, bands, xName: "time / excitation period", yName: motion.units.force,
    });
    const names = [];
    for (let k = 0; k < masses; k += 1) names.push(keyLine(massColour(k), masses === 1 ? "x, mass" : `x${motion.dofs[k]}`));
    names.push(keyLine(ink, "z, contact", masses === 1 ? "dotted" : "solid"), keyLine(colour("warm"), "friction"));
    if (bands.length) names.push(keyLine(colour("stop"), motion.still?.[0] ?? "stuck", "solid", 9));
    if (other) names.push(keyLine(colour("second"), other.start === "moving" ? "from sliding" : "from rest", "dashed"));
    return names;
  }

  #drawLoops() {
    const { motion, other } = this;
    const second = (name) => (other ? [{ x: other.z, y: other[name], colour: colour("second"), dash: [5, 3], width: 1.5 }] : []);
    const loop = (canvas, name, ink) => {
      const lines = [{ x: motion.z, y: motion[name], colour: ink, width: 1.8 }, ...second(name)];
      draw(this.#part(canvas), { x: around(...lines.map((line) => line.x)), y: around(...lines.map((line) => line.y)), lines, left: 38 });
    };
    loop(".portrait", "z_rate", colour("accent"));
    loop(".loop", "friction", colour("warm"));
  }

  /** Moduli of harmonics; the names of the bars. */
  #drawSpectrum() {
    const { z_harmonics: z, friction_harmonics: friction } = this.motion;
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

function uncapped(text) {
  return text.charAt(0).toLowerCase() + text.slice(1);
}
