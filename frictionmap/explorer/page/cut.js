// A response curve under the map, along r or beta.

import { DRAWN, colour, massColour, short } from "./axes.js";
import { around, draw } from "./chart.js";
import { keyLine, nameOfMass } from "./dom.js";
import { row } from "./packet.js";

const SHOWN = {
  amplitude: "amplitude",
  work: "energy dissipated by friction",
  phase: "phase lag of z, first harmonic",
};

/** Share of values within the range of the amplitude axis: a resonance exceeds it. */
const HELD = 0.97;

/** Words where no place is marked. */
const HINT = "Point at the curve to read values; click to select a cell.";

/** Shares of the curve that a key moves the mark by. */
const NUDGE = 0.01;
const KEYS = { ArrowLeft: -NUDGE, ArrowDown: -NUDGE, ArrowRight: NUDGE, ArrowUp: NUDGE, PageDown: -10 * NUDGE, PageUp: 10 * NUDGE };

export class CutPanel {
  /**
   * @param {HTMLElement} panel
   * @param {object} does  callbacks: close(), point(value or null), pick(value)
   */
  constructor(panel, classes, does) {
    [this.panel, this.classes, this.does] = [panel, classes, does];
    panel.innerHTML = `<div><span class="what"></span><label>show <select aria-label="What the curve shows"></select></label>
      <button type="button" title="Close the curve" aria-label="Close the curve">×</button><span class="key"></span></div>
      <div class="plot" tabindex="0" role="slider" aria-label="place on the response curve"><canvas role="img" aria-label="response curve"></canvas><i class="mark line" hidden></i></div>
      <div class="reading"></div>`;
    this.select = panel.querySelector("select");
    for (const [key, label] of Object.entries(SHOWN)) this.select.add(new Option(label, key));
    this.select.addEventListener("change", () => this.draw());
    panel.querySelector("button").addEventListener("click", () => does.close());
    this.frame = panel.querySelector(".plot");
    this.#listen();
    this.value = null; // the place that is marked
    this.curves = null;
    this.room = { left: 64, right: 16 };
  }

  /** @param {object} curves  as the server sends them, in the units of their system  @param {{left: number, right: number}} room  of the map
   *  @param {string} key  key of the curve: the system and its position */
  show(curves, room, key) {
    [this.curves, this.room, this.key] = [curves, room, key];
    this.panel.hidden = false;
    this.draw();
  }

