// The map: pictures of cells under axes, boundaries and the cells that are pointed at.

import { colour, keepTo, sharp, ticks } from "./axes.js";

/** Room for numbers and names around the cells, in pixels of the style sheet. */
const ROOM = { left: 64, right: 16, top: 18, bottom: 50 };

/** Boundaries: how they are drawn. */
export const LINES = {
  beta_lim: { label: "β", index: "lim", dash: [], meaning: "slides without stopping below it" },
  beta_stick: { label: "β", index: "stick", dash: [7, 4], meaning: "can stick for good from it on" },
};

const FONT = "12px system-ui, sans-serif";

export class RegimeMap {
  constructor(stage) {
    this.stage = stage;
    this.cells = stage.querySelector("#cells");
    this.over = stage.querySelector("#over");
    this.pictures = []; // from the oldest to the newest; the newer cover the older
    this.view = null;
    this.marks = {};
    this.hovered = this.kept = this.box = null;
    this.names = { r: "", beta: "" };
    this.seconds = { r: null, beta: null }; // further axes in units: {factor, name}
  }

  /** Where the cells lie, in pixels of the style sheet. */
  get area() {
    const { width, height } = this.stage.getBoundingClientRect();
    const right = this.seconds.beta ? ROOM.right + 44 : ROOM.right;
    const top = this.seconds.r ? ROOM.top + 26 : ROOM.top;
    const ratio = window.devicePixelRatio || 1;
    const whole = (length) => Math.floor(length * ratio) / ratio; // cells are pixels: none lies across two
    return {
      x: whole(ROOM.left), y: whole(top),
      width: whole(Math.max(40, width - ROOM.left - right)), height: whole(Math.max(40, height - top - ROOM.bottom)),
    };
  }

  /** Cells of the finest picture: one for each pixel of the screen. */
  get size() {
    const ratio = window.devicePixelRatio || 1;
    const { width, height } = this.area;
    return { columns: Math.round(width * ratio), rows: Math.round(height * ratio) };
  }

  /** The newest picture. */
  get picture() {
    return this.pictures.at(-1) ?? null;
  }

  /** A picture has come, or more of it. */
  show(picture) {
    if (!this.pictures.includes(picture)) this.pictures.push(picture);
    if (picture.whole) this.pictures = this.pictures.slice(this.pictures.indexOf(picture));
    this.draw();
  }

  /** r and beta at a point of the stage. */
  at(x, y) {
    const { area, view } = this;
    return [
      view.r[0] + ((x - area.x) / area.width) * (view.r[1] - view.r[0]),
      view.beta[0] + ((area.y + area.height - y) / area.height) * (view.beta[1] - view.beta[0]),
    ];
  }

  inside(x, y) {
    const { area } = this;
    return x >= area.x && x < area.x + area.width && y >= area.y && y < area.y + area.height;
  }

  /** The cell at a point of the stage, of the newest picture that has one there. */
  cellAt(x, y) {
    if (!this.inside(x, y)) return null;
    const point = this.at(x, y);
    for (const picture of [...this.pictures].reverse()) {
      const cell = picture.cellAt(point);
      if (cell) return cell;
    }
    return null;
  }

  x(r) {
    const { area, view } = this;
    return area.x + ((r - view.r[0]) / (view.r[1] - view.r[0])) * area.width;
  }

  y(beta) {
    const { area, view } = this;
    return area.y + area.height - ((beta - view.beta[0]) / (view.beta[1] - view.beta[0])) * area.height;
  }

  draw() {
    if (!this.view) return;
    const { x, y, width } = this.area;
    const zoom = this.stage.querySelector("#zoom"); // in the upper right corner of the cells
    [zoom.style.left, zoom.style.top] = [`${x + width - 40}px`, `${y + 8}px`];
    this.#drawCells(sharp(this.cells).pen);
    this.drawOver();
  }

  /** All pictures, each where it belongs in the present view. */
  #drawCells(pen) {
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

  /** Axes, boundaries, marks, the cells that are pointed at. */
  drawOver() {
    const { pen } = sharp(this.over);
    this.drawBoundaries(pen);
    this.drawAxes(pen);
    this.#drawPointers(pen);
  }

