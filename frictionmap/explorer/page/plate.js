// Cells with axes, boundaries and marks in an area of a canvas: the map of the page, or a saved one.

import { colour, font, keepTo, sized, ticks } from "./axes.js";

/** Room for numbers and names around the cells, in pixels of the style sheet; more where an axis has units. */
const ROOM = { left: 64, right: 16, top: 18, bottom: 50 };
const SECOND = { right: 44, top: 26 };

/** Further axes of a map in units, where they are known: {factor, name}. */
function secondsOf({ physical, across }) {
  const axis = (name, one) => (one ? { factor: one.factor, name: `${name} [${one.unit}]` } : null);
  return { r: axis(across.words, physical[across.measure]), beta: axis("friction force", physical.force) };
}

/** Names of the axes of a map. */
function namesOf({ units, across }) {
  return { r: across.name, beta: `friction ratio β = ${units.beta}` };
}

/** Where the cells lie on a canvas, in pixels of the style sheet. @param {object} about  description of the cells */
export function areaOf({ width, height }, about) {
  const seconds = secondsOf(about);
  const right = sized(seconds.beta ? ROOM.right + SECOND.right : ROOM.right);
  const top = sized(seconds.r ? ROOM.top + SECOND.top : ROOM.top);
  const [left, bottom] = [sized(ROOM.left), sized(ROOM.bottom)];
  const ratio = window.devicePixelRatio || 1;
  const whole = (length) => Math.floor(length * ratio) / ratio; // cells are pixels: none lies across two
  return {
    x: whole(left), y: whole(top),
    width: whole(Math.max(40, width - left - right)), height: whole(Math.max(40, height - top - bottom)),
  };
}

export class Plate {
  /**
   * @param {object} area     where the cells lie
   * @param {{r: [number, number], beta: [number, number]}} ranges  of the axes
   * @param {import("./picture.js").Picture[]} pictures  from the oldest to the newest; the newer cover the older
   * @param {object} about    description of the cells: its names, units and marks are those of the axes
   */
  constructor(area, ranges, pictures, about) {
    [this.area, this.ranges, this.pictures, this.about] = [area, ranges, pictures, about];
  }

  x(r) {
    const { area, ranges } = this;
    return area.x + ((r - ranges.r[0]) / (ranges.r[1] - ranges.r[0])) * area.width;
  }

  y(beta) {
    const { area, ranges } = this;
    return area.y + area.height - ((beta - ranges.beta[0]) / (ranges.beta[1] - ranges.beta[0])) * area.height;
  }

  /** All pictures, each where it belongs in the ranges of the axes. */
  drawCells(pen) {
    const { area } = this;
    keepTo(pen, area);
    pen.fillStyle = colour("back");
    pen.fillRect(area.x, area.y, area.width, area.height);
    pen.imageSmoothingEnabled = false;
    for (const picture of this.pictures) {
      const [left, right] = picture.r.map((r) => this.x(r));
      const [bottom, top] = picture.beta.map((beta) => this.y(beta));
      const share = picture.filled / picture.columns;
      if (picture.filled) {
        pen.drawImage(picture.canvas, 0, 0, picture.filled, picture.rows, left, top, (right - left) * share, bottom - top);
      }
    }
    pen.restore();
  }

  /** Boundaries, axes and marks, over the cells. */
  drawLines(pen) {
    this.#drawBoundaries(pen);
    this.#drawAxes(pen);
  }