  /** Mark a place by the pointer or by keys; Enter or a click selects its cell. */
  #listen() {
    const { frame, does } = this;
    const at = ({ clientX }) => {
      const { area } = this.drawn;
      const [low, high] = this.curves.ends;
      const share = (clientX - frame.getBoundingClientRect().left - area.x) / area.width;
      return low + Math.min(1, Math.max(0, share)) * (high - low);
    };
    frame.addEventListener("pointermove", (event) => does.point(at(event)));
    frame.addEventListener("pointerleave", () => does.point(null));
    frame.addEventListener("click", (event) => does.pick(at(event)));
    frame.addEventListener("keydown", (event) => {
      const [low, high] = this.curves.ends;
      const way = KEYS[event.key];
      if (event.key === "Enter" && this.value !== null) does.pick(this.value);
      else if (way) does.point(Math.min(high, Math.max(low, (this.value ?? (low + high) / 2) + way * (high - low))));
      else return;
      event.preventDefault();
      event.stopPropagation(); // the key does not move the map
    });
  }

  /** Mark a place on the curve, and state its values. @param {number | null} value  of r or beta */
  point(value) {
    const inside = this.curves && value !== null && value >= this.curves.ends[0] && value <= this.curves.ends[1];
    this.value = inside ? value : null;
    this.frame.querySelector(".mark").hidden = !inside;
    if (inside) this.#mark();
    else this.#say(HINT, "nothing marked");
  }

  #mark() {
    const { along, ends, classes } = this.curves;
    const { area, x } = this.drawn;
    const mark = this.frame.querySelector(".mark");
    Object.assign(mark.style, { top: `${area.y}px`, height: `${area.height}px`, transform: `translateX(${x(this.value).toFixed(1)}px)` });
    const column = Math.min(classes.length - 1, Math.floor(((this.value - ends[0]) / (ends[1] - ends[0])) * classes.length));
    const values = this.named.filter(({ y }) => y.length).map(({ name, y }) => `${name} ${short(y[column], 3)}`);
    const words = `${along === "r" ? "r" : "β"} = ${short(this.value)}: ${values.join(", ")}; ${this.classes[classes[column]].label}`;
    this.#say(words, words);
  }

  #say(words, spoken) {
    this.panel.querySelector(".reading").textContent = words;
    const [low, high] = this.curves?.ends ?? [0, 1];
    Object.assign(this.frame, { ariaValueMin: low, ariaValueMax: high, ariaValueNow: this.value ?? (low + high) / 2, ariaValueText: spoken });
  }

  hide() {
    this.curves = null;
    this.panel.hidden = true;
  }

  draw() {
    if (!this.curves) return;
    const { along, at, ends, classes, units } = this.curves;
    const count = classes.length;
    const step = (ends[1] - ends[0]) / count;
    const x = Float64Array.from({ length: count }, (_, k) => ends[0] + (k + 0.5) * step);
    const lines = this.#lines(x);
    this.panel.querySelector(".what").textContent = along === "r" ? `along r at β = ${short(at)}` : `along β at r = ${short(at)}`;
    const unit = { amplitude: units.length, work: units.energy, phase: "rad" }[this.select.value];
    this.drawn = draw(this.panel.querySelector("canvas"), {
      x: ends, y: this.#range(lines), lines, bands: this.#bands(x, step), left: this.room.left, right: this.room.right,
      xName: along === "r" ? "frequency ratio r" : "friction ratio β", yName: `${this.select.value} / ${unit}`,
    });
    const named = (this.named = lines.filter((line) => line.name));
    this.panel.querySelector(".key").replaceChildren(...named.map((line) => keyLine(line.colour, line.name, line.dash ? "dashed" : "solid")));
    this.point(this.value);
  }

  #lines(x) {
    const { curves } = this;
    const ink = colour("ink");
    if (curves.contacts.length) return this.#ofContacts(x);
    if (this.select.value === "work") return [{ x, y: curves.work_friction, colour: ink, width: 2, name: "energy per cycle" }];
    if (this.select.value === "phase") return [{ x, y: curves.contact_phase, colour: ink, width: 2, name: "z" }];
    const lines = [];
    const masses = Math.min(curves.amplitude.shape[0], DRAWN);
    for (let k = 0; k < masses; k += 1) {
      if (curves.held) lines.push({ x, y: row(curves.held, k), colour: massColour(k), width: 1, dash: [2, 3] });
    }
    for (let k = 0; k < masses; k += 1) {
      lines.push({ x, y: row(curves.amplitude, k), colour: massColour(k), width: 1.5, name: masses === 1 ? "mass" : nameOfMass(curves.dofs[k]) });
    }
    lines.push({ x, y: curves.contact_amplitude, colour: ink, width: 2.2, dash: masses === 1 ? [6, 4] : undefined, name: "z, contact" });
    if (curves.held) lines.push({ x: [], y: [], colour: "#888", dash: [2, 3], name: "contact held" });
    return lines;
  }

  /** Lines of all contacts that are shown, after those of the masses. */
  #ofContacts(x) {
    const { curves } = this;
    const name = { amplitude: "contact_amplitude", work: "work_friction", phase: "contact_phase" }[this.select.value];
    const dash = this.select.value === "amplitude" ? [6, 4] : undefined;
    const lines = curves.contacts.map((contact, k) => ({ x, y: row(curves[name], k), width: 2, name: contact, colour: massColour(k % DRAWN), dash }));
    if (this.select.value !== "amplitude") return lines;
    const masses = Math.min(curves.amplitude.shape[0], DRAWN);
    return [...Array.from({ length: masses }, (_, k) => ({ x, y: row(curves.amplitude, k), colour: massColour(k), width: 1.5, name: masses === 1 ? "mass" : nameOfMass(curves.dofs[k]) })), ...lines];
  }

  #range(lines) {
    if (this.select.value !== "amplitude") return around(...lines.map((line) => line.y));
    const own = lines.filter((line) => line.name && line.y.length).flatMap((line) => [...line.y]).filter(Number.isFinite);
    own.sort((one, other) => one - other);
    const top = own.length ? own[Math.floor(HELD * (own.length - 1))] : 1;
    return [0, 1.25 * Math.max(top, 1e-9)];
  }

  /** Classes of the motion behind the curve, as strips of their colours. */
  #bands(x, step) {
    const { classes } = this.curves;
    const bands = [];
    for (let k = 0; k < classes.length; k += 1) {
      const last = bands.at(-1);
      if (last && last.index === classes[k]) last.to = x[k] + step / 2;
      else bands.push({ index: classes[k], from: x[k] - step / 2, to: x[k] + step / 2, colour: `${this.classes[classes[k]].colour}40` });
    }
    return bands;
  }
}
