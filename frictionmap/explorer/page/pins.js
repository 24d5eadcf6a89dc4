// Two pinned designs, side by side: what was chosen, what the contact does there, and the answer to the goal.

import { viewOf } from "./address.js";
import { short } from "./axes.js";
import { make } from "./dom.js";
import { queryOfGoal, goalOf, inUnits, isComplete, shortly, wordsOf } from "./goal.js";
import { Server } from "./source.js";

export const NAMES = ["A", "B"];

/** The key of a pinned design in an address. */
const keyOf = (name) => `design${name}`;

/** A pinned design: what its address says, and its numbers once they have arrived. */
class Pin {
  /** @param {string} text  address of a view with its goal, without #  @param {object} scene */
  constructor(text, scene) {
    this.text = text;
    const given = new URLSearchParams(text);
    const goal = given.get("goal");
    given.delete("goal");
    this.view = viewOf(given.toString(), scene).view;
    this.goal = goal === null ? null : goalOf(goal, scene);
    this.motion = this.answer = null;
    this.wrong = "";
  }

  /** Request its numbers; each pin is a page of its own to the server, so that it cancels nothing. */
  async fetch(scene) {
    const source = new Server();
    const { view, goal } = this;
    try {
      if (view.cell) this.motion = await source.motion(view, scene, view.cell);
      if (goal && isComplete(goal)) this.answer ??= await source.goal(view, scene, queryOfGoal(goal));
    } catch (error) {
      this.wrong = error.message;
    }
  }
}

export class Pins {
  /**
   * @param {HTMLElement} section
   * @param {object} scene
   * @param {{show: (text: string) => void, change: () => void}} does  callbacks: show a design, the pins have changed
   */
  constructor(section, scene, does) {
    [this.section, this.scene, this.does, this.pins] = [section, scene, does, new Map()];
  }

  /** Pairs of an address. */
  get pairs() {
    return [...this.pins].sort().map(([name, { text }]) => `${keyOf(name)}=${encodeURIComponent(text)}`);
  }

  /** Take over the pinned designs of an address; others go, as pins are steps that can be undone. @param {URLSearchParams} given */
  read(given) {
    for (const name of NAMES) {
      const text = given.get(keyOf(name));
      if (!text) this.pins.delete(name);
      else if (text !== this.pins.get(name)?.text) this.put(name, text);
    }
    this.draw();
  }

  /** Pin a design. @param {object | null} answer  to its goal, if it is known */
  put(name, text, answer = null) {
    const pin = new Pin(text, this.scene);
    pin.answer = answer;
    this.pins.set(name, pin);
    this.draw();
    pin.fetch(this.scene).then(() => this.draw());
  }

  #remove(name) {
    this.pins.delete(name);
    this.draw();
    this.does.change();
  }

  /** Lay out the table. @param {object} [about]  units and subjects of the cells */
  draw(about = this.about) {
    this.about = about;
    this.section.hidden = !this.pins.size;
    if (!this.pins.size || !about) return;
    const shown = [...this.pins].sort();
    const head = make("tr", {}, make("th", {}, "design"), ...shown.map(([name]) => this.#head(name)));
    const rows = this.#rows(shown.map(([, pin]) => pin)).map(([name, values]) =>
      make("tr", {}, make("th", { scope: "row" }, name), ...values.map((value) => make("td", {}, value))));
    this.section.replaceChildren(make("table", {}, make("thead", {}, head), make("tbody", {}, ...rows)));
  }

  #head(name) {
    const show = make("button", { type: "button", textContent: `show ${name}` });
    const remove = make("button", { type: "button", textContent: "×", title: `remove design ${name}`, ariaLabel: `remove design ${name}` });
    show.addEventListener("click", () => this.does.show(this.pins.get(name).text));
    remove.addEventListener("click", () => this.#remove(name));
    return make("th", { scope: "col" }, show, " ", remove);
  }

  /** Names and values of the rows, one value per design. */
  #rows(pins) {
    const each = (name, value) => [name, pins.map(value)];
    const rows = [
      each("r", (pin) => (pin.view.cell ? inUnits(pin.view.cell[0], physicalOf(pin, this.about).frequency) : "no cell")),
      each("β", (pin) => (pin.view.cell ? inUnits(pin.view.cell[1], physicalOf(pin, this.about).force) : "no cell")),
      each("μ", (pin) => short(pin.view.mu)),
      ...this.#changed(pins),
    ];
    const moves = pins.some(({ view }) => view.cell);
    if (moves) rows.push(each("regime", regimeOf), each("stops per cycle", stopsOf), each("amplitude", (pin) => this.#amplitude(pin)));
    if (pins.some(({ goal }) => goal)) {
      rows.push(each("goal", (pin) => (pin.goal ? wordsOf(pin.goal, this.#label(pin), { ...this.about, physical: physicalOf(pin, this.about) }) : "none")));
      rows.push(each("its friction", (pin) => (pin.answer ? shortly(pin.answer) : pin.wrong || (pin.goal ? "…" : ""))));
    }
    return rows;
  }

  /** What any of the designs has changed: contact and sliders. */
  #changed(pins) {
    const { contacts, sliders, placed } = this.scene;
    const changed = sliders.filter(({ key }) => pins.some(({ view }) => key in view.numbers));
    const rows = changed.map(({ key, label, value }) => [label, pins.map(({ view }) => short(view.numbers[key] ?? value))]);
    const first = contacts[0].key;
    if (placed && pins.some(({ view }) => view.contact !== first)) {
      rows.unshift(["contact", pins.map(({ view }) => contacts.find(({ key }) => key === view.contact).label)]);
    }
    return rows;
  }

  #label({ goal }) {
    return this.about.subjects.find(({ key }) => key === goal.of)?.label ?? goal.of;
  }

  /** The amplitude that the goal is about; without one, that in the contact. */
  #amplitude(pin) {
    const { motion, goal } = pin;
    if (!motion?.entries) return nothing(pin);
    const of = goal?.of.startsWith("mass") ? `amplitude of ${this.#label(pin)}` : "amplitude in the contact";
    const wanted = goal?.of.startsWith("contact") ? this.#label(pin) : "";
    const known = motion.entries.map((entry, k) => ({ ...entry, value: motion.numbers[k] })).filter(({ label }) => label === of);
    const own = known.find(({ group }) => group === wanted) ?? known[0];
    const unit = motion.physical.length;
    const size = own ? `${inUnits(own.value, unit)} ${unit ? "" : motion.units.length}`.trim() : "0";
    return `${size}, ${of.replace(/^amplitude (of|in) /, "")}`;
  }
}

/** Units of a design: as the server sent them with its numbers, else those of the cells. */
function physicalOf({ motion, answer }, about) {
  return (motion ?? answer ?? about).physical;
}

/** What stands where a number is not known. */
function nothing({ view, wrong }) {
  if (!view.cell) return "–";
  return wrong || "…";
}

function regimeOf(pin) {
  const { motion } = pin;
  if (!motion) return nothing(pin);
  return motion.none ? "not resolved" : motion.regime.replace("stick_slip", "stick-slip").replaceAll("_", " ").toLowerCase();
}

/** Stops per cycle, or slips of contacts with springs: of each contact. */
function stopsOf(pin) {
  const { motion } = pin;
  if (!motion?.entries) return nothing(pin);
  const counted = motion.entries.flatMap(({ name, label }, k) => (["stops_per_cycle", "slips_per_cycle"].includes(name) ? [`${short(motion.numbers[k])}${name === "slips_per_cycle" ? ` ${label.split(" ")[0]}` : ""}`] : []));
  return counted.join("; ") || "0";
}
