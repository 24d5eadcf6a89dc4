// The panel of a goal: a menu of goals, the band of frequencies, a limit, and the answer in words.

import { GOALS, hasLimit, isOfResponse, sentencesOf } from "./goal.js";
import { paragraph } from "./dom.js";

const TEMPLATE = `
  <summary>goal of a design</summary>
  <div>
    <div class="control"><label for="goal">friction for</label><select id="goal"><option value="">no goal</option></select></div>
    <div class="control of"><label for="goal-of">response of</label><select id="goal-of"></select></div>
    <div class="control limit"><label for="goal-limit">largest value</label>
      <div class="field"><input type="number" id="goal-limit" step="any" min="0"><span class="unit"></span></div></div>
    <div class="control band" role="group" aria-labelledby="goal-band"><span id="goal-band"></span>
      <div class="field"><input type="number" step="any" min="0" name="goal-from" aria-label="band from">
        <span>to</span><input type="number" step="any" min="0" name="goal-to" aria-label="band to"></div></div>
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
   * @param {object} does         callbacks: change(part of a goal), select(), pin(name)
   */
  constructor(form, does) {
    this.does = does;
    this.root = document.createElement("details");
    [this.root.className, this.root.open, this.root.innerHTML] = ["goal", true, TEMPLATE];
    form.append(this.root);
    for (const { key, label } of Object.values(GOALS)) this.#part("#goal").add(new Option(label, key));
    this.#part("#goal").addEventListener("change", ({ target }) => does.change({ ask: target.value }));
    this.#part("#goal-of").addEventListener("change", ({ target }) => does.change({ of: target.value }));
    this.#part("#goal-limit").addEventListener("change", ({ target }) => this.#onLimit(target.valueAsNumber));
    this.ends = ["from", "to"].map((name) => this.#part(`[name=goal-${name}]`));
    for (const field of this.ends) field.addEventListener("change", () => this.#onBand());
    this.#part(".peak").addEventListener("click", () => does.select());
    for (const button of this.root.querySelectorAll("[data-pin]")) button.addEventListener("click", () => does.pin(button.dataset.pin));
  }

  #part(name) {
    return this.root.querySelector(name);
  }

  #onLimit(value) {
    this.does.change({ limit: value > 0 ? value / (this.physical.length?.factor ?? 1) : null });
  }

  #onBand() {
    const factor = this.physical.frequency?.factor ?? 1;
    const band = this.ends.map((field, k) => (field.value === digits(this.goal.band[k] * factor) ? this.goal.band[k] : field.valueAsNumber / factor));
    if (band.every(Number.isFinite)) this.does.change({ band });
    else this.set(this.goal);
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
    const write = (field, value) => {
      if (document.activeElement !== field || !field.value) field.value = value;
    };
    this.ends.forEach((field, k) => write(field, digits(goal.band[k] * (frequency?.factor ?? 1))));
    write(this.#part("#goal-limit"), goal.limit === null ? "" : digits(goal.limit * (length?.factor ?? 1)));
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
