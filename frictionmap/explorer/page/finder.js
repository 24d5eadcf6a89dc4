// A menu of many contacts: a field takes a number or a part of a name, and the list has those that it fits.

import { make } from "./dom.js";

/** Contacts up to which a menu alone is enough. */
export const MANY = 12;

/** Rows of the list that are seen at once. */
const ROWS = 6;

/** The options that a text fits: the number of a contact, or a part of its name; all, if there is none. */
export function fitting(options, text) {
  const wanted = text.trim().toLowerCase();
  if (!wanted) return options;
  const number = options.filter(({ key }) => key === `contact-${wanted}`);
  const others = options.filter((one) => one.label.toLowerCase().includes(wanted) && !number.includes(one));
  return [...number, ...others];
}

/** Fill a list, and choose one if it is there. */
export function refill(select, options, chosen) {
  select.replaceChildren(...options.map(({ label, key }) => new Option(label, key, false, key === chosen)));
  if (!options.some(({ key }) => key === chosen)) select.selectedIndex = -1;
}

/** Add the field to a menu. @param {HTMLElement} made  the menu with its label  @param {{key: string, label: string}[]} options */
export function addFinder(made, options) {
  const select = made.querySelector("select");
  let chosen = options[0].key;
  select.size = ROWS;
  const field = make("input", { type: "search", id: "find-contact", className: "number", autocomplete: "off", spellcheck: false, placeholder: `1 to ${options.length - 1}, or a name` });
  field.ariaLabel = "find a contact by number or name";
  const found = make("span", { className: "found", role: "status" });
  select.before(field);
  select.after(found);
  const take = () => {
    chosen = select.value;
    select.dispatchEvent(new Event("change"));
  };
  select.addEventListener("change", () => (chosen = select.value || chosen));
  field.addEventListener("input", () => {
    const fit = fitting(options, field.value);
    refill(select, fit, chosen);
    found.textContent = field.value.trim() ? `${fit.length} of ${options.length} fit` : "";
  });
  field.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && select.options.length) {
      select.selectedIndex = 0;
      take();
    } else if (event.key === "ArrowDown" && select.options.length) {
      if (select.selectedIndex < 0) select.selectedIndex = 0;
      select.focus();
      take();
    } else if (event.key === "Escape" && field.value) {
      field.value = "";
      field.dispatchEvent(new Event("input"));
      event.stopPropagation();
    } else {
      return;
    }
    event.preventDefault();
  });
}
