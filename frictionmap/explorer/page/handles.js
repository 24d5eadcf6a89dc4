// Two handles on the frequency axis of the map: the ends of a band of frequencies.

import { make } from "./dom.js";

/** Share of the range shown by which an arrow key moves a handle; with shift. */
const STEP = 0.01;
const FINE = 0.001;

/** Half the width of a handle, and its height, in pixels of the style sheet. */
const HALF = 10;
const HEIGHT = 22;

const NAMES = ["lower end of the band", "upper end of the band"];
const ARROWS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 };

/** A frequency ratio with no more digits than can be seen. */
function tidy(r, [low, high]) {
  return Number(r.toFixed(Math.min(15, Math.max(0, 4 - Math.floor(Math.log10(high - low))))));
}

export class Handles {
  /**
   * @param {import("./map.js").RegimeMap} map
   * @param {(band: [number, number], done: boolean) => void} onMove  done: the handle is at rest
   */
  constructor(map, onMove) {
    [this.map, this.onMove, this.band, this.held] = [map, onMove, null, null];
    this.buttons = NAMES.map((name, end) => {
      const made = make("button", { type: "button", className: "handle", title: `${name}: drag it, or use the arrow keys`, hidden: true });
      made.setAttribute("role", "slider");
      made.setAttribute("aria-label", name);
      this.#listen(made, end);
      map.stage.append(made);
      return made;
    });
  }

  #listen(button, end) {
    const pointed = (event) => this.map.at(event.clientX - this.map.stage.getBoundingClientRect().left, 0)[0];
    button.addEventListener("pointerdown", (event) => {
      if (event.button > 0) return;
      button.setPointerCapture(event.pointerId);
      this.held = end;
    });
    button.addEventListener("pointermove", (event) => {
      event.stopPropagation(); // the map shows no motion under a handle
      if (this.held === end) this.#move(end, pointed(event), false);
    });
    const lift = () => {
      if (this.held !== end) return;
      this.held = null;
      this.onMove(this.band, true);
    };
    for (const kind of ["pointerup", "pointercancel"]) button.addEventListener(kind, lift);
    button.addEventListener("keydown", (event) => {
      if (!(event.key in ARROWS)) return;
      event.preventDefault();
      event.stopPropagation(); // the map stays where it is
      const { r } = this.map.view;
      this.#move(end, this.band[end] + ARROWS[event.key] * (event.shiftKey ? FINE : STEP) * (r[1] - r[0]), true);
    });
  }

  /** Move an end; it stays on the map, and on its side of the other one. */
  #move(end, wanted, done) {
    const { r } = this.map.view;
    const room = FINE * (r[1] - r[0]);
    const other = this.band[1 - end];
    const least = end === 0 ? Math.max(r[0], room) : other + room;
    const most = end === 0 ? other - room : r[1];
    const place = tidy(Math.min(most, Math.max(least, wanted)), r);
    this.onMove(end === 0 ? [place, other] : [other, place], done);
  }

  /** Show the handles at the ends of a band, those that lie on the map; none without a band. */
  place(band, plate) {
    const { area, ranges } = plate;
    this.band = band;
    this.buttons.forEach((button, end) => {
      const r = band?.[end];
      button.hidden = !band || r < ranges.r[0] || r > ranges.r[1];
      if (button.hidden) return;
      [button.style.left, button.style.top] = [`${plate.x(r) - HALF}px`, `${area.y + area.height - HEIGHT}px`];
      const about = { valuenow: r, valuemin: end ? band[0] : 0, valuemax: end ? ranges.r[1] : band[1], valuetext: `r = ${r}` };
      for (const [name, value] of Object.entries(about)) button.setAttribute(`aria-${name}`, String(value));
    });
  }
}