  /** The boundaries as fine as there are any. */
  drawBoundaries(pen) {
    const known = this.pictures.filter((picture) => picture.whole || picture.lines);
    const picture = known.at(-1) ?? this.picture;
    if (!picture) return;
    keepTo(pen, this.area);
    for (const [name, { dash }] of Object.entries(LINES)) {
      const path = this.#path(picture, (picture.lines ?? picture.limits)[name]);
      for (const [width, ink, dashes] of [[3.6, "rgb(255 255 255 / 0.75)", []], [1.5, "#000", dash]]) {
        [pen.lineWidth, pen.strokeStyle] = [width, ink];
        pen.setLineDash(dashes);
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

  drawAxes(pen) {
    const { area, view } = this;
    const [ink, faint] = [colour("ink"), colour("faint")];
    [pen.lineWidth, pen.strokeStyle, pen.fillStyle, pen.font] = [1, faint, ink, FONT];
    pen.strokeRect(area.x - 0.5, area.y - 0.5, area.width + 1, area.height + 1);
    const bottom = area.y + area.height;
    pen.beginPath();
    [pen.textAlign, pen.textBaseline] = ["center", "top"];
    for (const { value, text } of ticks(view.r, area.width / 75)) {
      const x = this.x(value);
      pen.moveTo(x, bottom);
      pen.lineTo(x, bottom + 5);
      pen.fillText(text, x, bottom + 8);
    }
    [pen.textAlign, pen.textBaseline] = ["right", "middle"];
    for (const { value, text } of ticks(view.beta, area.height / 50)) {
      const y = this.y(value);
      pen.moveTo(area.x - 5, y);
      pen.lineTo(area.x, y);
      pen.fillText(text, area.x - 8, y);
    }
    pen.stroke();
    this.#name(pen, this.names.r, area.x + area.width / 2, bottom + 40, 0);
    this.#name(pen, this.names.beta, 15, area.y + area.height / 2, -Math.PI / 2);
    this.#drawSeconds(pen);
    this.#drawMarks(pen);
  }

  /** The same axes in units. */
  #drawSeconds(pen) {
    const { area, view, seconds } = this;
    if (seconds.r) {
      const { factor, name } = seconds.r;
      [pen.textAlign, pen.textBaseline] = ["center", "bottom"];
      for (const { value, text } of ticks(view.r.map((r) => r * factor), area.width / 90)) {
        pen.fillText(text, this.x(value / factor), area.y - 12);
      }
      pen.textAlign = "right";
      pen.fillText(name, area.x + area.width, area.y - 26);
    }
    if (seconds.beta) {
      const { factor, name } = seconds.beta;
      [pen.textAlign, pen.textBaseline] = ["left", "middle"];
      for (const { value, text } of ticks(view.beta.map((beta) => beta * factor), area.height / 50)) {
        pen.fillText(text, area.x + area.width + 6, this.y(value / factor));
      }
      this.#name(pen, name, area.x + area.width + 50, area.y + area.height / 2, -Math.PI / 2);
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
    const { area, view } = this;
    for (const [name, places] of Object.entries(this.marks)) {
      for (const place of places.filter((r) => r >= view.r[0] && r <= view.r[1])) {
        const x = this.x(place);
        pen.beginPath();
        pen.moveTo(x - 4.5, area.y - 9);
        pen.lineTo(x + 4.5, area.y - 9);
        pen.lineTo(x, area.y - 1);
        pen.closePath();
        pen.fillStyle = name.includes("held") ? colour("panel") : colour("ink");
        pen.strokeStyle = colour("ink");
        pen.fill();
        pen.stroke();
      }
    }
  }

  #drawPointers(pen) {
    keepTo(pen, this.area);
    if (this.kept) this.#ring(pen, this.kept, true);
    if (this.hovered) this.#ring(pen, [this.hovered.r, this.hovered.beta], false);
    if (this.box) {
      const { x, y, width, height } = this.box;
      pen.fillStyle = "rgb(43 79 166 / 0.2)";
      pen.fillRect(x, y, width, height);
      pen.strokeStyle = "#2b4fa6";
      pen.strokeRect(x, y, width, height);
    }
    pen.restore();
  }

  #ring(pen, [r, beta], kept) {
    const [x, y] = [this.x(r), this.y(beta)];
    for (const [width, ink] of [[kept ? 4 : 3, "#fff"], [kept ? 2 : 1.2, kept ? "#c2185b" : "#000"]]) {
      [pen.lineWidth, pen.strokeStyle] = [width, ink];
      pen.beginPath();
      pen.arc(x, y, kept ? 7 : 5, 0, 2 * Math.PI);
      if (kept) {
        for (const [across, up] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
          pen.moveTo(x + 7 * across, y + 7 * up);
          pen.lineTo(x + 14 * across, y + 14 * up);
        }
      }
      pen.stroke();
    }
  }
}
