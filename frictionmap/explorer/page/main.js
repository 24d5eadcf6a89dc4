// The page: it shows one view, and updates everything when the view changes.

import { addressHasUnits, addressInRatios, cellsKey, changedKeys, firstView, hashOf, pictureKey, queryOf, systemKey, tidy, viewOf } from "./address.js";
import { SCHEMES, forgetColours, short } from "./axes.js";
import { classTable } from "./colours.js";
import { Controls } from "./controls.js";
import { CutPanel } from "./cut.js";
import { Design } from "./design.js";
import { ZOOM, listen, moved, zoomed } from "./gestures.js";
import { legend } from "./legend.js";
import { RegimeMap } from "./map.js";
import { MotionPanel } from "./motion.js";
import { Refiner } from "./refine.js";
import { copy, pngOf, save } from "./save.js";
import { Server } from "./source.js";
import { Stored } from "./stored.js";
import { Tour } from "./tour.js";

const part = (id) => document.getElementById(id);

/** Milliseconds after which a message says that work is running, and between two checks. */
const PATIENCE = 350;

/** Milliseconds above which a picture is slow. */
const SLOW = 1000;

/** Milliseconds after which a request for a motion is cancelled by the next one. */
const GRACE = 50;

/** Words under the system at rest, until there is a motion. */
const WAITING = "The system at rest. Its motion is shown here as soon as it is computed.";

/** Milliseconds within which changes of one kind are one step of the history. */
const TOGETHER = 1500;

/** Milliseconds without changes before less urgent work follows: address, description, other initial states. */
const STILL = 180;

/**
 * Work of which only the latest request counts: one runs at a time, and the last request made meanwhile waits.
 * A running request may continue for some milliseconds, so that motions follow the pointer.
 */
class LatestOnly {
  #control = null;
  #waiting = null;

  /** @param {(signal: AbortSignal, ...args) => Promise<void>} work */
  constructor(work, onError, grace = 0) {
    [this.work, this.onError, this.grace] = [work, onError, grace];
  }

  async ask(...args) {
    if (this.#control) {
      this.#waiting = args;
      this.#supersede(this.#control);
      return;
    }
    const control = (this.#control = new AbortController());
    control.began = performance.now();
    try {
      await this.work(control.signal, ...args);
    } catch (error) {
      if (error.name !== "AbortError") this.onError(error);
    }
    this.#control = null;
    const next = this.#waiting;
    this.#waiting = null;
    if (next) this.ask(...next);
  }

  /** Cancel all requests. */
  stop() {
    this.#waiting = null;
    this.#control?.abort();
  }

  #supersede(control) {
    const left = control.began + this.grace - performance.now();
    if (left > 0) setTimeout(() => control.abort(), left);
    else control.abort();
  }
}

/** Delay work until it has not been requested for a while. */
function later(work, milliseconds) {
  let timer = 0;
  return (...args) => {
    clearTimeout(timer);
    timer = setTimeout(() => work(...args), milliseconds);
  };
}

