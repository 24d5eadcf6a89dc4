// Maps from the page itself: it was written as one file, with maps computed for the places of its sliders.

import { unpack } from "./packet.js";

async function inflated(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

/** A quantity from the steps that it was stored in; 0 has none. */
function valuesOf(steps, { low, high, log }) {
  return Float32Array.from(steps, (step) => {
    if (step === 0) return NaN;
    const share = (step - 1) / 254;
    return log ? low * (high / low) ** share : low + share * (high - low);
  });
}

export class Stored {
  live = false;

  /** @param {string} text  content of the page */
  static async open(text) {
    return new Stored(JSON.parse(text));
  }

  constructor(content) {
    this.content = content;
    const { r, beta, columns, rows, values } = content;
    this.fixed = { r, beta, columns, rows, values };
  }

  async scene() {
    return this.content.scene;
  }

  /** The map of a view, which has one: see `kept`. */
  async map(view, scene) {
    const kept = this.content.maps[this.#name(view, scene)];
    const about = this.content.systems[kept.about];
    const packet = { about, classes: new Uint8Array(await inflated(kept.classes)), stops: kept.stops };
    const limits = new Float64Array(await inflated(kept.limits));
    const { columns } = this.fixed;
    const names = about.lines.flatMap((line) => line.names);
    names.forEach((name, k) => (packet[name] = limits.subarray(k * columns, (k + 1) * columns)));
    const quantity = kept.values[view.quantity];
    if (quantity) packet.values = valuesOf(new Uint8Array(await inflated(quantity.steps)), quantity);
    return packet;
  }

  /** The cell whose motion the file has: {cell}. */
  async example() {
    return { cell: this.content.example?.cell ?? null };
  }

  /** Whether the file has motions over the map of a view. */
  hasMotions(view, scene) {
    return Boolean(this.content.maps[this.#name(view, scene)]?.motions);
  }

  /** The motion in a cell: that of the example, else the nearest one that the file has. */
  async motion(view, scene, [r, beta]) {
    const { example, first } = this.content;
    const name = this.#name(view, scene);
    if (name === first && example && example.cell[0] === r && example.cell[1] === beta) return unpack(await inflated(example.motion));
    const { columns, rows } = this.content.maps[name].motions;
    const place = (value, [low, high], count) => Math.min(count - 1, Math.max(0, Math.floor(((value - low) / (high - low)) * count)));
    const packets = await this.#packets(name);
    return { ...unpack(packets[place(beta, this.fixed.beta, rows) * columns + place(r, this.fixed.r, columns)]), nearest: true };
  }

  /** The motions of a map; those of the last one are kept. */
  async #packets(name) {
    if (this.last?.name !== name) {
      const bytes = await inflated(this.content.maps[name].motions.packets);
      const sizes = new DataView(bytes);
      const packets = [];
      for (let at = 0; at < bytes.byteLength; at += 4 + sizes.getUint32(at, true)) packets.push(bytes.slice(at + 4, at + 4 + sizes.getUint32(at, true)));
      this.last = { name, packets };
    }
    return this.last.packets;
  }

  /** The name of the map of a view: the places of its sliders. */
  #name(view, scene) {
    const numbers = { mu: view.mu, ...view.numbers };
    const places = scene.sliders.map(({ key, value }) => this.fixed.values[key].indexOf(numbers[key] ?? value));
    return places.join(",");
  }

  /**
   * A view that the file has a map of.  Not all sliders were moved together: where there is no map with the numbers of
   * a view, as many of them as needed go back to where the scene has them, the last ones first.
   * @param {string} [moved]  the slider that stays
   * @returns {{view: object, back: object[]}}  the sliders that went back
   */
  kept(view, scene, moved = "") {
    const back = [];
    for (const slider of [...scene.sliders].reverse()) {
      if (this.#name(view, scene) in this.content.maps) break;
      const { key, value } = slider;
      if (key === moved || (key === "mu" ? view.mu : view.numbers[key] ?? value) === value) continue;
      const { [key]: _, ...numbers } = view.numbers;
      view = { ...view, numbers, mu: key === "mu" ? value : view.mu };
      back.push(slider);
    }
    return { view, back };
  }
}
