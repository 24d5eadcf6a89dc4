// The map: pictures of cells, axes, boundaries, and the cells under the pointer or selected.

import { keepTo, sharp, sized } from "./axes.js";
import { Plate, areaOf } from "./plate.js";

export class RegimeMap {
  /** @param {object} about  description of the axes until there are cells */
  constructor(stage, about) {
    this.stage = stage;
    this.cells = stage.querySelector("#cells");
    this.over = stage.querySelector("#over");
    this.pictures = []; // from the oldest to the newest; the newer cover the older
    this.about = about;
    this.overlay = null; // draws over cells and boundaries: (pen, plate)
    this.view = null;
    this.hovered = this.kept = this.pointed = this.cross = this.box = null;
  }

  /** Where the cells lie, in pixels of the style sheet. */
  get area() {
    return areaOf(this.stage.getBoundingClientRect(), this.about);
  }

  get #plate() {
    return new Plate(this.area, this.view, this.pictures, this.about);
  }

  /** Cells of the finest picture: one for each pixel of the screen. */
  get size() {
    const ratio = window.devicePixelRatio || 1;
    const { width, height } = this.area;
    return { columns: Math.round(width * ratio), rows: Math.round(height * ratio) };
  }

  /** The latest complete picture: axes, legend and description belong to it, and it is the one that is saved. */
  get whole() {
    return this.pictures.findLast((picture) => picture.whole) ?? null;
  }

  /** Show a picture, or more of it. */
  show(picture) {
    if (!this.pictures.includes(picture)) this.pictures.push(picture);
    if (picture.whole) {
      this.pictures = this.pictures.slice(this.pictures.indexOf(picture));
      this.about = picture.about;
    }
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
    return this.#plate.x(r);
  }

  y(beta) {
    return this.#plate.y(beta);
  }

  draw() {
    if (!this.view) return;
    const { x, y, width } = this.area;
    const zoom = this.stage.querySelector("#zoom"); // in the upper right corner of the cells
    [zoom.style.left, zoom.style.top] = [`${x + width - 40}px`, `${y + 8}px`];
    this.#plate.drawCells(sharp(this.cells).pen);
    this.drawOver();
  }

  /** Draw axes, boundaries, marks, and the cells under the pointer or selected. */
  drawOver() {
    const { pen } = sharp(this.over);
    this.#plate.drawLines(pen);
    this.overlay?.(pen, this.#plate);
    this.#drawPointers(pen);
  }

  #drawPointers(pen) {
    keepTo(pen, this.area);
    if (this.cross) crosshair(pen, this.#plate, this.cross);
    if (this.kept) ring(pen, this.#plate, this.kept, true);
    const cell = this.hovered ? [this.hovered.r, this.hovered.beta] : !this.kept && this.pointed;
    if (cell) ring(pen, this.#plate, cell, false);
    if (this.box) {
      const { x, y, width, height } = this.box;
      pen.fillStyle = "rgb(43 79 166 / 0.2)";
      pen.fillRect(x, y, width, height);
      pen.strokeStyle = "#2b4fa6";
      pen.strokeRect(x, y, width, height);
    }
    pen.restore();
  }
}

/** Lines through a place, across the whole map. */
function crosshair(pen, plate, [r, beta]) {
  const { x, y, width, height } = plate.area;
  for (const [thick, ink] of [[3, "rgb(255 255 255 / 0.7)"], [1, "#c2185b"]]) {
    [pen.lineWidth, pen.strokeStyle] = [thick, ink];
    pen.beginPath();
    pen.moveTo(plate.x(r), y);
    pen.lineTo(plate.x(r), y + height);
    pen.moveTo(x, plate.y(beta));
    pen.lineTo(x + width, plate.y(beta));
    pen.stroke();
  }
}

/** A ring around a cell. */
export function ring(pen, plate, [r, beta], kept) {
  const [x, y] = [plate.x(r), plate.y(beta)];
  for (const [width, ink] of [[kept ? 4 : 3, "#fff"], [kept ? 2 : 1.2, kept ? "#c2185b" : "#000"]]) {
    [pen.lineWidth, pen.strokeStyle] = [sized(width), ink];
    pen.beginPath();
    pen.arc(x, y, sized(kept ? 7 : 5), 0, 2 * Math.PI);
    if (kept) {
      for (const [across, up] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        pen.moveTo(x + sized(7) * across, y + sized(7) * up);
        pen.lineTo(x + sized(14) * across, y + sized(14) * up);
      }
    }
    pen.stroke();
  }
}