class Page {
  /** @param {{hash: string, wrong: string[]}} address  in ratios */
  constructor(source, scene, address) {
    [this.source, this.scene] = [source, scene];
    this.design = new Design(source, scene, {
      settle: () => this.settle(), select: (cell) => this.change({ cell }), newest: (work, onError) => new LatestOnly(work, onError),
    });
    this.quantities = scene.quantities;
    this.step = this.last = history.state?.step ?? 0;
    this.#readAddress(address);
    this.table = classTable(scene.classes);
    this.map = new RegimeMap(part("stage"), scene);
    this.hint = part("motion").innerText;
    this.motion = new MotionPanel(part("motion"));
    if (source.live) this.motion.wait(scene.drawing, WAITING);
    this.pointed = null; // the last cell under the pointer, or the example: its motion is shown while none is selected
    this.example = null; // the cell that the page opens with
    this.cut = new CutPanel(part("cut"), scene.classes, {
      close: () => this.change({ cut: "" }),
      point: (value) => this.#link(value),
      pick: (value) => this.change({ cell: this.#onCut(value).map((one) => Number(one.toPrecision(4))) }),
    });
    this.refiner = new Refiner(source, (found) => this.#onPicture(found), (state) => this.#onState(state));
    this.controls = new Controls(part("controls"), scene, (change) => this.#onControl(change), source.fixed, (given) => source.ratios(this.view, scene, given));
    this.motions = new LatestOnly((...args) => this.#fetchMotion(...args), (error) => this.#wrong(error), GRACE);
    this.examples = new LatestOnly((signal) => this.#fetchExample(signal), () => {});
    this.others = new LatestOnly((...args) => this.#fetchOthers(...args), () => {});
    this.cuts = new LatestOnly((signal) => this.#fetchCut(signal), (error) => this.#wrong(error));
    this.settle = later(() => this.#settled(), STILL);
    this.rest = later((...args) => this.others.ask(...args), STILL);
    this.pending = new Map();
    this.message = part("message");
    for (const button of document.querySelectorAll("[data-save]")) {
      button.hidden = !source.live && !["link", "picture"].includes(button.dataset.save);
    }
    part("title").textContent = document.title = scene.title;
    if (systemKey(this.view) === systemKey(firstView(scene))) part("system").textContent = scene.system; // else it comes with the cells
    document.title += " – frictionmap";
  }

  begin() {
    this.design.begin(part("controls"), this.map, part("pins"));
    listen(this.map, {
      zoom: (factors, point) => this.change(zoomed(this.view, factors, point)),
      pan: (shares) => this.change(moved(this.view, shares)),
      frame: (box) => this.#frame(box),
      hover: (x, y) => this.#hover(x, y),
      leave: () => this.#leave(),
      pick: (x, y) => this.#pick(this.map.cellAt(x, y)),
      step: (columns, rows) => this.#step(columns, rows),
      release: () => this.#pick(null),
      home: () => this.home(),
      key: (letter) => this.#key(letter),
      undo: () => part("undo").click(),
      redo: () => part("redo").click(),
    });
    part("zoom").addEventListener("click", (event) => this.#zoomButton(event.target.dataset.zoom));
    part("save").addEventListener("toggle", () => part("save").open && this.#showSizes());
    part("save").addEventListener("click", (event) => {
      const chosen = event.target.closest("[data-save]");
      if (chosen) this.#save(chosen.dataset.save);
    });
    if (this.source.live && this.scene.structure) this.#offerStructure();
    this.tour = new Tour(this.scene.unloaded);
    document.addEventListener("click", (event) => {
      if (!event.target.closest("[data-tour]")) return;
      part("keys").close();
      this.tour.begin();
    });
    part("help").addEventListener("click", () => part("keys").showModal());
    part("save").addEventListener("keydown", (event) => event.key === "Escape" && this.#closeMenu(event));
    document.addEventListener("click", (event) => part("save").contains(event.target) || part("save").removeAttribute("open"));
    window.addEventListener("popstate", (event) => this.#onStep(event));
    part("undo").addEventListener("click", () => history.back());
    part("redo").addEventListener("click", () => history.forward());
    for (const scheme of SCHEMES) matchMedia(scheme).addEventListener("change", () => this.#redraw());
    part("lecture").addEventListener("click", () => this.#key("l"));
    new ResizeObserver(() => this.#onSize()).observe(this.map.stage);
    setInterval(() => this.#lookAtWaiting(), PATIENCE);
    this.controls.offer("quantity", this.quantities, this.view);
    this.update(true);
  }

  /** A picture of the structure, which is loaded when it is opened. */
  #offerStructure() {
    const place = part("structure");
    place.hidden = false;
    place.addEventListener("toggle", () => place.open && (place.querySelector("img").src = `structure.svg${location.search}`), { once: true });
  }

  /** Show another view. @param {Partial<import("./address.js").View>} change */
  change(change) {
    this.examples.stop();
    const ranges = ["r", "beta"].filter((axis) => change[axis]).map((axis) => [axis, tidy(change[axis])]);
    const cells = Object.keys(change).some((key) => !["r", "beta", "quantity", "cell", "cut", "lecture"].includes(key));
    this.view = { ...this.view, ...change, ...Object.fromEntries(ranges) };
    this.#note("");
    this.update(cells || "cell" in change);
  }

  /** Update the page for the changed view; `motion`: whether the motion in the selected cell may have changed. */
  update(motion = false) {
    const { map, view, scene } = this;
    this.#setLecture(Boolean(view.lecture));
    map.view = view;
    map.kept = view.cell;
    this.controls.set(view);
    this.design.update(view);
    map.draw();
    const { columns, rows } = (this.size = map.size);
    const kind = this.quantities.find((quantity) => quantity.key === view.quantity).scale;
    this.map.stage.dataset.state = "refining";
    this.requestedAt = performance.now();
    this.refiner.ask({ view, scene, columns, rows, table: this.table, kind, scale: null });
    map.pointed = this.pointed;
    const cell = view.cell ?? this.pointed;
    if (motion && cell && this.#hasMotions) this.motions.ask(cell, Boolean(view.cell));
    if (view.cut) {
      this.cuts.ask();
    } else {
      this.cuts.stop();
      this.cut.hide();
    }
    this.#markOutdated();
    this.settle();
  }

  /** Large type, and little else than the map and one motion, for a lecture room. */
  #setLecture(on) {
    if (document.documentElement.classList.toggle("lecture", on) === (part("lecture").ariaPressed === "true")) return;
    part("lecture").ariaPressed = String(on);
    this.#redraw();
  }

  /** Fade outdated parts of the page until they are replaced. */
  #markOutdated() {
    const { view, map: { whole }, motion, cut } = this;
    const fade = (name, outdated) => part(name).classList.toggle("outdated", outdated);
    fade("cells", whole !== null && cellsKey(whole.view) !== cellsKey(view));
    const words = whole !== null && pictureKey(whole.view) !== pictureKey(view);
    for (const name of ["system", "legend"]) fade(name, words);
    fade("motion", motion.motion !== null && motion.key !== this.#motionKey(view, view.cell ?? this.pointed));
    fade("cut", cut.curves !== null && cut.key !== this.#cutKey(view));
  }

  /** Keys of the motion shown, and of the response curve. */
  #motionKey(view, cell) {
    return `${systemKey(view)} ${cell}`;
  }

  #cutKey(view) {
    return `${systemKey(view)} ${view.cut} ${this.#placeOfCut(view)} ${view[view.cut]}`;
  }

  #onSize() {
    if (this.#resized) this.update();
    else this.map.draw();
  }

  /** Whether the size of the map differs from that requested. */
  get #resized() {
    const { columns, rows } = this.map.size;
    return columns !== this.size?.columns || rows !== this.size?.rows;
  }

  home() {
    this.change({ r: this.scene.r, beta: this.scene.beta });
  }

  #onControl(change) {
    if (!change.number) {
      this.change({ ...change, ...this.#quantityOf(change) });
      return;
    }
    const [key, value] = change.number;
    const numbers = { ...this.view.numbers };
    if (key !== "mu") numbers[key] = value;
    if (value === this.scene.sliders.find((slider) => slider.key === key).value) delete numbers[key];
    const { view, note } = this.#inFile({ ...this.view, numbers, mu: key === "mu" ? value : this.view.mu }, key);
    this.change({ mu: view.mu, numbers: view.numbers });
    this.#note(note);
  }

  /** Another quantity, where a newly chosen contact does not have that of the view. */
  #quantityOf({ contact }) {
    const offered = this.scene.contacts.find(({ key }) => key === contact)?.quantities;
    if (!offered) return {};
    this.quantities = offered;
    this.controls.offer("quantity", offered, this.view);
    return offered.some(({ key }) => key === this.view.quantity) ? {} : { quantity: offered[0].key };
  }

  /** The nearest view for which a saved page has a map, and a note on what was changed; a live page has all maps. */
  #inFile(view, moved) {
    if (this.source.live) return { view, note: "" };
    const { view: kept, back } = this.source.kept(view, this.scene, moved);
    const names = back.map(({ label, value }) => `${label} is reset to ${short(value)}`).join(", ");
    return { view: kept, note: names && `${names}: this file has no map with all these values.` };
  }

  /** Update the address and the quantities once the view has not changed for a while. */
  async #settled() {
    this.#remember(hashOf(this.view, this.scene) + this.design.hash);
    this.hash = location.hash;
    if (!this.source.live) return;
    const query = queryOf(this.view, this.scene);
    try {
      const { quantities } = await this.source.scene(query);
      if (query === queryOf(this.view, this.scene)) this.#offer(quantities); // else another answer is to come
    } catch {
      // the map shows the error of the view
    }
  }

  /** Put a view into the history of the browser; changes of one kind that follow each other are one step. */
  #remember(hash) {
    const now = performance.now();
    const changed = hash !== location.hash;
    const kind = changedKeys(location.hash, hash);
    const together = kind === this.kind && now - this.changed < TOGETHER;
    if (changed && !this.read && !together) {
      this.step = this.last = this.step + 1;
      history.pushState({ step: this.step }, "", hash);
    } else if (changed || history.state?.step === undefined) {
      history.replaceState({ step: this.step }, "", hash);
    }
    if (changed || this.read) [this.kind, this.changed] = [this.read ? "" : kind, now];
    this.read = false; // whether the view was read from the address, of which the history knows
    this.#offerSteps();
  }

  /** Enable the buttons for the steps that there are. */
  #offerSteps() {
    part("undo").disabled = this.step <= 0;
    part("redo").disabled = this.step >= this.last;
  }

  /** The browser went back or forward, or the address was edited, which is a step of its own. */
  #onStep({ state }) {
    this.step = state?.step ?? this.step + 1;
    this.last = Math.max(this.last, this.step);
    this.#offerSteps();
    this.#onAddress(); // at once: a view that settles before the address is read would replace it
  }

  /** Offer the quantities of the cells: a reduced structure has other masses for another contact. */
  #offer(quantities) {
    this.quantities = quantities;
    this.controls.offer("quantity", quantities, this.view);
    if (!quantities.some(({ key }) => key === this.view.quantity)) this.change({ quantity: quantities[0].key });
  }

  async #onAddress() {
    if (location.hash === this.hash) return;
    const hash = (this.hash = location.hash);
    if (!addressHasUnits(hash, this.scene)) {
      this.#takeAddress({ hash, wrong: [] });
      return;
    }
    this.read = true;
    const address = await inRatios(hash, this.source, this.scene);
    if (hash === this.hash) this.#takeAddress(address);
  }

  #takeAddress(address) {
    const kept = this.view.cell;
    this.#readAddress(address);
    if (kept && !this.view.cell) this.#release(); // its motion goes with it
    this.controls.offer("quantity", this.quantities, this.view);
    this.update(true);
  }

  /** Read the view from the address; messages about errors in it are shown until the view changes. */
  #readAddress({ hash, wrong: refused }) {
    const { scene } = this;
    this.read = true;
    const chosen = (this.source.live && new URLSearchParams(hash.slice(1)).get("contact")) || scene.contacts[0].key;
    this.quantities = scene.contacts.find(({ key }) => key === chosen)?.quantities ?? this.quantities;
    const known = { ...scene, quantities: this.quantities };
    const { view: wanted, wrong } = viewOf(this.design.read(hash), known, this.source.fixed?.values);
    const { view, note } = this.#inFile(wanted);
    this.view = view;
    this.#note([...refused, ...wrong, ...this.design.wrong, note].filter(Boolean).join("\n"));
  }

  #redraw() {
    forgetColours();
    if (this.view) this.map.draw();
    this.motion.draw();
    this.cut.draw();
  }

  #onPicture(found) {
    this.map.show(found);
    if (!this.map.whole && found.lines) legend(part("legend"), found); // boundaries without cells
    if (found.whole) {
      part("system").textContent = part("system").title = found.about.system;
      legend(part("legend"), found);
      if (this.#resized) this.update(); // second axes take room
    }
    const cell = found.view.cell ?? this.pointed;
    if (cell && !this.#hasMotions) this.#showInFile(cell, found); // another system may do something else there
    if (found.whole && !this.opened) this.#open();
    this.#markOutdated();
    const detail = { columns: found.columns, rows: found.rows, whole: found.whole };
    this.map.stage.dataset.cells = `${found.columns} ${found.rows}`;
    requestAnimationFrame(() => {
      if (found.whole && found.columns === this.map.size.columns) performance.mark("first whole picture");
      this.map.stage.dispatchEvent(new CustomEvent("painted", { detail }));
    });
  }

  #onState(state) {
    if (state.missing) this.missing = state.missing;
    if (state.error) {
      this.#wrong(state.error);
    } else if (state.held) {
      this.#say(`Shown: ${this.#cells(this.map.whole)}. The finest map, ${this.#cells(this.size)}, would take about ${this.#duration(state.held)}.`, "Compute it", () => this.#finer());
      this.map.stage.dataset.state = "done";
    } else if (state.done !== undefined) {
      this.#say("");
      this.map.stage.dataset.state = "done";
    } else if (state.share < 1) {
      const spent = performance.now() - state.since;
      if (spent > PATIENCE) this.#say(`Map of ${this.#cells(state)}: ${Math.round(100 * state.share)} %, about ${this.#duration((spent * (1 - state.share)) / state.share)} left.`);
    }
  }

  /** Whether there are motions of the view: a saved page may have some of its first map only. */
  get #hasMotions() {
    return this.source.hasMotions(this.view, this.scene);
  }

  #cells({ columns, rows }) {
    return `${columns} × ${rows} cells`;
  }

  /** What is shown while kernels are compiled for the map; "" if nothing of it is missing. */
  get #until() {
    const { map, view } = this;
    if (map.stage.dataset.state !== "refining") return "";
    if (!map.whole && this.missing?.length) return ` Being computed: the boundary ${this.missing.join(" and ")}, then the map.`;
    if (!map.whole) return map.pictures.length ? " Until then the boundaries are shown without the map." : " Until then the axes are shown without the map.";
    return pictureKey(map.whole.view) === pictureKey(view) ? "" : " Until then the map before is shown.";
  }

  /** Show errors of the address above the map; other messages do not replace them. */
  #note(text) {
    [part("notice").textContent, part("notice").hidden] = [text, !text];
  }

