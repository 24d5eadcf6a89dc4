// Pointer, wheel, touch and keys on the map.

/** Pixels that a pointer may move during a click. */
const STILL = 4;

/** Factor of a zoom by a key or a button, and by a step of a wheel. */
const ZOOM = 1.6;
const WHEEL = 1.0015;

/** Share of the map that an arrow moves it by. */
const SHIFT = 0.12;

/** Elements that use letters, signs and arrows themselves. */
const TYPED = "input, select, dialog, textarea";

/** Elements that undo what was typed themselves. */
const WRITTEN = "input.number, textarea";

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/**
 * @param {import("./map.js").RegimeMap} map
 * @param {object} does  callbacks: zoom(factors, point), pan(shares), frame(box), hover(x, y), leave(),
 *                       pick(x, y), step(columns, rows), release(), home(), key(letter), undo(), redo()
 */
export function listen(map, does) {
  const { stage } = map;
  const pointers = new Map();
  let began = null;

  const place = (event) => {
    const { left, top } = stage.getBoundingClientRect();
    return { x: event.clientX - left, y: event.clientY - top };
  };
  const ignored = (event) => event.target.closest("button");

  stage.addEventListener("pointerdown", (event) => {
    if (ignored(event) || event.button > 0) return;
    stage.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
    began = { ...place(event), moved: false, boxed: event.shiftKey, touch: event.pointerType === "touch" };
  });

  stage.addEventListener("pointermove", (event) => {
    const now = place(event);
    const before = pointers.get(event.pointerId);
    if (!before) {
      if (event.pointerType !== "touch") does.hover(now.x, now.y);
      return;
    }
    if (pointers.size === 2) {
      pinch(map, pointers, event.pointerId, now, does);
      began.moved = true;
    } else if (began.moved || Math.hypot(now.x - began.x, now.y - began.y) > STILL) {
      began.moved = true;
      drag(map, began, before, now, does);
    }
    pointers.set(event.pointerId, now);
  });

  const lift = (event) => {
    if (!pointers.delete(event.pointerId) || pointers.size) return;
    stage.classList.remove("moving");
    const box = map.box;
    map.box = null;
    if (event.type === "pointercancel") return;
    if (box) does.frame(box);
    else if (!began.moved) does.pick(began.x, began.y);
  };
  stage.addEventListener("pointerup", lift);
  stage.addEventListener("pointercancel", lift);
  stage.addEventListener("pointerleave", () => does.leave());
  stage.addEventListener("dblclick", (event) => ignored(event) || does.home());

  stage.addEventListener("wheel", (event) => {
    event.preventDefault();
    const factor = WHEEL ** (event.deltaY || event.deltaX);
    const { x, y } = place(event);
    does.zoom([event.altKey ? 1 : factor, event.shiftKey ? 1 : factor], map.at(x, y));
  }, { passive: false });

  document.addEventListener("keydown", (event) => keyed(event, stage, does));
}

/** One pointer: move the map, or draw a rectangle over it. */
function drag(map, began, before, now, does) {
  if (began.boxed) {
    const [x, y] = [Math.min(began.x, now.x), Math.min(began.y, now.y)];
    map.box = { x, y, width: Math.abs(now.x - began.x), height: Math.abs(now.y - began.y) };
    map.drawOver();
    return;
  }
  map.stage.classList.add("moving");
  const { width, height } = map.area;
  does.pan([(before.x - now.x) / width, (now.y - before.y) / height]);
}

/** Two pointers: the points of the map under them stay under them. */
function pinch(map, pointers, moved, now, does) {
  const [still] = [...pointers].filter(([id]) => id !== moved).map(([, at]) => at);
  const before = pointers.get(moved);
  const spread = (one, other) => Math.max(20, Math.hypot(one.x - other.x, one.y - other.y));
  const factor = spread(before, still) / spread(now, still);
  const { width, height } = map.area;
  does.zoom([factor, factor], map.at((now.x + still.x) / 2, (now.y + still.y) / 2));
  does.pan([(before.x - now.x) / 2 / width, (now.y - before.y) / 2 / height]);
}

/** A key; arrows are the page's own, to scroll it, unless the map is pointed at or chosen. */
function keyed(event, stage, does) {
  if ((event.ctrlKey || event.metaKey) && ["z", "y"].includes(event.key.toLowerCase()) && !event.target.closest(WRITTEN)) {
    does[event.key.toLowerCase() === "y" || event.shiftKey ? "redo" : "undo"]();
    event.preventDefault();
    return;
  }
  if (event.ctrlKey || event.metaKey || event.target.closest(TYPED)) return;
  const arrow = stage.matches(":hover, :focus-within") && ARROWS[event.key];
  const middle = null;
  if (arrow && event.shiftKey) does.step(...arrow);
  else if (arrow) does.pan(arrow.map((way) => way * SHIFT));
  else if (event.key === "+" || event.key === "=") does.zoom([1 / ZOOM, 1 / ZOOM], middle);
  else if (event.key === "-" || event.key === "_") does.zoom([ZOOM, ZOOM], middle);
  else if (event.key === "0" || event.key === "Home") does.home();
  else if (event.key === "Escape") does.release();
  else if (["r", "b", "e", "l", "p", "q", "?"].includes(event.key)) does.key(event.key);
  else return;
  event.preventDefault();
}

/** A view after a zoom: `point` keeps its place; without one the middle does. */
export function zoomed(view, [across, up], point) {
  const [r, beta] = point ?? [(view.r[0] + view.r[1]) / 2, (view.beta[0] + view.beta[1]) / 2];
  const about = ([low, high], at, factor) => kept([at + (low - at) * factor, at + (high - at) * factor]);
  return { r: about(view.r, r, across), beta: about(view.beta, beta, up) };
}

/** Move a view by shares of its ranges. */
export function moved(view, [across, up]) {
  const by = ([low, high], share) => {
    const shift = Math.max(-low, share * (high - low));
    return [low + shift, high + shift];
  };
  return { r: by(view.r, across), beta: by(view.beta, up) };
}

/** Narrowest and widest ranges that are shown. */
const NARROWEST = 1e-9;
const WIDEST = 1e6;

/** A range that lies above zero, and is neither too narrow nor too wide. */
function kept([low, high]) {
  const from = Math.max(0, low);
  const size = Math.min(WIDEST, Math.max(high - from, NARROWEST * Math.max(1, high)));
  return [from, from + size];
}
export { ZOOM };
