// Axes: places and numbers of ticks, and numbers in words.

/** Round steps. */
const STEPS = [1, 2, 5, 10];

/** Evenly spaced round numbers within a range, about `count` of them and two at least. */
export function ticks([low, high], count) {
  let found = spaced([low, high], count);
  for (let more = 1.5 * count; found.length < 2 && more < 20 * count; more *= 1.5) found = spaced([low, high], more);
  return found;
}

function spaced([low, high], count) {
  const rough = (high - low) / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * STEPS.find((factor) => factor * power >= rough * 0.999);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) {
    found.push({ value: k * step, text: (k * step).toFixed(Math.min(20, digits)).replace(/^-(0(\.0*)?)$/, "$1") });
  }
  return found;
}

/** Powers of ten within a range; between them too if there are few. */
export function logTicks([low, high]) {
  const found = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
    const within = Math.log10(high / low) < 2 ? [1, 2, 5] : [1];
    for (const factor of within) {
      const value = factor * 10 ** power;
      if (value >= low * 0.999 && value <= high * 1.001) found.push({ value, text: short(value) });
    }
  }
  return found;
}

/** Digits as they are written above a ten. */
const RAISED = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

/** A number in a few digits. */
export function short(value, digits = 4) {
  if (Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value < 0 ? "−∞" : "∞";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(digits))).replace("-", "−");
  const [mantissa, power] = value.toExponential(Math.min(digits, 3) - 1).split("e");
  const raised = [...String(Number(power))].map((digit) => RAISED[digit]).join("");
  const factor = Number(mantissa) === 1 ? "" : `${Number(mantissa)}·`;
  return `${factor}10${raised}`.replace(/^-/, "−");
}

/** Cache of colours of the style sheet, as a look-up takes as long as drawing a line. */
const known = new Map();

/** The colour that the style sheet gives a name, as a canvas takes it: system colours of forced colours are resolved. */
export function colour(name) {
  if (!known.has(name)) {
    const probe = document.createElement("i");
    [probe.style.color, probe.hidden] = [`var(--${name})`, true];
    probe.style.forcedColorAdjust = "none";
    document.body.append(probe);
    known.set(name, getComputedStyle(probe).color);
    probe.remove();
  }
  return known.get(name);
}

/** Clear the cache after a change of the colour scheme, or of the size of the type. */
export function forgetColours() {
  known.clear();
}

/** Pixels of the root's type that lengths in canvases are meant for. */
const TYPE = 14;

/** A length in a canvas, which grows with the type of the page. */
export function sized(length) {
  const key = "size of the type";
  if (!known.has(key)) known.set(key, Math.max(1, parseFloat(getComputedStyle(document.documentElement).fontSize) / TYPE));
  return length * known.get(key);
}

/** The font of a canvas, of a height that grows with the type of the page. */
export function font(height) {
  return `${sized(height)}px system-ui, sans-serif`;
}

/** Media in which the colours of the page are others. */
export const SCHEMES = ["(prefers-color-scheme: dark)", "(forced-colors: active)", "print"];

/** Masses drawn in one chart; more would cover each other. */
export const DRAWN = 6;

/** The colour of a mass, counted from 0. */
export function massColour(k) {
  return colour(`mass-${k + 1}`);
}

/** A canvas made as sharp as the screen, cleared; sizes in pixels of the style sheet. */
export function sharp(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const { width, height } = canvas.getBoundingClientRect();
  const [across, down] = [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
  if (canvas.width !== across || canvas.height !== down) [canvas.width, canvas.height] = [across, down];
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height };
}

/** Draw in an area only, until the pen is restored. */
export function keepTo(pen, { x, y, width, height }) {
  pen.save();
  pen.beginPath();
  pen.rect(x, y, width, height);
  pen.clip();
}
