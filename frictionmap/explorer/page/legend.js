// Legend: meanings of the colours and lines of the map.

import { short } from "./axes.js";
import { CLASS, rampColour } from "./colours.js";
import { keyLine, make, spaced } from "./dom.js";

/** Name of a class, with the range of stops if it comprises several numbers. */
function nameOf(picture, index, look) {
  const ends = picture.stops[index];
  if (!ends) return look.label;
  const range = ends[0] === ends[1] ? short(ends[0]) : `${short(ends[0])} to ${short(ends[1])}`;
  const { events } = picture.about;
  return index === CLASS.more ? `${range} ${events}` : `non-integer, ${range} ${events}`;
}

function swatch(ink) {
  return make("i", { style: { background: ink } });
}

/** Style of a line of the legend, like that of its dashes. */
function styleOf([length]) {
  if (!length) return "solid";
  return length > 3 ? "dashed" : "dotted";
}

/** Share of cells in words. */
function percent(share) {
  const value = 100 * share;
  return value >= 0.1 ? `${value.toFixed(value < 10 ? 1 : 0)} %` : "< 0.1 %";
}

/** Entries of the classes of a picture: all, or those that a quantity has no number for. */
export function classesOf(picture) {
  const { classes } = picture.about;
  const counts = picture.counts();
  const all = counts.reduce((sum, count) => sum + count, 0);
  const shown = picture.values ? [CLASS.stuck, CLASS.unresolved] : [...counts.keys()];
  return shown
    .filter((index) => counts[index])
    .map((index) => ({ colour: classes[index].colour, text: `${nameOf(picture, index, classes[index])}, ${percent(counts[index] / all)}` }));
}

/** Lay out the legend of a picture. */
export function legend(element, picture) {
  const entries = picture.scale ? [scaleEntry(picture.quantity.label, picture.scale)] : [];
  for (const { lower, dashes, meaning, symbol } of picture.boundaries) {
    const name = make("span", {}, ...(lower ? [symbol, make("sub", {}, lower)] : []));
    entries.push(make("span", {}, keyLine("currentColor", name, styleOf(dashes)), " ", meaning));
  }
  entries.push(...classesOf(picture).map(({ colour, text }) => make("span", {}, swatch(colour), text)));
  for (const [name, places] of Object.entries(picture.about.marks)) {
    if (places.length) entries.push(make("span", {}, make("span", {}, name.includes("held") ? "▽" : "▼"), " ", name));
  }
  element.replaceChildren(...spaced(entries));
}

function scaleEntry(label, { low, high, log }) {
  const stops = Array.from({ length: 12 }, (_, k) => rampColour(k / 11)).join(", ");
  const middle = log ? Math.sqrt(low * high) : (low + high) / 2;
  const bar = make("i", {
    title: `${short(middle, 2)} in the middle`,
    style: { width: "8rem", background: `linear-gradient(to right, ${stops})` },
  });
  return make("span", {}, `${label}: `, short(low, 2), bar, ` ${short(high, 2)}${log ? " (logarithmic)" : ""}`);
}