  /** The boundaries at the finest resolution available. */
  #drawBoundaries(pen) {
    const known = this.pictures.filter((picture) => picture.whole || picture.lines);
    const picture = known.at(-1) ?? this.pictures.at(-1);
    if (!picture) return;
    keepTo(pen, this.area);
    const curves = picture.about.lines.flatMap(({ names, dashes, upright }) => names.map((name) => [name, dashes, upright]));
    for (const [name, dash, upright] of curves) {
      const values = (picture.lines ?? picture.limits)[name] ?? [];
      const path = upright ? this.#uprightPath(picture, values) : this.#path(picture, values);
      for (const [width, ink, dashes] of [[3.6, "rgb(255 255 255 / 0.75)", []], [1.5, "#000", dash]]) {
        [pen.lineWidth, pen.strokeStyle] = [sized(width), ink];
        pen.setLineDash(dashes.map(sized));
        pen.stroke(path);
      }
    }
    pen.restore();
  }

  #path(picture, values) {
    const path = new Path2D();
    const size = (picture.r[1] - picture.r[0]) / values.length;
    const [low, high] = [this.area.y - 50, this.area.y + this.area.height + 50];
    let drawn = false;
    for (let k = 0; k < values.length; k += 1) {
      if (Number.isNaN(values[k])) {
        drawn = false;
        continue;
      }
      const y = Math.min(high, Math.max(low, this.y(values[k])));
      path[drawn ? "lineTo" : "moveTo"](this.x(picture.r[0] + (k + 0.5) * size), y);
      drawn = true;
    }
    return path;
  }

  /** The path of a limit whose values over friction lie along the axis across. */
  #uprightPath(picture, values) {
    const path = new Path2D();
    const size = (picture.beta[1] - picture.beta[0]) / values.length;
    const most = this.area.x + this.area.width + 50;
    values.forEach((value, k) => path[k ? "lineTo" : "moveTo"](Math.min(most, this.x(value)), this.y(picture.beta[0] + (k + 0.5) * size)));
    return path;
  }

  #drawAxes(pen) {
    const { area, ranges } = this;
    const names = namesOf(this.about);
    const [ink, faint] = [colour("ink"), colour("faint")];
    [pen.lineWidth, pen.strokeStyle, pen.fillStyle, pen.font] = [1, faint, ink, font(12)];
    pen.strokeRect(area.x - 0.5, area.y - 0.5, area.width + 1, area.height + 1);
    const bottom = area.y + area.height;
    pen.beginPath();
    [pen.textAlign, pen.textBaseline] = ["center", "top"];
    for (const { value, text } of ticks(ranges.r, area.width / sized(75))) {
      const x = this.x(value);
      pen.moveTo(x, bottom);
      pen.lineTo(x, bottom + 5);
      pen.fillText(text, x, bottom + 8);
    }
    [pen.textAlign, pen.textBaseline] = ["right", "middle"];
    for (const { value, text } of ticks(ranges.beta, area.height / sized(50))) {
      const y = this.y(value);
      pen.moveTo(area.x - 5, y);
      pen.lineTo(area.x, y);
      pen.fillText(text, area.x - 8, y);
    }
    pen.stroke();
    this.#name(pen, names.r, area.x + area.width / 2, bottom + sized(40), 0);
    this.#name(pen, names.beta, sized(15), area.y + area.height / 2, -Math.PI / 2);
    this.#drawSeconds(pen);
    this.#drawMarks(pen);
  }

  /** The same axes in units. */
  #drawSeconds(pen) {
    const { area, ranges } = this;
    const seconds = secondsOf(this.about);
    if (seconds.r) {
      const { factor, name } = seconds.r;
      [pen.textAlign, pen.textBaseline] = ["center", "bottom"];
      for (const { value, text } of ticks(ranges.r.map((r) => r * factor), area.width / sized(90))) {
        pen.fillText(text, this.x(value / factor), area.y - sized(12));
      }
      pen.textAlign = "right";
      pen.fillText(name, area.x + area.width, area.y - sized(26));
    }
    if (seconds.beta) {
      const { factor, name } = seconds.beta;
      [pen.textAlign, pen.textBaseline] = ["left", "middle"];
      for (const { value, text } of ticks(ranges.beta.map((beta) => beta * factor), area.height / sized(50))) {
        pen.fillText(text, area.x + area.width + 6, this.y(value / factor));
      }
      this.#name(pen, name, area.x + area.width + sized(50), area.y + area.height / 2, -Math.PI / 2);
    }
  }

  #name(pen, text, x, y, angle) {
    pen.save();
    pen.translate(x, y);
    pen.rotate(angle);
    [pen.textAlign, pen.textBaseline] = ["center", "middle"];
    pen.fillText(text, 0, 0);
    pen.restore();
  }

  /** Frequencies of the system on the upper edge: full where it is free, open where its contact is held. */
  #drawMarks(pen) {
    const { area, ranges } = this;
    for (const [name, places] of Object.entries(this.about.marks)) {
      for (const place of places.filter((r) => r >= ranges.r[0] && r <= ranges.r[1])) {
        const x = this.x(place);
        pen.beginPath();
        pen.moveTo(x - sized(4.5), area.y - 1 - sized(8));
        pen.lineTo(x + sized(4.5), area.y - 1 - sized(8));
        pen.lineTo(x, area.y - 1);
        pen.closePath();
        pen.fillStyle = name.includes("held") ? colour("panel") : colour("ink");
        pen.strokeStyle = colour("ink");
        pen.fill();
        pen.stroke();
      }
    }
  }
}
