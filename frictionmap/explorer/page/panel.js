// The panel of a goal: a menu of goals, the band of frequencies, a limit, and the answer in words.

import { GOALS, hasLimit, isOfResponse, sentencesOf } from "./goal.js";
import { paragraph } from "./dom.js";
import { REFUSED, listenToField, writeIn } from "./field.js";

const TEMPLATE = `
  <summary>goal of a design</summary>
  <div>
    <div class="control"><label for="goal">friction for</label><select id="goal"><option value="">no goal</option></select></div>
    <div class="control of"><label for="goal-of">response of</label><select id="goal-of"></select></div>
    <div class="control limit"><label for="goal-limit">largest value</label>
      <div class="field"><input type="text" class="number" id="goal-limit" autocomplete="off"><span class="unit"></span></div>${REFUSED}</div>
    <div class="control band" role="group" aria-labelledby="goal-band"><span id="goal-band"></span>
      <div class="field"><input type="text" class="number" name="goal-from" aria-label="band from" autocomplete="off">
        <span>to</span><input type="text" class="number" name="goal-to" aria-label="band to" autocomplete="off"></div>${REFUSED}</div>
    <div class="answer" role="status" aria-live="polite"></div>
    <button type="button" class="peak" title="the motion at the frequency that decides">select its cell</button>
    <div class="control"><span id="pin-name">pin this design</span><div class="row" role="group" aria-labelledby="pin-name">
      <button type="button" data-pin="A">as A</button><button type="button" data-pin="B">as B</button></div></div>
  </div>`;

/** A number as a field shows it: without the digits that come from its conversion. */
function digits(value) {
  return String(Number(value.toPrecision(6)));
}

export class GoalPanel {
  /**
   * @param {HTMLElement} form    that it is appended to
   * @param {object} does         callbacks: change(part of a goal), select(), pin(name), convert(keys of a query) a promise of ratios
   */
  constructor(form, does) {
    this.does = does;
    this.root = document.createElement("details");
    [this.root.className, this.root.open, this.root.innerHTML] = ["goal", true, TEMPLATE];
    form.append(this.root);
    for (const { key, label } of Object.values(GOALS)) this.#part("#goal").add(new Option(label, key));
    this.#part("#goal").addEventListener("change", ({ target }) => does.change({ ask: target.value }));
    this.#part("#goal-of").addEventListener("change", ({ target }) => does.change({ of: target.value }));
    this.#listenToLimit();
    this.ends = ["from", "to"].map((name) => this.#part(`[name=goal-${name}]`));
    this.ends.forEach((field, k) => this.#listenToEnd(field, k));
    this.#part(".peak").addEventListener("click", () => does.select());
    for (const button of this.root.querySelectorAll("[data-pin]")) button.addEventListener("click", () => does.pin(button.dataset.pin));
  }

  #part(name) {
    return this.root.querySelector(name);
  }

  #listenToLimit() {
    const change = (limit) => this.does.change({ limit: limit > 0 ? limit : null });
    listenToField(this.#part("#goal-limit"), this.#part(".limit .refused"), {
      plain: (value) => change(value / (this.physical.length?.factor ?? 1)),
      convert: async (text) => (await this.does.convert({ limit: text })).limit,
      ratio: change,
      reset: () => change(0),
    });
  }

  /** Listen to one end of the band; the other one keeps its ratio, of which the field shows fewer digits. */
  #listenToEnd(field, k) {
    const change = (end) => this.does.change({ band: this.goal.band.map((old, at) => (at === k ? end : old)) });
    listenToField(field, this.#part(".band .refused"), {
      plain: (value) => change(value / (this.physical.frequency?.factor ?? 1)),
      convert: async (text) => (await this.does.convert({ band: text })).band[0],
      ratio: change,
      reset: () => this.set(this.goal),
    });
  }

  /** Show units and subjects as the cells have them. @param {object} about  description of the cells */
  describe({ units, physical, subjects }) {
    [this.physical, this.subjects, this.units] = [physical, subjects, units];
    const select = this.#part("#goal-of");
    const known = [...select.options].map((option) => option.label).join();
    if (known !== subjects.map(({ label }) => label).join()) select.replaceChildren(...subjects.map(({ key, label }) => new Option(label, key)));
    this.#part("#goal-band").textContent = physical.frequency ? `over frequencies [${physical.frequency.unit}]` : "over frequency ratios r";
    if (this.goal) this.set(this.goal);
  }

  /** Label of the subject of a goal. */
  label({ of }) {
    return this.subjects.find(({ key }) => key === of)?.label ?? of;
  }

  /** Show a goal. @param {import("./goal.js").Goal} goal */
  set(goal) {
    this.goal = goal;
    const { frequency, length } = this.physical;
    this.#part("#goal").value = goal.ask;
    this.#part("#goal-of").value = goal.of;
    this.#part(".of").hidden = !isOfResponse(goal);
    this.#part(".limit").hidden = !hasLimit(goal);
    this.#part(".band").hidden = !goal.ask;
    this.ends.forEach((field, k) => writeIn(field, digits(goal.band[k] * (frequency?.factor ?? 1))));
    writeIn(this.#part("#goal-limit"), goal.limit === null ? "" : digits(goal.limit * (length?.factor ?? 1)));
    const ratio = length && goal.limit !== null ? ` = ${digits(goal.limit)} ${this.units.length}` : "";
    this.#part(".unit").textContent = `${length?.unit ?? this.units.length}${ratio}`;
  }

  /** Show the answer. @param {object} answer  as the server sends it */
  show(answer) {
    this.#part(".answer").classList.remove("wrong");
    this.#part(".answer").replaceChildren(...sentencesOf(answer, this.label(this.goal)).map(paragraph));
    this.#reveal();
    this.#part(".peak").hidden = answer.beta === null;
  }

  /** Show a text in the place of an answer. */
  say(text, wrong = false) {
    this.#part(".answer").classList.toggle("wrong", wrong);
    this.#part(".answer").replaceChildren(...(text ? [paragraph(text)] : []));
    if (wrong) this.#reveal();
    this.#part(".peak").hidden = true;
  }

  /** Scroll to the answer, where somebody is asking. */
  #reveal() {
    if (this.root.contains(document.activeElement)) this.#part(".answer").scrollIntoView({ block: "nearest" });
  }
}
