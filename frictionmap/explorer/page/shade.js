// The result for a goal, drawn over the map: its band of frequencies, the friction that meets it, the optimum.

import { keepTo, short } from "./axes.js";

/** No class of cells has this colour; hatched, it is also seen without colours. */
const INK = "#0b6b2f";
const FILL = "rgb(11 107 47 / 0.16)";
const HALO = "rgb(255 255 255 / 0.85)";

/** Pixels between lines of the hatching, and of a line of the label. */
const HATCH = 11;
const LINE = 16;
const FONT = "600 12px system-ui, sans-serif";

/**
 * @param {CanvasRenderingContext2D} pen
 * @param {import("./plate.js").Plate} plate
 * @param {[number, number]} band
 * @param {object | null} answer  as the server sends it
 */
export function drawGoal(pen, plate, band, answer) {
  const { area } = plate;
  const [left, right] = band.map((r) => plate.x(r)).sort((one, other) => one - other);
  keepTo(pen, area);
  pen.setLineDash([2, 3]);
  for (const x of [left, right]) stroke(pen, [[x, area.y], [x, area.y + area.height]], 1.5);
  pen.setLineDash([]);
  if (answer) {
    const inside = { left: Math.max(left, area.x - 5), right: Math.min(right, area.x + area.width + 5) };
    for (const range of answer.ranges) shade(pen, plate, inside, range);
    if (answer.beta !== null) drawOptimum(pen, plate, inside, answer);
  }
  pen.restore();
}

/** A line with a light edge, as it lies over cells of any colour. */
function stroke(pen, points, width) {
  for (const [size, ink] of [[width + 2.5, HALO], [width, INK]]) {
    [pen.lineWidth, pen.strokeStyle] = [size, ink];
    pen.beginPath();
    points.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    pen.stroke();
  }
}

/** Ends of a range of friction on the canvas, from above; not far beyond the cells. */
function endsOf(plate, [low, high]) {
  const { area } = plate;
  const [above, below] = [area.y - 5, area.y + area.height + 5];
  const y = (beta) => Math.min(below, Math.max(above, plate.y(beta)));
  return [high === null ? above : y(high), y(low)];
}

function shade(pen, plate, { left, right }, range) {
  const [top, bottom] = endsOf(plate, range);
  if (right <= left || bottom <= top) return;
  pen.save();
  pen.beginPath();
  pen.rect(left, top, right - left, bottom - top);
  pen.clip();
  pen.fillStyle = FILL;
  pen.fillRect(left, top, right - left, bottom - top);
  [pen.lineWidth, pen.strokeStyle] = [1, INK];
  pen.beginPath();
  for (let x = HATCH * Math.floor((left - bottom + top) / HATCH); x < right; x += HATCH) {
    pen.moveTo(x, bottom);
    pen.lineTo(x + bottom - top, top);
  }
  pen.stroke();
  pen.restore();
  for (const y of [top, bottom]) stroke(pen, [[left, y], [right, y]], 1);
}

/** The friction of the answer, with its peaks and a label. */
function drawOptimum(pen, plate, { left, right }, answer) {
  const { area } = plate;
  const y = plate.y(answer.beta);
  if (right <= left) return;
  stroke(pen, [[left, y], [right, y]], 2.5);
  const decides = typeof answer.r === "number" ? [answer.r] : [];
  for (const r of answer.peaks?.length ? answer.peaks.map((peak) => peak.r) : decides) {
    const x = plate.x(r);
    pen.beginPath();
    pen.arc(x, y, 5, 0, 2 * Math.PI);
    [pen.fillStyle, pen.strokeStyle, pen.lineWidth] = [INK, HALO, 2];
    pen.fill();
    pen.stroke();
  }
  drawLabel(pen, area, (Math.max(left, area.x) + Math.min(right, area.x + area.width)) / 2, y, labelOf(answer));
}

/** The label of the optimum: its friction, and its peak. */
function labelOf({ beta, peak, physical }) {
  const force = physical.force ? ` (${short(beta * physical.force.factor)} ${physical.force.unit})` : "";
  const length = physical.length ? ` (${short(peak * physical.length.factor)} ${physical.length.unit})` : "";
  const words = [`β = ${short(beta)}${force}`];
  if (Number.isFinite(peak)) words.push(`peak ${short(peak)}${length}`);
  return words;
}

/** A label above the line of the optimum, or at the edge beyond which it lies; in two lines where there is no room for one. */
function drawLabel(pen, area, x, y, words) {
  const beyond = y < area.y ? "↑ " : y > area.y + area.height ? "↓ " : "";
  pen.font = FONT;
  const sizeOf = (text) => pen.measureText(text).width + 12;
  const one = beyond + words.join(", ");
  const lines = sizeOf(one) < area.width - 8 ? [one] : [beyond + words[0], ...words.slice(1)];
  const [width, height] = [Math.max(...lines.map(sizeOf)), 4 + LINE * lines.length];
  const middle = Math.min(area.x + area.width - width / 2 - 4, Math.max(area.x + width / 2 + 4, x));
  const above = y - 9 - height;
  const wanted = above < area.y ? y + 9 : above; // below a line that is near the upper edge
  const top = Math.min(area.y + area.height - 24 - height, Math.max(area.y + 4, wanted)); // above the handles
  [pen.fillStyle, pen.textAlign, pen.textBaseline] = [HALO, "center", "middle"];
  pen.beginPath();
  pen.roundRect(middle - width / 2, top, width, height, 5);
  pen.fill();
  pen.fillStyle = INK;
  lines.forEach((line, k) => pen.fillText(line, middle, top + 2 + LINE * (k + 0.5)));
}
