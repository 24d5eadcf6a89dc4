// A coarse picture first, then finer ones; outdated requests are cancelled at once.

import { Costs } from "./costs.js";
import { Picture } from "./picture.js";

/** Milliseconds that a first picture may take, that a piece of a finer one should take, and that all may take. */
const FIRST = 70;
const PIECE = 160;
const LONGEST = 30000;

/** Milliseconds after which an outdated first picture is cancelled: until then it is worth showing. */
const PATIENCE = 400;

/** Pixels that a cell of the first picture has at most, each way. */
const COARSEST = 32;

export class Refiner {
  #costs = new Costs();
  #running = null;
  #waiting = null;
  #last = null;
  #begun = false;

  /**
   * @param {object} source        where maps come from
   * @param {(picture: Picture) => void} onPicture  called when cells have come in
   * @param {(state: object) => void} onState      called with the state of the work
   */
  constructor(source, onPicture, onState) {
    [this.source, this.onPicture, this.onState] = [source, onPicture, onState];
  }

  /**
   * Request pictures of a view; earlier requests are cancelled.
   * @param {object} request  {view, scene, columns, rows, table, kind, scale}; boundaries as fine as the screen, once
   *   they are there, are its `lines`
   */
  ask(request) {
    this.#waiting = request;
    const running = this.#running;
    if (!running) {
      this.#next();
    } else if (running.seen || performance.now() - running.began > PATIENCE) {
      running.control.abort();
    }
  }

  /** Continue with finer pictures, however long they take. */
  more() {
    if (this.#last) this.ask({ ...this.#last, patient: true });
  }

  async #next() {
    const request = this.#waiting;
    this.#waiting = null;
    if (!request) return;
    const run = { control: new AbortController(), began: performance.now(), seen: false };
    this.#running = run;
    this.#last = request;
    try {
      await this.#refine(request, run);
    } catch (error) {
      if (error.name !== "AbortError") this.onState({ error });
    }
    this.#running = null;
    this.#next();
  }

  /** Milliseconds that the finest picture of the view will take. */
  get whole() {
    return this.#last && this.#costs.of(this.#last, this.#last.columns * this.#last.rows);
  }

  /** Pixels of a cell in the pictures to come. */
  #blocks(request) {
    if (this.source.fixed) return [1];
    const cells = request.columns * request.rows;
    let block = 1;
    while (this.#costs.of(request, cells / block ** 2) > 1.5 * FIRST && block < COARSEST) block *= 2;
    const blocks = [block];
    while (block > 1) {
      block = block > 4 ? block / 4 : 1;
      blocks.push(block);
    }
    return blocks;
  }

  /** Show the boundaries alone: the first map of a page may wait for compilation. */
  async #drawLines(request, signal) {
    const { view, scene, columns } = request;
    if (!scene.quick && !scene.unloaded) this.#show(request, await this.source.lines(view, scene, columns, signal, true));
    const packet = await this.source.lines(view, scene, columns, signal);
    request.lines = finerLines(packet);
    this.#begun = true;
    this.#show(request, packet);
  }

  /** Show boundaries without cells, and say which of them are still to come. */
  #show(request, packet) {
    const picture = new Picture(request.view, request.view, 1, 1, request.table, request.kind);
    [picture.about, picture.lines] = [packet.about, finerLines(packet)];
    const missing = packet.about.lines.filter(({ lower, names }) => lower && names.every((name) => picture.lines[name].every(Number.isNaN)));
    this.onPicture(picture);
    this.onState({ missing: missing.map(({ symbol, lower }) => `${symbol}_${lower}`) });
  }

  async #refine(request, run) {
    if (this.source.live && !this.#begun) await this.#drawLines(request, run.control.signal);
    const blocks = this.#blocks(request);
    for (const [level, block] of blocks.entries()) {
      const size = this.source.fixed ?? {
        columns: Math.ceil(request.columns / block),
        rows: Math.ceil(request.rows / block),
      };
      const expected = this.#costs.of(request, size.columns * size.rows);
      if (level && expected > LONGEST && !request.patient) {
        this.onState({ held: expected });
        return;
      }
      await this.#fill(request, run, size, level === 0);
      if (this.#waiting) return;
    }
    this.onState({ done: performance.now() - run.began });
  }

  /** One picture, in pieces. */
  async #fill(request, run, { columns, rows }, first) {
    const ranges = this.source.fixed ?? request.view;
    const picture = new Picture(request.view, ranges, columns, rows, request.table, request.kind, request.scale);
    const began = performance.now();
    const cost = this.#costs.begin(request, columns, rows);
    while (!picture.whole) {
      const at = picture.filled;
      const width = Math.max(1, Math.floor((first ? 2 * PIECE : PIECE) / cost.column));
      const last = Math.min(columns, columns - at - width < width / 2 ? columns : at + width);
      const piece = { columns, rows, first: at, last };
      if (!request.lines && (columns < request.columns || request.scene.unloaded)) piece.lines = request.columns;
      const packet = await this.source.map(request.view, request.scene, piece, run.control.signal);
      if (piece.lines && this.source.live) request.lines = finerLines(packet);
      picture.lines = request.lines;
      picture.put(packet, at);
      if (packet.seconds && !packet.compiled) cost.add(last - at, 1000 * packet.seconds);
      request.scale = picture.scale;
      run.seen = true;
      this.onPicture(picture);
      this.onState({ share: picture.filled / columns, since: began, columns, rows });
      if (this.#waiting) run.control.abort();
      run.control.signal.throwIfAborted();
    }
  }
}

/** The boundaries of a packet by name, as fine as the screen. */
function finerLines(packet) {
  const names = packet.about.lines.flatMap((line) => line.names);
  return Object.fromEntries(names.map((name) => [name, packet[`line_${name.replace(/^beta_/, "")}`]]));
}
