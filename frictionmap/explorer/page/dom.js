// Elements of the page, made in one call.  Styles are set one by one: the page's policy allows no style attributes.

/**
 * @param {string} tag
 * @param {object} [properties]  of the element; `style` is an object
 * @param {...(Node | string)} children
 */
export function make(tag, properties = {}, ...children) {
  const { style = {}, ...others } = properties;
  const made = Object.assign(document.createElement(tag), others);
  Object.assign(made.style, style);
  made.append(...children);
  return made;
}

/** Texts beside each other, with spaces between them: they are read, searched and copied as words of their own. */
export function spaced(parts) {
  return parts.flatMap((part, k) => (k ? [" ", part] : [part]));
}

/** A line of the legend with its meaning. */
export function keyLine(ink, text, dash = "solid", width = 2) {
  return make("span", {}, make("span", { className: "key-line", style: { borderTop: `${width}px ${dash} ${ink}` } }), text);
}

/** A sentence of its own; what follows β_ is set below the line. */
export function paragraph(text) {
  return make("p", {}, ...lowered(text));
}

/** Text with subscripts for β_lim, β_stick and β_noslip. */
export function lowered(text) {
  return text.split(/_(lim|stick|noslip)\b/).map((piece, k) => (k % 2 ? make("sub", {}, piece) : piece));
}

/** The displacement of a mass by its number, or that of a point by its name. */
export function nameOfMass(name) {
  return /^\d/.test(name) ? `x${name}` : name;
}

/** A row of a table: a name and a value, a number or words. */
export function tableRow(name, value, kind = "number") {
  return make("tr", {}, make("th", {}, ...lowered(name)), make("td", { className: kind }, value));
}

/** A row that heads those after it. */
export function groupRow(name) {
  return make("tr", { className: "group" }, make("th", { colSpan: 2 }, name));
}
