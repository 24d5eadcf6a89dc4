// Small charts: lines over two axes, bars, background bands.

import { colour, font, keepTo, logTicks, sharp, short, sized, ticks } from "./axes.js";

/**
 * @typedef {object} Chart
 * @property {[number, number]} x    range across
 * @property {[number, number]} y    range upwards
 * @property {string} [xName]
 * @property {string} [yName]
 * @property {boolean} [log]         whether the range upwards is logarithmic
 * @property {{x: ArrayLike<number>, y: ArrayLike<number>, colour: string, width?: number, dash?: number[]}[]} [lines]
 * @property {{x: number, y: number, colour: string}[]} [bars]  beside each other around x
 * @property {{from: number, to: number, colour: string}[]} [bands]  behind it all
 * @property {{value: number, text: string}[]} [xTicks]
 * @property {number} [left]         room for numbers, in pixels
 * @property {number} [right]
 */

/** Draw a chart on a canvas; returns its area, and where values are in it. @param {HTMLCanvasElement} canvas @param {Chart} chart */
export function draw(canvas, chart) {
  const { pen, width, height } = sharp(canvas);
  const [left, right] = [sized(chart.left ?? 46), sized((chart.right ?? 8) + 6) - 6];
  const area = { x: left, y: 6, width: width - left - right, height: height - 6 - sized(chart.xName ? 34 : 20) };
  const warp = chart.log ? Math.log : (value) => value;
  const [low, high] = chart.y.map(warp);
  const x = (value) => area.x + ((value - chart.x[0]) / (chart.x[1] - chart.x[0])) * area.width;
  const y = (value) => area.y + area.height - ((warp(value) - low) / (high - low)) * area.height;

  pen.fillStyle = colour("back");
  pen.fillRect(area.x, area.y, area.width, area.height);
  for (const band of chart.bands ?? []) {
    pen.fillStyle = band.colour;
    pen.fillRect(x(band.from), area.y, Math.max(0.5, x(band.to) - x(band.from)), area.height);
  }
  drawGrid(pen, chart, area, x, y);
  keepTo(pen, area);
  drawBars(pen, chart, area, x, y);
  for (const line of chart.lines ?? []) drawLine(pen, line, x, y, area);
  pen.restore();
  return { area, x, y };
}

/** Ticks whose texts do not touch the text of the tick before. */
function spread(pen, found, x) {
  let end = -Infinity;
  return found.filter(({ value, text }) => {
    const half = pen.measureText(text).width / 2;
    const free = x(value) - half > end + 3;
    if (free) end = x(value) + half;
    return free;
  });
}

function drawGrid(pen, chart, area, x, y) {
  [pen.font, pen.fillStyle, pen.strokeStyle, pen.lineWidth] = [font(11), colour("faint"), colour("rule"), 1];
  const bottom = area.y + area.height;
  pen.beginPath();
  [pen.textAlign, pen.textBaseline] = ["center", "top"];
  for (const { value, text } of spread(pen, chart.xTicks ?? ticks(chart.x, Math.max(3, area.width / sized(60))), x)) {
    pen.moveTo(x(value), area.y);
    pen.lineTo(x(value), bottom);
    pen.fillText(text, x(value), bottom + 4);
  }
  [pen.textAlign, pen.textBaseline] = ["right", "middle"];
  for (const { value, text } of chart.log ? logTicks(chart.y) : ticks(chart.y, Math.max(3, area.height / sized(30)))) {
    pen.moveTo(area.x, y(value));
    pen.lineTo(area.x + area.width, y(value));
    pen.fillText(text.length > 6 ? short(value, 2) : text, area.x - 4, y(value));
  }
  pen.stroke();
  if (chart.xName) {
    [pen.textAlign, pen.textBaseline] = ["center", "bottom"];
    pen.fillText(chart.xName, area.x + area.width / 2, bottom + sized(33));
  }
  if (chart.yName) {
    pen.save();
    pen.translate(sized(9), area.y + area.height / 2);
    pen.rotate(-Math.PI / 2);
    [pen.textAlign, pen.textBaseline] = ["center", "middle"];
    pen.fillText(chart.yName, 0, 0);
    pen.restore();
  }
}

function drawBars(pen, chart, area, x, y) {
  const bars = chart.bars ?? [];
  const width = Math.min(14, (0.7 * area.width) / Math.max(1, bars.length));
  for (const bar of bars) {
    pen.fillStyle = bar.colour;
    const top = Math.max(area.y, y(Math.max(bar.y, chart.y[0])));
    pen.fillRect(x(bar.x) - width / 2, top, width, area.y + area.height - top);
  }
}

/** A line that breaks where there is no number. */
function drawLine(pen, line, x, y, area) {
  [pen.strokeStyle, pen.lineWidth, pen.lineJoin] = [line.colour, sized(line.width ?? 1.6), "round"];
  pen.setLineDash(line.dash ?? []);
  pen.beginPath();
  let drawn = false;
  for (let k = 0; k < line.x.length; k += 1) {
    const value = line.y[k];
    if (Number.isNaN(value)) {
      drawn = false;
      continue;
    }
    const up = Math.min(area.y + 3 * area.height, Math.max(area.y - 2 * area.height, y(value)));
    pen[drawn ? "lineTo" : "moveTo"](x(line.x[k]), up);
    drawn = true;
  }
  pen.stroke();
  pen.setLineDash([]);
}

/** A range that holds all numbers, with a little room; about zero if there is only one. */
export function around(...arrays) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of arrays) {
    for (const value of values) {
      if (!Number.isFinite(value)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) return [-1, 1];
  const room = 0.07 * (high - low) || 0.5 * Math.abs(high) || 1;
  return [low - room, high + room];
}
