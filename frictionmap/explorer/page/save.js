// What can be taken along: a link, a configuration, a picture, the cells.

import { colour } from "./axes.js";
import { classesOf } from "./legend.js";
import { LINES } from "./map.js";

/** Room of a picture for title and legend, in pixels of the style sheet. */
const HEAD = 44;
const LINE = 20;

export async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = document.createElement("textarea"); // where the clipboard is not to be had
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
    const size = 34 + pen.measureText(entry.text).width + 16;
    if (x && x + size > width) [x, y] = [0, y + LINE];
    const place = { ...entry, x, y };
    x += size;
    return place;
  });
}

/** The map with its axes, title and legend as a picture. @param {import("./map.js").RegimeMap} map */
export function picture(map, scene, subtitle) {
  const ratio = window.devicePixelRatio || 1;
  const { width, height } = map.stage.getBoundingClientRect();
  const canvas = document.createElement("canvas");
  const pen = canvas.getContext("2d");
  pen.font = "12px system-ui, sans-serif";
  const entries = [
    ...classesOf(map.picture, scene.classes),
    ...Object.values(LINES).map(({ index, dash, meaning }) => ({ dash, text: `β ${index}: ${meaning}` })),
  ];
  const places = laid(pen, entries, width - 90);
  const foot = places.at(-1).y + LINE + 12;
  [canvas.width, canvas.height] = [width * ratio, (height + HEAD + foot) * ratio];
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.fillStyle = colour("panel");
  pen.fillRect(0, 0, width, height + HEAD + foot);
  pen.fillStyle = colour("ink");
  pen.font = "600 14px system-ui, sans-serif";
  pen.fillText(scene.title, 64, 20);
  pen.font = "12px system-ui, sans-serif";
  pen.fillText(subtitle, 64, 37);
  pen.drawImage(map.cells, 0, HEAD, width, height);
  pen.drawImage(map.over, 0, HEAD, width, height);
  for (const place of places) drawEntry(pen, place, 64, HEAD + height + 8);
  return new Promise((done) => canvas.toBlob(done, "image/png"));
}

function drawEntry(pen, { x, y, colour: ink, dash, text }, left, top) {
  const [at, middle] = [left + x, top + y + 8];
  pen.strokeStyle = colour("ink");
  if (dash) {
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
  pen.fillText(text, at + 32, middle);
}
