// Menus and sliders for the quantity shown and the parameters.

import { short } from "./axes.js";
import { MANY, addFinder, refill } from "./finder.js";
import { FIELD, REFUSED, listenToField, writeIn } from "./field.js";

/** Steps of a slider from its least to its most. */
const STEPS = 1000;

/** Where on a slider a value lies, from 0 to 1; the other way round `valueAt`. */
function shareAt(slider, value) {
  const { least, most, scale } = slider;
  if (scale === "log") return Math.log(value / least) / Math.log(most / least);
  const share = (value - least) / (most - least);
  return scale === "square" ? Math.sqrt(Math.max(0, share)) : share;
}

function valueAt(slider, share) {
  const { least, most, scale } = slider;
  if (scale === "log") return Number((least * (most / least) ** share).toPrecision(3));
  const value = least + (most - least) * (scale === "square" ? share ** 2 : share);
  if (scale === "even") return Number(value.toPrecision(3));
  return scale === "square" ? Number(value.toPrecision(2)) : Number(value.toFixed(2));
}

export class Controls {
  /**
   * @param {HTMLFormElement} form
   * @param {object} scene
   * @param {(change: object) => void} onChange  a part of a view, or {number: [key, value]}
   * @param {{values: Object<string, number[]>} | null} fixed  places that sliders have, if not all
   * @param {(given: object) => Promise<object>} convert  numbers of a query, which may have units, as ratios
   */
  constructor(form, scene, onChange, fixed, convert) {
    [this.form, this.scene, this.onChange, this.fixed, this.convert] = [form, scene, onChange, fixed, convert];
    form.addEventListener("submit", (event) => event.preventDefault());
    this.sliders = new Map();
    if (scene.records) this.#choice("record", "record", scene.records);
    else this.#ofMaps(scene, fixed);
    const shown = scene.sliders.filter((slider) => !fixed || fixed.values[slider.key]);
    const ofStructure = ({ key }) => /^(mass|stiffness)_ratios/.test(key);
    for (const slider of shown.filter((one) => !ofStructure(one))) this.#slider(form, slider);
    const ratios = shown.filter(ofStructure);
    if (ratios.length) this.#ratios(ratios);
    if (!fixed && !scene.records && !scene.unloaded) this.#cuts();
  }

