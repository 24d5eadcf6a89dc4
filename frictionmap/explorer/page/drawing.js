// The system in motion: base, masses, springs, loads, and contacts, each with a light that is on while it is stuck.

import { OPEN } from "./events.js";
import { sampled } from "./moment.js";

/** Sizes in units of the drawing, which is as wide as its panel. */
const WIDTH = 340;
const SIDE = 16;
const BOX = 46;
const LANE = 20;
const PAD = 15;
const REACH = 44;

/** Share of a gap between masses that their largest approach takes. */
const SHARE = 0.6;

/** Widest distance of masses. */
const PITCH = 190;

function shape(tag, attributes = {}, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** Short strokes along a line that does not move: from a point to another, on the side of a shift. */
function hatch([x0, y0], [x1, y1], [across, down]) {
  const count = Math.max(1, Math.round(Math.hypot(x1 - x0, y1 - y0) / 7));
  const strokes = Array.from({ length: count }, (_, k) => {
    const share = (k + 0.5) / count;
    return `M${x0 + share * (x1 - x0)} ${y0 + share * (y1 - y0)}l${across} ${down}`;
  });
  return shape("path", { class: "ground", d: `M${x0} ${y0}L${x1} ${y1}${strokes.join("")}` });
}

/** A spring between two points at one height. */
function zigzag(from, to, y, height = 5) {
  const end = Math.min(9, 0.18 * Math.abs(to - from)) * Math.sign(to - from);
  const [first, last, count] = [from + end, to - end, 10];
  const teeth = Array.from({ length: count }, (_, k) => `L${(first + ((k + 0.5) * (last - first)) / count).toFixed(2)} ${y + (k % 2 ? height : -height)}`);
  return `M${from.toFixed(2)} ${y}H${first.toFixed(2)}${teeth.join("")}L${last.toFixed(2)} ${y}H${to.toFixed(2)}`;
}

function arrow(from, length, y) {
  const head = Math.min(5, Math.abs(length)) * Math.sign(length);
  return `M${from} ${y}h${length.toFixed(2)}l${(-head).toFixed(2)} -4m${head.toFixed(2)} 4l${(-head).toFixed(2)} 4`;
}

/** Largest absolute value. */
function largest(values) {
  let most = 0;
  for (const value of values) if (Math.abs(value) > most) most = Math.abs(value);
  return most;
}

/** Levels above the masses, from 1, on which contacts between masses do not touch each other; 0 of others. */
function levelsOf(contacts) {
  const ends = []; // the last mass of each level
  return contacts.map(({ masses }) => {
    if (masses.length < 2) return 0;
    const free = ends.findIndex((end) => end < masses[0]);
    const level = free < 0 ? ends.length : free;
    ends[level] = Math.max(ends[level] ?? 0, masses.at(-1));
    return level + 1;
  });
}

export class Drawing {
  #moving = [];
  #key = "";

  /** @param {SVGElement} svg */
  constructor(svg) {
    this.svg = svg;
  }

  /** Lay out the system of a motion; displacements fill the gaps between its masses. @param {object} motion */
  show(motion) {
    const key = JSON.stringify(motion.drawing);
    this.motion = motion;
    this.length = motion.tau.length;
    const { rows, names } = (this.about = motion.drawing);
    this.states = motion.states;
    const moving = this.about.base ? REACH : 0; // room of the base on its way
    const room = WIDTH - 2 * SIDE - REACH - moving;
    this.pitch = Math.min(PITCH, room / rows.length);
    this.width = Math.min(72, 0.46 * this.pitch);
    this.gap = this.pitch - this.width;
    this.wall = Math.max(SIDE + moving, (WIDTH - rows.length * this.pitch) / 2 - 8);
    this.scale = this.#scaled();
    this.load = motion.load ? largest(motion.load) || 1 : 1;
    this.svg.dataset.scale = this.scale;
    this.svg.setAttribute("aria-label", this.#words(names));
    if (key === this.#key) {
      for (const foot of this.feet) foot.setAttribute("width", this.#footWidth());
      for (const foot of this.feet) foot.setAttribute("x", -this.#footWidth() / 2);
      return;
    }
    this.#key = key;
    this.#build();
  }

  /** Move everything to a moment, a place between samples. @returns {boolean[]} which contacts are stuck */
  set(place) {
    for (const move of this.#moving) move(place);
    const at = Math.min(this.length - 1, Math.floor(place + 1e-6));
    this.open = this.about.contacts.map(({ row }) => this.states[row * this.length + at] === OPEN);
    const stuck = this.about.contacts.map(({ row }) => this.states[row * this.length + at] === 0);
    stuck.forEach((lit, k) => this.lights[k].classList.toggle("lit", lit));
    return stuck;
  }

  #words(names) {
    const { masses, base, contacts } = this.about;
    const count = masses === 1 ? "one mass" : `${masses} masses${masses > names.length ? `, ${names.length} of them shown` : ""}`;
    const places = contacts.map(({ masses: touched, base: onBase }) =>
      touched.length > 1 ? `between masses ${touched.map((k) => names[k]).join(" and ")}` : `of ${masses === 1 ? "the mass" : `mass ${names[touched[0]]}`} on ${onBase ? "the moving base" : "a fixed wall"}`);
    return `Drawing of the motion: ${count}, ${base ? "moving base" : "load"}, friction ${places.join("; ")}`;
  }

  #x(k, place) {
    return sampled(this.motion.x, place, this.about.rows[k] * this.length);
  }

  /** Displacement of what stands left of a spring: -1 is the wall or base. */
  #left(k, place) {
    if (k >= 0) return this.#x(k, place);
    return this.about.base ? sampled(this.motion.base, place) : 0;
  }

  #rest(k) {
    return this.wall + this.gap + k * this.pitch + this.width / 2;
  }

  /** Units of the drawing per unit of displacement. */
  #scaled() {
    const { rows } = this.about;
    const { x, base } = this.motion;
    const row = (k) => (k < 0 ? base : x.subarray(rows[k] * this.length, (rows[k] + 1) * this.length));
    let [nearest, farthest] = [1e-9, base ? largest(base) : 1e-9];
    for (let k = 0; k < rows.length; k += 1) {
      const [own, before] = [row(k), row(k - 1)];
      farthest = Math.max(farthest, largest(own));
      nearest = Math.max(nearest, largest(before ? own.map((value, at) => value - before[at]) : own));
    }
    return Math.min((SHARE * this.gap) / nearest, REACH / farthest);
  }

  /** Plates are as long as the mass and its way over a contact. */
  #footWidth() {
    return Math.min(this.width + 2 * REACH, this.width + 1.2 * this.gap, this.width + 2 * this.scale * largest(this.motion.z));
  }

  #build() {
    const { contacts } = this.about;
    const levels = levelsOf(contacts);
    const between = Math.max(0, ...levels);
    const long = this.about.springs.some(([from, to]) => from >= 0 && to > from + 1);
    this.top = 10 + LANE * between + (long ? 14 : 0);
    this.floor = this.top + BOX + PAD;
    const height = this.floor + (this.about.base ? 26 : 12);
    this.svg.setAttribute("viewBox", `0 0 ${WIDTH} ${height}`);
    [this.#moving, this.feet, this.lights] = [[], [], []];
    const [back, masses, front] = [shape("g"), shape("g"), shape("g")];
    this.svg.replaceChildren(back, masses, front);
    this.#ground(back);
    this.about.springs.forEach((ends) => this.#spring(back, ends));
    this.about.rows.forEach((_, k) => this.#mass(masses, k));
    this.#load(masses);
    contacts.forEach((contact, k) => {
      if (contact.masses.length > 1) this.#between(front, contact, k, levels[k]);
      else this.#onWall(back, front, contact, k);
    });
  }

  /** Move a group by a displacement of every moment. */
  #shifted(group, displacement, x = 0) {
    this.#moving.push((place) => group.setAttribute("transform", `translate(${(x + this.scale * displacement(place)).toFixed(3)} 0)`));
  }

  #ground(back) {
    const { base, contacts, rows } = this.about;
    const [wall, top, floor] = [this.wall, this.top - 4, this.floor];
    const right = this.wall + rows.length * this.pitch + 8;
    const walls = contacts.filter(({ masses }) => masses.length === 1);
    if (!base) {
      back.append(hatch([wall, floor], [wall, top], [-6, 5]));
      if (walls.some(({ belt }) => !belt)) back.append(hatch([wall, floor], [right, floor], [-5, 6]));
      return;
    }
    const group = shape("g", { class: "base" }, shape("rect", { x: wall - 8, y: top, width: 8, height: floor + 16 - top, rx: 2 }));
    const joined = walls.filter((contact) => contact.base).map(({ masses }) => this.#rest(masses[0]) + this.width / 2);
    const end = Math.max(wall + 30, ...joined);
    group.append(shape("rect", { x: wall - 8, y: floor + 8, width: end - wall + 8, height: 8, rx: 2 }));
    for (const x of [wall + 2, end - 10]) group.append(shape("circle", { cx: x, cy: floor + 20, r: 3.5 }));
    back.append(group);
    this.#shifted(group, (place) => sampled(this.motion.base, place));
  }

  #spring(back, [from, to]) {
    const path = shape("path", { class: "spring" });
    back.append(path);
    const middle = this.top + BOX / 2;
    const half = this.width / 2;
    const far = from >= 0 && to > from + 1;
    if (from < 0 && to > 0) { // a spring to the ground beside others stands on a post
      const post = this.#rest(to) - half - 0.42 * this.gap;
      const y = middle + 12;
      const stand = shape("path", { class: "post", d: `M${post} ${y - 6}V${this.floor}` });
      back.append(stand);
      if (this.about.base) this.#shifted(stand, (place) => this.#left(-1, place));
      this.#moving.push((place) => path.setAttribute("d", zigzag(post + this.scale * this.#left(-1, place), this.#rest(to) - half + this.scale * this.#x(to, place), y, 4)));
      return;
    }
    const y = far ? this.top - 10 : middle;
    this.#moving.push((place) => {
      const start = (from < 0 ? this.wall : this.#rest(from) + (far ? 0 : half)) + this.scale * this.#left(from, place);
      const end = this.#rest(to) - (far ? 0 : half) + this.scale * this.#x(to, place);
      const legs = far ? `M${start} ${this.top}V${y}M${end} ${this.top}V${y}` : "";
      path.setAttribute("d", legs + zigzag(start, end, y));
    });
  }

  #mass(masses, k) {
    const { names, masses: count, contacts } = this.about;
    const half = this.width / 2;
    const group = shape("g", { class: "mass", "data-row": this.about.rows[k], "data-rest": this.#rest(k) });
    const touched = contacts.filter((contact) => contact.masses.at(-1) === k);
    const sides = [[this.top + BOX - 3, touched.some((contact) => contact.masses.length === 1)], [this.top, touched.some((contact) => contact.masses.length > 1)]];
    for (const [y, there] of sides) {
      if (!there) continue;
      const foot = shape("rect", { class: "plate", x: -this.#footWidth() / 2, y, width: this.#footWidth(), height: 3 });
      this.feet.push(foot);
      group.append(foot);
    }
    group.append(shape("rect", { x: -half, y: this.top, width: this.width, height: BOX, rx: 3 }));
    const label = shape("text", { x: 0, y: this.top + BOX - 10 });
    label.textContent = count === 1 ? "m" : names[k];
    group.append(label);
    masses.append(group);
    this.#shifted(group, (place) => this.#x(k, place), this.#rest(k));
  }

  #load(masses) {
    const { loaded } = this.about;
    loaded.forEach((k, row) => {
      const path = shape("path", { class: "load" });
      masses.append(path);
      this.#moving.push((place) => {
        const size = sampled(this.motion.load, place, row * this.length) / this.load;
        path.setAttribute("d", arrow((this.#rest(k) + this.scale * this.#x(k, place)).toFixed(2), 34 * size, this.top + 12));
      });
    });
  }

  /** The light of a contact at a point; its number if there are several. */
  #light(group, k, x, y) {
    const light = shape("g", { class: "light", "data-contact": k }, shape("circle", { class: "halo", cx: x, cy: y, r: 11 }), shape("circle", { class: "lamp", cx: x, cy: y, r: 6.5 }));
    if (this.about.contacts.length > 1) {
      const number = shape("text", { x, y: y + 3.2 });
      number.textContent = this.about.contacts[k].row + 1;
      light.append(number);
    }
    group.append(light);
    this.lights[k] = light;
  }

  #stretch(k) {
    return (place) => sampled(this.motion.stretched, place, this.about.contacts[k].row * this.length);
  }

  /** Places of contacts that share a mass, side by side or one above the other. */
  #aside(contact, k) {
    const beside = this.about.contacts.map((one, at) => [one, at]).filter(([one]) => one.masses.length === 1 && one.masses[0] === contact.masses[0]);
    const own = beside.findIndex(([, at]) => at === k);
    return beside.length > 1 ? (own - (beside.length - 1) / 2) * Math.min(24, this.pitch / beside.length) : 0;
  }

  /** A contact with the ground or the base, under its mass; that of a spring moves as the spring is stretched. */
  #onWall(back, front, contact, k) {
    const x = this.#rest(contact.masses[0]) + this.#aside(contact, k);
    const [y, floor] = [this.top + BOX + PAD / 2, this.floor];
    const group = shape("g", { class: "contact" });
    const ground = (place) => (contact.base ? this.#left(-1, place) : 0);
    const stretch = this.#stretch(k);
    if (contact.belt) this.#belt(back, contact, x);
    else if (!contact.base && this.about.base) back.append(hatch([x - 18, floor], [x + 18, floor], [-5, 6]));
    if (contact.elastic) {
      const post = x - 40;
      const [stand, spring] = [shape("path", { class: "post", d: `M${post} ${y - 6}V${contact.base ? floor + 8 : floor}` }), shape("path", { class: "spring" })];
      back.append(stand, spring);
      this.#shifted(stand, ground);
      this.#moving.push((place) => {
        const moved = this.scale * ground(place);
        spring.setAttribute("d", zigzag(post + moved, x - 6 + moved + this.scale * stretch(place), y, 3.5));
      });
    } else {
      group.append(shape("path", { class: "post", d: `M${x} ${y}V${contact.base ? floor + 8 : floor}` }));
    }
    front.append(group);
    this.#light(group, k, x, y);
    this.#shifted(group, (place) => ground(place) + stretch(place));
  }

  #belt(back, { belt }, x) {
    const half = this.width / 2 + this.gap / 2;
    const path = shape("path", { class: "belt", d: `M${x - half} ${this.floor}h${2 * half}a5 5 0 0 1 0 10h${-2 * half}a5 5 0 0 1 0 -10` });
    back.append(path);
    this.#moving.push((place) => path.setAttribute("stroke-dashoffset", (-this.scale * belt * sampled(this.motion.tau, place)).toFixed(2)));
  }

  /** A contact between two masses: an arm of the first one lies on the second one. */
  #between(front, contact, k, level) {
    const [from, to] = contact.masses.map((place) => this.#rest(place));
    const y = this.top - 7 - LANE * (level - 1);
    const stretch = this.#stretch(k);
    const arm = shape("g", { class: "arm" });
    const group = shape("g", { class: "contact" });
    const pad = shape("path", { class: "post", d: `M${to} ${y}V${this.top}` });
    front.append(arm, group);
    const own = (place) => this.#x(contact.masses[0], place);
    const start = from + (level - 1) * 5;
    if (contact.elastic) {
      const post = Math.max(start + 10, to - 56);
      arm.append(shape("path", { class: "post", d: `M${start} ${this.top}V${y}H${post}` }));
      const spring = shape("path", { class: "spring" });
      front.append(spring);
      this.#moving.push((place) => spring.setAttribute("d", zigzag(post + this.scale * own(place), to - 6 + this.scale * (own(place) + stretch(place)), y, 3.5)));
    } else {
      arm.append(shape("path", { class: "post", d: `M${start} ${this.top}V${y}H${to}` }));
    }
    group.append(pad);
    this.#light(group, k, to, y);
    this.#shifted(arm, own);
    this.#shifted(group, (place) => own(place) + stretch(place));
  }
}
