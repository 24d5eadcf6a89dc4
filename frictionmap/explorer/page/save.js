// Saving: a link, a configuration, a picture, the cells.

import { colour, keepTo, short } from "./axes.js";
import { rampColour } from "./colours.js";
import { classesOf } from "./legend.js";
import { ring } from "./map.js";
import { Plate, areaOf } from "./plate.js";

/** Room of a picture for its title, and for each further line of text, in pixels of the style sheet. */
const HEAD = 26;
const LINE = 20;

const FONT = "12px system-ui, sans-serif";

/** Length of a ramp of colours in a legend. */
const RAMP = 120;

export async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = document.createElement("textarea"); // where the clipboard is not available
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}

/** Have the browser save something. @param {string | Blob} what  an address, or the thing itself */
export function save(what, name) {
  const link = document.createElement("a");
  link.href = typeof what === "string" ? what : URL.createObjectURL(what);
  link.download = name;
  document.body.append(link);
  link.click();
  link.remove();
  if (typeof what !== "string") setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** Where entries of a legend go in lines of a width; [{x, y, ...entry}]. */
function laid(pen, entries, width) {
  let [x, y] = [0, 0];
  return entries.map((entry) => {
    const size = (entry.scale ? RAMP + 8 : 34) + pen.measureText(entry.text).width + 16;
    if (x && x + size > width) [x, y] = [0, y + LINE];
    const place = { ...entry, x, y };
    x += size;
    return place;
  });
}

/** Text in lines of a width. */
function wrapped(pen, text, width) {
  const lines = [""];
  for (const word of text.split(" ")) {
    const longer = `${lines.at(-1)} ${word}`.trim();
    if (lines.at(-1) && pen.measureText(longer).width > width) lines.push(word);
    else lines[lines.length - 1] = longer;
  }
  return lines;
}

/** Entries of the legend of a picture. */
function entriesOf(found) {
  const boundaries = found.boundaries.map(({ lower, dashes, meaning }) => ({ dash: dashes, text: lower ? `β ${lower}: ${meaning}` : meaning }));
  if (!found.scale) return [...boundaries, ...classesOf(found)];
  const { low, high, log } = found.scale;
  const text = `${found.quantity.label}, ${short(low, 2)} to ${short(high, 2)}${log ? ", logarithmic" : ""}`;
  return [{ scale: found.scale, text }, ...boundaries, ...classesOf(found)];
}

/**
 * A picture with its axes, title and legend as PNG: all of it is of that picture, whatever the page shows by now.
 * @param {import("./picture.js").Picture} found  a whole one
 * @param {{title: string}} scene  what does not change
 * @param {{width: number, height: number}} size  of the cells with their axes, in pixels of the style sheet
 */
export function pngOf(found, { title }, { width, height }) {
  const ratio = window.devicePixelRatio || 1;
  const canvas = document.createElement("canvas");
  const pen = canvas.getContext("2d");
  pen.font = FONT;
  const places = laid(pen, entriesOf(found), width - 90);
  const lines = wrapped(pen, found.words, width - 80);
  const [head, foot] = [HEAD + 16 * lines.length, places.at(-1).y + LINE + 12];
  [canvas.width, canvas.height] = [width * ratio, (height + head + foot) * ratio];
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.fillStyle = colour("panel");
  pen.fillRect(0, 0, width, height + head + foot);
  pen.fillStyle = colour("ink");
  pen.font = "600 14px system-ui, sans-serif";
  pen.fillText(title, 64, 20);
  pen.font = FONT;
  lines.forEach((line, k) => pen.fillText(line, 64, 37 + 16 * k));
  pen.translate(0, head);
  drawMap(pen, found, { width, height });
  pen.translate(0, -head);
  [pen.font, pen.textAlign] = [FONT, "left"];
  for (const place of places) drawEntry(pen, place, 64, head + height + 8);
  return new Promise((done) => canvas.toBlob(done, "image/png"));
}

/** The cells of a picture under their axes, and the cell that was kept in its view. */
function drawMap(pen, found, size) {
  const plate = new Plate(areaOf(size, found.about), found.view, [found], found.about);
  plate.drawCells(pen);
  plate.drawLines(pen);
  if (!found.view.cell) return;
  keepTo(pen, plate.area);
  ring(pen, plate, found.view.cell, true);
  pen.restore();
}

function drawEntry(pen, { x, y, colour: ink, dash, scale, text }, left, top) {
  const [at, middle] = [left + x, top + y + 8];
  pen.strokeStyle = colour("ink");
  if (scale) {
    for (let k = 0; k < RAMP; k += 1) {
      pen.fillStyle = rampColour(k / (RAMP - 1));
      pen.fillRect(at + k, middle - 6, 1, 12);
    }
  } else if (dash) {
    pen.lineWidth = 1.6;
    pen.setLineDash(dash);
    pen.beginPath();
    pen.moveTo(at, middle);
    pen.lineTo(at + 26, middle);
    pen.stroke();
    pen.setLineDash([]);
  } else {
    [pen.fillStyle, pen.lineWidth] = [ink, 0.8];
    pen.fillRect(at + 6, middle - 6, 18, 12);
    pen.strokeRect(at + 6, middle - 6, 18, 12);
  }
  pen.fillStyle = colour("ink");
  pen.textBaseline = "middle";
  pen.fillText(text, at + (scale ? RAMP + 8 : 32), middle);
}