  /** Menus of maps. */
  #ofMaps(scene, fixed) {
    if (!fixed) this.#presets(scene.presets);
    this.#choice("quantity", "colour", scene.quantities);
    if (fixed) return;
    if (scene.contacts.length > 1) this.#contact(scene);
    if (!scene.unloaded) this.#starts();
  }

  #add(parent, html, name = "control") {
    const made = document.createElement("div");
    made.className = name;
    made.innerHTML = html;
    parent.append(made);
    return made;
  }

  /** Other systems, each at an address of its own. */
  #presets(presets) {
    const made = this.#add(this.form, `<label for="preset">system</label><select id="preset"></select>`);
    const select = made.querySelector("select");
    this.#fill(select, [{ key: "", label: "this configuration" }, ...presets]);
    select.value = new URLSearchParams(location.search).get("preset") ?? "";
    select.addEventListener("change", () => location.assign(`${location.pathname}${select.value && `?preset=${select.value}`}`));
  }

  #choice(key, label, options) {
    const made = this.#add(this.form, `<label for="${key}">${label}</label><select id="${key}"></select>`);
    const select = made.querySelector("select");
    this.#fill(select, options);
    select.addEventListener("change", () => this.onChange({ [key]: select.value }));
    return made;
  }

  /** The menu of contacts; many are found by number or name. */
  #contact({ contacts }) {
    const made = this.#choice("contact", "contact", contacts);
    made.classList.add("contact");
    this.many = contacts.length > MANY;
    if (this.many) addFinder(made, contacts);
  }

  #fill(select, options) {
    select.replaceChildren(...options.map((option) => new Option(option.label, option.key)));
  }

  /** Replace the options of a menu: a reduced structure may have other masses for another contact. */
  offer(key, options, view) {
    const select = this.form.querySelector(`#${key}`);
    const known = [...select.options].map((option) => option.label).join();
    if (known === options.map((option) => option.label).join()) return; // a menu that is open stays so
    this.#fill(select, options);
    this.set(view);
  }

  #starts() {
    const made = this.#add(this.form, `<span id="start-name">initial state</span><div class="row" role="group" aria-labelledby="start-name">
      <button type="button" data-start="rest" title="z = z′ = 0 initially">at rest</button>
      <button type="button" data-start="moving" title="a large sliding motion initially">moving</button></div>`);
    for (const button of made.querySelectorAll("button")) {
      button.addEventListener("click", () => this.onChange({ start: button.dataset.start }));
    }
  }

  #cuts() {
    const made = this.#add(this.form, `<span id="cut-name">response curve</span><div class="row" role="group" aria-labelledby="cut-name">
      <button type="button" data-cut="r" title="through the selected cell, over frequency (r)">along r</button>
      <button type="button" data-cut="beta" title="through the selected cell, over friction (b)">along β</button></div>`);
    for (const button of made.querySelectorAll("button")) {
      button.addEventListener("click", () => this.onChange({ cut: button.ariaPressed === "true" ? "" : button.dataset.cut }));
    }
  }

  #ratios(ratios) {
    const made = document.createElement("details");
    made.open = true;
    made.innerHTML = "<summary>masses and springs</summary><div></div>";
    this.form.append(made);
    for (const slider of ratios) this.#slider(made.lastElementChild, slider);
  }

  #slider(parent, slider) {
    const places = this.fixed?.values[slider.key];
    const id = `slider-${slider.key}`;
    const most = places ? places.length - 1 : STEPS;
    const made = this.#add(parent, `<label></label>${FIELD}<input type="range" min="0" max="${most}">${REFUSED}`, "control slider");
    const [label, number, range, refused] = made.children;
    [label.textContent, label.htmlFor, range.id, number.ariaLabel] = [slider.label, id, id, `${slider.label}, as a number`];
    [range.name, number.name, number.readOnly] = [slider.key, slider.key, Boolean(places)];
    const change = (value) => this.onChange({ number: [slider.key, value] });
    range.addEventListener("input", () => change(places ? places[range.value] : valueAt(slider, range.value / STEPS)));
    range.addEventListener("dblclick", () => change(slider.value));
    const convert = async (text) => (await this.convert({ [slider.key]: text }))[slider.key];
    listenToField(number, refused, { plain: change, convert, ratio: change, reset: () => this.set(this.view) });
    this.sliders.set(slider.key, { slider, number, range, places });
  }

  /** A number in words: relative to what, and in units where they are known. */
  #words({ unit, measure }, value) {
    const one = this.scene.physical[measure];
    return `${short(value)} ${unit}${one ? `, ${short(value * one.factor)} ${one.unit}` : ""}`.trim();
  }

  /** Show what a view has. */
  set(view) {
    this.view = view;
    for (const key of ["quantity", "contact", "record"]) {
      const select = this.form.querySelector(`#${key}`);
      if (select) select.value = view[key];
      if (select && key === "contact" && this.many && select.value !== view[key]) refill(select, this.scene.contacts, view[key]);
    }
    for (const key of ["start", "cut"]) {
      for (const button of this.form.querySelectorAll(`[data-${key}]`)) button.ariaPressed = String(button.dataset[key] === view[key]);
    }
    for (const [key, { slider, number, range, places }] of this.sliders) {
      if (this.many) range.parentElement.hidden = /^contacts\[/.test(key) && !key.startsWith(`${view.contact.replace(/^contact-(.*)/, "contacts[$1]")}.`);
      const value = key === "mu" ? view.mu : view.numbers[key] ?? slider.value;
      range.value = places ? places.indexOf(value) : Math.round(STEPS * shareAt(slider, value));
      range.ariaValueText = number.title = this.#words(slider, value);
      writeIn(number, String(Number(value.toPrecision(8))));
    }
  }
}
