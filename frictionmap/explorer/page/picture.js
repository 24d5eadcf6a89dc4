// A picture: cells that come in piece by piece, on a canvas of their own, with the view that they were computed for
// and their description by the server.  Everything shown or saved with cells is taken from their picture.

import { short } from "./axes.js";
import { painter, scaleOf } from "./colours.js";

export class Picture {
  /**
   * @param {import("./address.js").View} view  requested view
   * @param {{r: [number, number], beta: [number, number]}} ranges  covered ranges
   * @param {number} columns
   * @param {number} rows
   * @param {Uint32Array} table  colours of classes
   * @param {string} kind        scale of its quantity: "classes", "linear" or "log"
   * @param {object | null} scale  of the colours, if it is known already
   */
  constructor(view, ranges, columns, rows, table, kind, scale = null) {
    this.view = view;
    this.about = null; // the system, its units, marks and quantities, as the server describes them
    this.r = [...ranges.r];
    this.beta = [...ranges.beta];
    [this.columns, this.rows, this.table, this.kind, this.scale] = [columns, rows, table, kind, scale];
    this.canvas = document.createElement("canvas");
    [this.canvas.width, this.canvas.height] = [columns, rows];
    this.classes = new Uint8Array(columns * rows);
    this.values = kind === "classes" ? null : new Float32Array(columns * rows);
    this.limits = {}; // the boundaries by name, over the columns
    this.lines = null; // the boundaries, finer than the cells
    this.filled = 0; // columns from the left that are there
    this.stops = {};
  }

  get whole() {
    return this.filled === this.columns;
  }

  /** Put in the columns of a packet from `first` on. */
  put(packet, first) {
    const count = packet.classes.length / this.rows;
    this.about = packet.about;
    this.classes.set(packet.classes, first * this.rows);
    if (this.values) this.values.set(packet.values, first * this.rows);
    for (const name of packet.about.lines.flatMap(({ names }) => names).filter((one) => packet[one])) {
      this.limits[name] ??= new Float64Array(this.columns).fill(NaN);
      this.limits[name].set(packet[name], first);
    }
    this.#countStops(packet.stops ?? {});
    if (this.values && !this.scale) this.scale = scaleOf(packet.values, packet.classes, this.kind);
    this.#paint(first, count);
    this.filled = first + count;
  }

  #countStops(found) {
    for (const [index, [low, high]] of Object.entries(found)) {
      const [least, most] = this.stops[index] ?? [Infinity, -Infinity];
      this.stops[index] = [Math.min(least, low), Math.max(most, high)];
    }
  }

  /** Colour columns; cells lie column by column, pixels row by row from the top. */
  #paint(first, count) {
    const { rows, classes, values } = this;
    const image = new ImageData(count, rows);
    const pixels = new Uint32Array(image.data.buffer);
    const paint = painter(this.table, this.values && this.scale);
    for (let column = 0; column < count; column += 1) {
      let cell = (first + column) * rows;
      for (let at = (rows - 1) * count + column; at >= 0; at -= count, cell += 1) {
        pixels[at] = paint(classes[cell], values ? values[cell] : 0);
      }
    }
    this.canvas.getContext("2d").putImageData(image, first, 0);
  }

  /** Which cell a point lies in; null beside the picture, or where nothing is yet. */
  cellAt([r, beta]) {
    const column = Math.floor(((r - this.r[0]) / (this.r[1] - this.r[0])) * this.columns);
    const line = Math.floor(((beta - this.beta[0]) / (this.beta[1] - this.beta[0])) * this.rows);
    if (column < 0 || line < 0 || column >= this.filled || line >= this.rows) return null;
    const index = column * this.rows + line;
    return { r: this.#middle("r", column, this.columns), beta: this.#middle("beta", line, this.rows),
      picture: this, class: this.classes[index], value: this.values ? this.values[index] : null };
  }

  /** The middle of a cell: a number with no more digits than its place has. */
  #middle(axis, k, count) {
    const [low, high] = this[axis];
    const size = (high - low) / count;
    return Number((low + (k + 0.5) * size).toFixed(Math.min(15, Math.max(0, 2 - Math.floor(Math.log10(size))))));
  }

  /** How many cells each class has in the ranges of the view: a page that is a file has cells beyond them. */
  counts() {
    const found = new Uint32Array(this.table.length);
    const [left, right] = this.#within("r", this.columns);
    const [low, high] = this.#within("beta", this.rows);
    for (let column = left; column < Math.min(right, this.filled); column += 1) {
      for (let k = column * this.rows + low; k < column * this.rows + high; k += 1) found[this.classes[k]] += 1;
    }
    return found;
  }

  /** The first of the cells whose middles lie in the range of the view, and the one after the last. */
  #within(axis, count) {
    const [low, high] = this[axis];
    const places = this.view[axis].map((end) => Math.round(((end - low) / (high - low)) * count));
    return places.map((place) => Math.min(count, Math.max(0, place)));
  }

  /** The boundaries that have values in the picture. */
  get boundaries() {
    return this.about.lines.filter(({ lower, names }) => lower || names.some((name) => (this.limits[name] ?? this.lines?.[name] ?? []).some(Number.isFinite)));
  }

  /** Quantity that colours the cells: {key, label, scale}. */
  get quantity() {
    return this.about.quantities.find(({ key }) => key === this.view.quantity);
  }

  /** Description of the parameters of the cells. */
  get words() {
    const start = this.view.start === "rest" ? "start at rest" : "start in motion";
    const cells = `${this.columns} × ${this.rows} cells`;
    const shown = this.about.contact ? `${this.quantity.label} of ${this.about.contact}` : this.quantity.label;
    return [this.about.system, `μ = ${short(this.view.mu)}`, ...(this.about.across.key === "r" ? [start] : []), shown, cells].join("; ");
  }
}
