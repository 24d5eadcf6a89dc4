// Colours of cells: those of the package for classes, an even ramp for quantities.

/** Steps of the colour map viridis: uniform in lightness, and suited to colour-blind eyes. */
const VIRIDIS = [
  "#440154", "#481467", "#482576", "#453781", "#404688", "#39558c", "#33638d", "#2d718e", "#287d8e",
  "#238a8d", "#1f968b", "#20a386", "#29af7f", "#3dbc74", "#56c667", "#75d054", "#95d840", "#bade28", "#dde318", "#fde725",
];
const STEPS = 256;

/** Indices into the palette of the package. */
export const CLASS = { unresolved: 0, stuck: 1, continuous: 2, one: 3, more: 7, nonInteger: 8, uncounted: 9 };

function parts(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
}

/** A colour as one number, as it lies in the memory of a picture. */
function packed([red, green, blue]) {
  return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}

const ramp = Array.from({ length: STEPS }, (_, k) => {
  const place = (k / (STEPS - 1)) * (VIRIDIS.length - 1);
  const below = Math.min(VIRIDIS.length - 2, Math.floor(place));
  const [from, to] = [parts(VIRIDIS[below]), parts(VIRIDIS[below + 1])];
  return from.map((value, channel) => Math.round(value + (place - below) * (to[channel] - value)));
});
const RAMP = Uint32Array.from(ramp, packed);

/** A colour of the ramp for a style sheet; `share` from 0 to 1. */
export function rampColour(share) {
  return `rgb(${ramp[Math.round(Math.min(1, Math.max(0, share)) * (STEPS - 1))].join(" ")})`;
}

/** Colours of the package's classes as numbers. */
export function classTable(classes) {
  return Uint32Array.from(classes, (look) => packed(parts(look.colour)));
}

/**
 * The range that the colours of a quantity go over: all but a few of its finite values.
 * @returns {{low: number, high: number, log: boolean}}
 */
export function scaleOf(values, classes, kind) {
  const log = kind === "log";
  const kept = [];
  const step = Math.max(1, Math.floor(values.length / 20000));
  for (let k = 0; k < values.length; k += step) {
    const fits = Number.isFinite(values[k]) && (!log || values[k] > 0);
    if (fits && classes[k] !== CLASS.stuck) kept.push(values[k]);
  }
  if (!kept.length) return { low: log ? 0.1 : 0, high: 1, log };
  kept.sort((one, other) => one - other);
  const at = (share) => kept[Math.round(share * (kept.length - 1))];
  if (!log) return { low: 0, high: Math.max(1, at(0.995)), log };
  const high = Math.max(at(0.99), 1e-12);
  return { low: Math.min(Math.max(at(0.01), high * 1e-4), high / 2), high, log };
}

/** Where on the ramp a value lies, 0 to 1. */
export function shareOf(value, { low, high, log }) {
  if (log) return Math.log(value / low) / Math.log(high / low);
  return (value - low) / (high - low);
}

/** Colours of cells, as numbers: of their classes, or of a quantity where they have one. */
export function painter(table, scale) {
  if (!scale) return (index) => table[index];
  const { low, high, log } = scale;
  const factor = (STEPS - 1) / (log ? Math.log(high / low) : high - low);
  return (index, value) => {
    if (index === CLASS.stuck || Number.isNaN(value)) return table[index];
    const place = log ? Math.log(value / low) : value - low;
    return RAMP[Math.min(STEPS - 1, Math.max(0, Math.round(factor * place)))];
  };
}
