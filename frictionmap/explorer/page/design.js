// Goals of a design, and pinned designs: what they add to the page, and to its address.

import { hashOf, systemKey } from "./address.js";
import { VALID, queryOfGoal, goalOf, isComplete, noGoal, offer, textOf } from "./goal.js";
import { Handles } from "./handles.js";
import { GoalPanel } from "./panel.js";
import { NAMES, Pins } from "./pins.js";
import { drawGoal } from "./shade.js";

/** Milliseconds without changes before an answer is requested; and until the panel says that it is computed. */
const STILL = 200;
const PATIENCE = 600;

/** Keys of an address that belong to goals and pins. */
const KEYS = ["goal", ...NAMES.map((name) => `design${name}`)];
const isOwn = (pair) => KEYS.includes(pair.split("=")[0]);

export class Design {
  /**
   * @param {object} source
   * @param {object} scene
   * @param {object} does  callbacks: settle(), select(cell), newest(work, onError)
   */
  constructor(source, scene, does) {
    [this.source, this.scene, this.does] = [source, scene, does];
    this.live = source.live && !scene.unloaded; // a page that is a file computes nothing
    offer(scene.goals);
    this.goal = noGoal(scene);
    this.answer = null;
    this.key = ""; // of the goal and the system whose answer is shown or awaited
    this.wrong = [];
    this.requests = does.newest((...args) => this.#fetch(...args), () => {});
    this.given = new URLSearchParams();
  }

  /** Add the panel, the handles and the table to the page. */
  begin(form, map, section) {
    if (!this.live) return;
    this.map = map;
    this.panel = new GoalPanel(form, {
      change: (part) => this.#change(part),
      select: () => this.does.select([this.answer.peaks?.[0]?.r ?? this.answer.r ?? this.answer.band[0], this.answer.beta]),
      pin: (name) => this.#pin(name),
      convert: (given) => this.source.ratios(this.view, this.scene, given),
    });
    this.handles = new Handles(map, (band, done) => this.#onHandle(band, done));
    this.pins = new Pins(section, this.scene, {
      show: (text) => (location.hash = `#${[text, ...this.pins.pairs].join("&")}`),
      change: () => this.does.settle(),
    });
    this.panel.describe(this.scene);
    this.panel.set(this.goal);
    this.panel.say("");
    this.pins.draw(this.scene);
    this.pins.read(this.given);
    map.overlay = (pen, plate) => this.#draw(pen, plate);
  }

  // addresses

  /** Take over goal and pinned designs from an address; returns the rest of it. */
  read(hash) {
    if (!this.live) return hash;
    const pairs = hash.replace(/^#/, "").split("&");
    this.given = new URLSearchParams(pairs.filter(isOwn).join("&"));
    const text = this.given.get("goal");
    const goal = text === null ? { ...this.goal, ask: "" } : goalOf(text, this.scene);
    this.wrong = goal ? [] : [`goal must be ${VALID}; got ${text.slice(0, 40) || "nothing"}; used: none`];
    this.goal = goal ?? noGoal(this.scene);
    this.panel?.set(this.goal);
    this.pins?.read(this.given);
    return `#${pairs.filter((pair) => !isOwn(pair)).join("&")}`;
  }

  /** What goal and pinned designs add to an address. */
  get hash() {
    const pairs = [...this.#goalPairs, ...(this.pins?.pairs ?? [])];
    return pairs.map((pair) => `&${pair}`).join("");
  }

  get #goalPairs() {
    const text = textOf(this.goal);
    return text ? [`goal=${text}`] : [];
  }

  // the goal

  #change(part) {
    this.goal = { ...this.goal, ...part };
    this.panel.set(this.goal);
    this.update(this.view);
    this.map.drawOver();
    this.does.settle();
  }

  #onHandle(band, done) {
    if (done) {
      this.#change({ band });
      return;
    }
    this.goal = { ...this.goal, band };
    this.#forget();
    this.panel.set(this.goal);
    this.map.drawOver();
  }

  /** Drop the answer, and those to come. */
  #forget() {
    this.requests.stop();
    clearTimeout(this.timer);
    clearInterval(this.looking);
    [this.answer, this.key] = [null, ""];
    this.panel.say("");
  }

  /** Request the answer for a view, unless it is known. @param {import("./address.js").View} view */
  update(view) {
    if (!this.live) return;
    this.view = view;
    const { goal } = this;
    const key = goal.ask && `${systemKey({ ...view, start: "" })} ${textOf(goal)}`;
    if (key === this.key) return;
    this.#forget();
    this.key = key;
    if (!goal.ask) return;
    if (!isComplete(goal)) {
      this.panel.say("Enter the largest value that is allowed.");
      return;
    }
    this.timer = setTimeout(() => this.requests.ask(key, view, goal), STILL);
  }

  async #fetch(signal, key, view, goal) {
    this.#lookAtWaiting(key);
    try {
      const answer = await this.source.goal(view, this.scene, queryOfGoal(goal), signal);
      if (key === this.key) this.#show(answer);
    } catch (error) {
      if (error.name === "AbortError") throw error;
      if (key === this.key) this.panel.say(error.message, true);
    } finally {
      if (key === this.key) clearInterval(this.looking);
    }
  }

  #show(answer) {
    this.answer = answer;
    this.panel.show(answer);
    this.map.drawOver();
  }

  /** Say that the answer is being computed, and whether kernels are being compiled for it. */
  #lookAtWaiting(key) {
    clearInterval(this.looking);
    this.looking = setInterval(async () => {
      const { compiling } = await this.source.state().catch(() => ({ compiling: {} }));
      if (key !== this.key || this.answer) return;
      const first = compiling.seconds ? ` First use: compiling, once only (${Math.round(compiling.seconds)} s so far).` : "";
      this.panel.say(`Computing.${first}`);
    }, PATIENCE);
  }

  /** Draw over the map; and take over what the cells say of units and subjects. */
  #draw(pen, plate) {
    const about = JSON.stringify([plate.about.units, plate.about.physical, plate.about.subjects]);
    if (about !== this.about) {
      this.about = about;
      this.panel.describe(plate.about);
      this.pins.draw(plate.about);
    }
    const { ask, band } = this.goal;
    this.handles.place(ask ? band : null, plate);
    if (ask) drawGoal(pen, plate, band, this.answer);
  }

  // pinned designs

  #pin(name) {
    const text = [hashOf(this.view, this.scene).slice(1), ...this.#goalPairs].join("&");
    this.pins.put(name, text, this.answer);
    this.does.settle();
  }
}