  /** Compute finer maps on request. */
  #finer() {
    this.map.stage.dataset.state = "refining";
    this.requestedAt = performance.now();
    this.#say("Computing.");
    this.refiner.more();
  }

  #duration(milliseconds) {
    const seconds = milliseconds / 1000;
    return seconds < 90 ? `${Math.max(1, Math.round(seconds))} s` : `${Math.round(seconds / 60)} min`;
  }

  #wrong(error) {
    this.#say(error.message, "", null, true);
    this.map.stage.dataset.state = "wrong";
  }

  #say(text, action = "", does = null, wrong = false) {
    this.message.hidden = !text;
    this.message.classList.toggle("wrong", wrong);
    this.message.textContent = text;
    if (!action) return;
    const button = document.createElement("button");
    [button.type, button.textContent] = ["button", action];
    button.addEventListener("click", does);
    this.message.append(" ", button);
  }

  /** Register a pending request. */
  async #waiting(promise) {
    this.pending.set(promise, performance.now());
    try {
      return await promise;
    } finally {
      this.pending.delete(promise);
    }
  }

  /** Show whether kernels are being compiled while a request is pending. */
  async #lookAtWaiting() {
    if (!this.#waits || !this.source.live || this.looking) return;
    this.looking = true;
    try {
      const { compiling } = await this.source.state();
      if (!this.#waits) {
        this.#compiled(); // the pending answer has arrived
      } else if (compiling.seconds) {
        this.compiled = true;
        const { left, seconds } = compiling;
        const wait = left > 1 ? `about ${this.#duration(1000 * left)} left` : `${left > 0 ? "almost finished" : "longer than expected"}, ${this.#duration(1000 * seconds)} so far`;
        this.#say(`First use: compiling, ${wait}. This happens once per machine.${this.#until}`);
      } else if (this.compiled) {
        this.#compiled();
      } else if (this.message.hidden && performance.now() - this.requestedAt > SLOW) {
        this.#say(`Computing.${this.#until}`);
      }
    } catch {
      // the pending request will show the error
    }
    this.looking = false;
  }

  get #waits() {
    return this.map.stage.dataset.state === "refining" || this.pending.size > 0;
  }

  /** Remove the message about compilation. */
  #compiled() {
    if (this.compiled) this.#say("");
    this.compiled = false;
  }

  // the cell under the pointer

  #point(cell) {
    this.map.hovered = cell;
    this.#link(cell?.[this.view.cut] ?? null);
  }

  /** Mark a place on the response curve, and the same place on the map. @param {number | null} value  of r or beta */
  #link(value) {
    const { cut, map, view } = this;
    const there = value !== null && cut.curves && view.cut;
    map.cross = there ? this.#onCut(value) : null;
    cut.point(there ? value : this.#ofCell(view));
    map.drawOver();
  }

  /** Where the selected cell is on the response curve. */
  #ofCell({ cell, cut }) {
    return cell && cut ? cell[cut === "r" ? 0 : 1] : null;
  }

  /** r and beta of a place on the response curve. */
  #onCut(value) {
    const { along, at } = this.cut.curves;
    return along === "r" ? [value, at] : [at, value];
  }

  #hover(x, y) {
    const cell = this.map.cellAt(x, y);
    const before = this.map.hovered;
    if (cell?.r === before?.r && cell?.beta === before?.beta) return;
    this.#point(cell);
    if (!cell || this.view.cell) return;
    this.map.pointed = this.pointed = [cell.r, cell.beta];
    if (this.#hasMotions) this.motions.ask(this.pointed, false);
    else this.#showStored(cell, cell.picture);
    this.#markOutdated();
  }

  /** The pointer leaves the map; a file has one motion only, which comes back. */
  #leave() {
    this.#point(null);
    if (this.source.live || this.view.cell || !this.example || this.pointed === this.example) return;
    this.pointed = this.map.pointed = this.example;
    this.#showInFile(this.example, this.map.whole);
  }

  /** Ask for the cell whose motion the page opens with. */
  #open() {
    this.opened = true;
    if (!this.view.cell && !this.pointed) this.examples.ask();
  }

  async #fetchExample(signal) {
    const { view } = this;
    const { cell } = await this.source.example(view, this.scene, signal);
    if (!cell || this.view.cell || this.pointed || systemKey(view) !== systemKey(this.view)) return;
    this.example = this.pointed = this.map.pointed = cell;
    this.map.drawOver();
    this.motions.ask(cell, false);
  }

  #pick(cell) {
    if (cell && !this.#hasMotions) this.#showStored(cell, cell.picture);
    if (!cell) this.#release();
    this.change({ cell: cell && [cell.r, cell.beta], cut: cell ? this.view.cut : "" });
  }

  /** Deselect the cell. */
  #release() {
    this.map.pointed = this.pointed = null;
    this.motions.stop();
    this.motion.say(this.hint);
  }

  /** Select the next cell by keys: some pixels from the selected one, from the example, or from the centre. */
  #step(across, up) {
    const { map, view } = this;
    const size = { r: (view.r[1] - view.r[0]) / map.area.width, beta: (view.beta[1] - view.beta[0]) / map.area.height };
    const [r, beta] = (this.pointed === this.example && this.example) || [];
    const circled = r > view.r[0] && r < view.r[1] && beta > view.beta[0] && beta < view.beta[1];
    const from = view.cell ?? (circled ? [r, beta] : [(view.r[0] + view.r[1]) / 2, (view.beta[0] + view.beta[1]) / 2]);
    this.#pick(map.cellAt(map.x(from[0] + 5 * across * size.r), map.y(from[1] + 5 * up * size.beta)));
  }

  async #fetchMotion(signal, cell, kept) {
    const { view } = this;
    this.others.stop();
    const motion = await this.#slowly(this.source.motion(view, this.scene, cell, signal), cell, kept);
    if (kept !== Boolean(this.view.cell) || (!kept && !this.source.live && cell !== this.pointed)) return;
    const kinds = [kept && "selected", motion.nearest && "nearest in this file", !kept && cell === this.example && !motion.nearest && "example"];
    const kind = kinds.filter(Boolean).join(", ");
    this.motion.show(motion, this.scene.classes[motion.class], kind, this.#motionKey(view, cell));
    this.#markOutdated();
    requestAnimationFrame(() => part("motion").dispatchEvent(new CustomEvent("painted", { detail: { r: motion.r, beta: motion.beta } })));
    if (motion.others !== false) this.rest(motion, view, cell);
  }

  /** Wait for a motion; if it takes long, remove the one of another cell meanwhile. */
  async #slowly(motion, [r, beta], kept) {
    const place = `${this.scene.across.symbol} = ${short(r)}, β = ${short(beta)}`;
    const slow = setTimeout(() => kept === Boolean(this.view.cell) && this.motion.say(`Computing the motion at ${place}.`), SLOW);
    try {
      return await this.#waiting(motion);
    } catch (error) {
      if (!this.motion.motion && error.name !== "AbortError") this.motion.say(this.hint);
      throw error;
    } finally {
      clearTimeout(slow);
    }
  }

  /** Fetch stability and the motion from the other initial state for the cell shown. */
  async #fetchOthers(signal, motion, view, cell) {
    if (this.motion.motion !== motion) return;
    const others = await this.#waiting(this.source.others(view, this.scene, cell, signal));
    if (this.motion.motion === motion) this.motion.add(others);
  }

  /** Show the motion in the example of a saved page, or what it contains about another cell. */
  #showInFile(cell, found) {
    if (this.#hasMotions) {
      this.motions.ask(cell, false);
      return;
    }
    if (cell === this.example && systemKey(this.view) === systemKey(firstView(this.scene))) this.motions.ask(cell, false);
    else this.#showStored(found.cellAt(cell), found);
  }

  /** Show what a saved page contains about a cell. */
  #showStored(cell, { quantity }) {
    if (!cell) return;
    const value = cell.value === null ? "" : ` Value of ${quantity.label}: about ${short(cell.value, 3)}.`;
    this.motion.say(`r = ${short(cell.r)}, β = ${short(cell.beta)}: ${this.scene.classes[cell.class].label}.${value} ` +
      "This file has no motions of this map; to see them, run frictionmap explore on the configuration.");
  }

  async #fetchCut(signal) {
    const { view, scene, map } = this;
    if (!view.cut) return;
    const count = Math.max(2, Math.round(map.area.width));
    const found = await this.#waiting(this.source.cut(view, scene, view.cut, this.#placeOfCut(view), count, signal));
    const { width } = map.stage.getBoundingClientRect();
    this.cut.show(found, { left: map.area.x, right: width - map.area.x - map.area.width }, this.#cutKey(view));
    this.#link(null);
    this.#markOutdated();
  }

  /** Position of the response curve on the other axis: at the selected cell, or in the middle. */
  #placeOfCut(view) {
    return (view.cell ?? [(view.r[0] + view.r[1]) / 2, (view.beta[0] + view.beta[1]) / 2])[view.cut === "r" ? 1 : 0];
  }

  // keys and buttons

  #frame({ x, y, width, height }) {
    this.map.drawOver();
    if (width < 8 || height < 8) return;
    const [left, bottom] = this.map.at(Math.max(x, this.map.area.x), y + height);
    const [right, top] = this.map.at(x + width, y);
    this.change({ r: [Math.max(0, left), right], beta: [Math.max(0, bottom), top] });
  }

  #zoomButton(way) {
    if (way === "home") this.home();
    else if (way) this.change(zoomed(this.view, way === "in" ? [1 / ZOOM, 1 / ZOOM] : [ZOOM, ZOOM], null));
  }

  #key(letter) {
    if (letter === "?") {
      part("keys").showModal();
    } else if (letter === "l") {
      this.change({ lecture: this.view.lecture ? "" : "on" });
    } else if (letter === "e") {
      this.motion.player.stepToEvent();
    } else if (letter === "p") {
      if (this.motion.motion) this.motion.player.toggle();
    } else if (letter === "q") {
      const keys = this.quantities.map((quantity) => quantity.key);
      this.change({ quantity: keys[(keys.indexOf(this.view.quantity) + 1) % keys.length] });
    } else if (this.source.live && !this.scene.unloaded) {
      const along = letter === "r" ? "r" : "beta";
      this.change({ cut: this.view.cut === along ? "" : along });
    }
  }

  /** Show the sizes of the files before cells are saved, and the computing time if it is long. */
  async #showSizes() {
    if (!this.source.live) return;
    const { view } = this;
    const write = (words) => part("save").querySelectorAll("[data-size]").forEach((place) => (place.textContent = words(place)));
    write(() => ""); // those of the view before
    try {
      const sizes = await this.source.sizes(view, this.scene, this.map.size);
      const wait = this.refiner.whole > SLOW ? `, ${this.#duration(this.refiner.whole)}` : "";
      if (view === this.view) write(({ dataset }) => `, about ${sizes[dataset.size]}${wait}`);
    } catch {
      // the map shows the error of the view; saving shows it too
    }
  }

  /** Close the menu and return the keyboard focus to it. */
  #closeMenu(event) {
    if (!part("save").open) return;
    part("save").open = false;
    part("save").querySelector("summary").focus();
    event?.stopPropagation(); // the key means nothing else
  }

  async #save(what) {
    const { view, scene, map, source } = this;
    this.#closeMenu();
    try {
      if (what === "link") {
        await copy(location.href.split("#")[0] + hashOf(view, scene) + this.design.hash);
        this.#toast("The link to this view is copied.");
      } else if (what === "configuration") {
        await copy(await source.configuration(view, scene, map.size));
        this.#toast(`The configuration of this view is copied: paste it into a .toml file.${this.#ahead(view)}`);
      } else if (what === "picture") {
        await this.#savePicture(map.whole);
      } else {
        await source.sizes(view, scene, map.size); // shows errors of the view here instead of in the file
        save(source.file(view, scene, map.size, what), `map.${what}`);
        if (this.#ahead(view)) this.#toast(`The file contains the cells of this view.${this.#ahead(view)}`);
      }
    } catch (error) {
      this.#toast(error.message);
    }
  }

  /** Note that the saved view is not shown on the map yet; empty if it is. */
  #ahead(view) {
    const { whole } = this.map;
    return whole && pictureKey(whole.view) === pictureKey(view) ? "" : ` It is for μ = ${short(view.mu)} and the other settings chosen, which the map does not show yet.`;
  }

  /** Save the latest complete picture, with a note if the controls have changed since. */
  async #savePicture(whole) {
    if (!whole) throw new Error("Cannot save a picture: the first map is not complete yet. Wait until it is.");
    save(await pngOf(whole, this.scene, this.map.stage.getBoundingClientRect()), "map.png");
    if (pictureKey(whole.view) !== pictureKey(this.view)) {
      const { quantity, view } = whole;
      this.#toast(`The new map is still being computed. The saved picture shows the map before it: ${quantity.label}, μ = ${short(view.mu)}.`);
    } else if (this.map.stage.dataset.state === "refining") {
      this.#toast(`The saved picture has ${whole.columns} × ${whole.rows} cells. A finer one is being computed.`);
    }
  }

  #toast(text) {
    const toast = part("toast");
    [toast.textContent, toast.hidden] = [text, false];
    clearTimeout(this.fading);
    this.fading = setTimeout(() => (toast.hidden = true), 3500);
  }
}

/** The address in ratios; a page that is a file takes ratios only. */
async function inRatios(hash, source, scene) {
  if (!source.live || !addressHasUnits(hash, scene)) return { hash, wrong: [] };
  return addressInRatios(hash, scene, (given) => source.ratios(firstView(scene), scene, given));
}

async function begin() {
  const stored = part("stored");
  const source = stored ? await Stored.open(stored.textContent) : new Server();
  try {
    const scene = await source.scene();
    new Page(source, scene, await inRatios(location.hash, source, scene)).begin();
  } catch (error) {
    [part("message").textContent, part("message").hidden] = [error.message, false];
    part("message").classList.add("wrong");
  }
}

begin();
