// Maps from the page itself: it was written as one file, with maps computed for the places of its sliders.

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

  /** @param {string} text  what the page holds */
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

  /** The map of a view: that of the places of its sliders; of two that are not kept together, the first one. */
  async map(view, scene) {
    const numbers = { mu: view.mu, ...view.numbers };
    const place = scene.sliders
      .filter((slider) => this.fixed.values[slider.key])
      .map((slider) => this.#nearest(this.fixed.values[slider.key], numbers[slider.key] ?? slider.value));
    const kept = this.content.maps[place.join(",")] ?? this.content.maps[this.content.first];
    const packet = { classes: new Uint8Array(await inflated(kept.classes)), stops: kept.stops };
    const limits = new Float64Array(await inflated(kept.limits));
    const { columns } = this.fixed;
    [packet.beta_lim, packet.beta_stick] = [limits.subarray(0, columns), limits.subarray(columns)];
    const quantity = kept.values[view.quantity];
    if (quantity) packet.values = valuesOf(new Uint8Array(await inflated(quantity.steps)), quantity);
    return packet;
  }

  /** Which of the places of a slider is next to a value. */
  #nearest(values, value) {
    const away = values.map((known) => Math.abs(known - value));
    return away.indexOf(Math.min(...away));
  }
}
