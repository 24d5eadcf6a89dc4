// One moment of a motion in its charts: a line over time, a dot in loops.

import { make } from "./dom.js";

/** A curve at a place between samples. @param {number} from  index of its first sample */
export function sampled(values, place, from = 0) {
  const before = Math.floor(place);
  const share = place - before;
  return share ? (1 - share) * values[from + before] + share * values[from + before + 1] : values[from + before];
}

export class Moment {
  #marks = [];

  clear() {
    this.#marks = [];
  }

  /** Mark the moment in a chart over time. @param {{area: object, x: function}} drawn  as `draw` returns it */
  line(canvas, drawn, time) {
    const element = markOf(canvas, "line");
    Object.assign(element.style, { top: `${drawn.area.y}px`, height: `${drawn.area.height}px` });
    Object.assign(canvas.parentNode.dataset, { left: drawn.area.x, width: drawn.area.width });
    this.#marks.push((place) => (element.style.transform = `translateX(${drawn.x(sampled(time, place)).toFixed(2)}px)`));
  }

  /** Mark the moment on a loop. */
  dot(canvas, drawn, xs, ys) {
    const element = markOf(canvas, "dot");
    this.#marks.push((place) => (element.style.transform = `translate(${drawn.x(sampled(xs, place)).toFixed(2)}px, ${drawn.y(sampled(ys, place)).toFixed(2)}px)`));
  }

  set(place) {
    for (const mark of this.#marks) mark(place);
  }
}

/** The mark over a canvas, made where there is none yet. */
function markOf(canvas, kind) {
  const frame = canvas.parentNode;
  frame.classList.toggle("over-time", kind === "line");
  return frame.querySelector(`.mark.${kind}`) ?? frame.appendChild(make("i", { className: `mark ${kind}`, ariaHidden: "true" }));
}
