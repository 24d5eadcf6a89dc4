// The moment shown of a motion: it runs by itself, slowed, and follows a slider and the pointer.

import { short } from "./axes.js";

/** Seconds that an excitation period takes: choices, and the first one. */
const PACES = [16, 8, 4, 2, 1];
const PACE = 4;

/** Steps of the slider per excitation period. */
const STEPS = 100;

const HERTZ = { Hz: 1, kHz: 1e3, mHz: 1e-3 };

export class Player {
  #last = 0;
  #frame = 0;

  /** @param {(place: number) => string} onMove  shows a place between samples; returns it in words */
  constructor(onMove) {
    this.onMove = onMove;
    this.playing = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.pace = PACE;
    this.periods = 0; // the moment, in excitation periods
    this.motion = null;
  }

  /** Take over the controls of a panel. */
  mount(panel) {
    this.button = panel.querySelector(".play");
    this.slider = panel.querySelector(".time");
    const select = panel.querySelector(".pace");
    select.replaceChildren(...PACES.map((seconds) => new Option(`${seconds} s per period`, seconds, false, seconds === this.pace)));
    this.slowed = panel.querySelector(".slowed");
    this.event = panel.querySelector(".event");
    this.event.addEventListener("click", () => this.stepToEvent());
    this.button.addEventListener("click", () => this.toggle());
    this.slider.addEventListener("input", () => this.seek(this.slider.value / STEPS));
    select.addEventListener("change", () => {
      this.pace = Number(select.value);
      this.#say();
    });
    panel.querySelectorAll(".plot").forEach((frame) => this.follow(frame));
  }

  /** Let the moment follow the pointer in a chart over time. */
  follow(frame) {
    const seek = (event) => {
      const { left, width } = frame.dataset;
      if (!frame.classList.contains("over-time") || !this.motion) return;
      const share = (event.clientX - frame.getBoundingClientRect().left - left) / width;
      this.seek(Math.min(1, Math.max(0, share)) * this.length);
    };
    frame.addEventListener("pointerdown", (event) => {
      if (event.button > 0) return;
      frame.setPointerCapture(event.pointerId);
      seek(event);
    });
    frame.addEventListener("pointermove", (event) => frame.hasPointerCapture(event.pointerId) && seek(event));
  }

  /** Show a motion, or none. @param {{place: number, text: string}[]} events  of it, at places between samples, in order */
  load(motion, events = []) {
    [this.motion, this.events] = [motion, events];
    cancelAnimationFrame(this.#frame);
    if (!motion) return;
    this.length = Math.round(motion.tau.at(-1) / (2 * Math.PI));
    this.samples = (motion.tau.length - 1) / this.length;
    this.periods %= this.length;
    this.slider.max = Math.round(STEPS * this.length);
    this.event.disabled = !events.length;
    this.#say();
    this.show();
    this.#run();
  }

  toggle() {
    this.playing = !this.playing;
    this.#say();
    this.#run();
  }

  /** Stop at a moment. @param {number} periods */
  seek(periods) {
    this.playing = false;
    this.periods = Math.min(periods, this.length);
    this.#say();
    this.show();
  }

  /** Stop at the next event; after the last one the first one follows. */
  stepToEvent() {
    if (!this.motion || !this.events.length) return;
    const place = Math.round(this.periods * this.samples);
    const next = this.events.findIndex((event) => event.place > place);
    const at = Math.max(0, next);
    this.seek(this.events[at].place / this.samples);
    this.slowed.textContent = `event ${at + 1} of ${this.events.length}: ${this.events[at].text}`;
  }

  /** Show the moment again. */
  show() {
    if (!this.motion) return;
    const place = Math.min(this.periods * this.samples, this.motion.tau.length - 1);
    const words = this.onMove(Math.abs(place - Math.round(place)) < 1e-6 ? Math.round(place) : place);
    this.slider.value = Math.round(this.periods * STEPS);
    if (!this.playing) this.slider.ariaValueText = `${short(this.periods, 3)} of ${short(this.length, 3)} ${this.motion.clock ? "periods" : "excitation periods"}: ${words}`;
  }

  #run() {
    cancelAnimationFrame(this.#frame);
    this.#last = 0;
    if (this.playing && this.motion) this.#frame = requestAnimationFrame((now) => this.#step(now));
  }

  #step(now) {
    if (!this.playing || !this.motion) return;
    if (this.#last) this.periods = (this.periods + (now - this.#last) / 1000 / this.pace) % this.length;
    this.#last = now;
    this.show();
    this.#frame = requestAnimationFrame((next) => this.#step(next));
  }

  #say() {
    this.button.textContent = this.playing ? "❚❚" : "▶";
    if (this.playing) this.slider.ariaValueText = "running";
    this.button.ariaLabel = this.playing ? "Pause the motion" : "Play the motion";
    this.button.title = `${this.playing ? "Pause" : "Play"} (p)`;
    const { physical: { frequency } = {}, r, rate = r } = this.motion ?? {};
    const hertz = frequency && rate * frequency.factor * HERTZ[frequency.unit];
    this.slowed.textContent = hertz ? `slowed ${short(this.pace * hertz, 2)} times` : "";
  }
}
