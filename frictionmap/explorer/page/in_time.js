// The page of motions in time: a record is chosen, friction is a slider, and the motion follows.

import { SCHEMES, colour, forgetColours, massColour } from "./axes.js";
import { around, draw } from "./chart.js";
import { Controls } from "./controls.js";
import { keyLine, make, spaced, tableRow } from "./dom.js";
import { row } from "./packet.js";
import { Server } from "./source.js";

/** Milliseconds after which the page says that an answer takes its time. */
const LATE = 700;

const find = (name) => document.querySelector(name);
const server = new Server();
let view = null; // record, beta, mu, scale
let shown = null; // the answer that is drawn
let controls = null;
let asking = false; // one request at a time; the latest view is asked for next

const queryOf = (of) => new URLSearchParams(of).toString();
const inControls = ({ record, mu, ...numbers }) => ({ record: String(record), mu, numbers });

function say(text) {
  const message = find("#message");
  [message.textContent, message.hidden] = [text, !text];
}

function setOutdated(on) {
  for (const name of ["#figure", "#motion"]) find(name).classList.toggle("outdated", on);
}

/** Say what is waited for: kernels are compiled when they are first used. */
async function sayLate() {
  const { compiling } = await server.state().catch(() => ({}));
  if (asking) say(compiling?.seconds ? "Compiling, once on this machine …" : "Computing …");
}

/** Ask for the motion of the view, and again if the view has changed meanwhile. */
async function ask() {
  if (asking) return;
  asking = true;
  const late = setInterval(sayLate, LATE);
  for (let asked = null; asked !== view; ) {
    asked = view;
    try {
      shown = await server.inTime(queryOf(asked));
      say("");
      paint();
      setOutdated(false);
    } catch (error) {
      say(error.message);
      setOutdated(true);
    }
  }
  clearInterval(late);
  asking = false;
  find("#in-time").dataset.state = "done";
}

function change(part) {
  const { number, ...rest } = part;
  view = { ...view, ...rest, ...(number ? { [number[0]]: number[1] } : {}) };
  controls.set(inControls(view));
  find("#in-time").dataset.state = "asking";
  history.replaceState(null, "", `#${queryOf(view)}`);
  ask();
}

function lines(values, inkOf = massColour) {
  return Array.from({ length: values.shape[0] }, (_, k) => ({ x: shown.time, y: row(values, k), colour: inkOf(k), width: 1.2 }));
}

/** Times in which all contacts stick. */
function bands() {
  return Array.from({ length: shown.stuck.shape[0] }, (_, k) => {
    const [from, to] = row(shown.stuck, k);
    return { from, to, colour: colour("stop") };
  });
}

function overTime(name, values, yName, further = {}) {
  const x = [shown.time[0], shown.time.at(-1)];
  draw(find(name), { x, y: around(values), yName, left: 62, bands: bands(), lines: lines(values), ...further });
}

function paint() {
  const { names } = shown;
  overTime("#figure .record", shown.drive, names.drive, { lines: lines(shown.drive, () => colour("ink")) });
  overTime("#figure .masses", shown.x, names.x);
  overTime("#figure .contacts", shown.friction, names.friction, { xName: names.time });
  const loops = shown.contacts.map((_, k) => ({ x: row(shown.loop_z, k), y: row(shown.loop_force, k), colour: massColour(k), width: 1.1 }));
  draw(find("#motion .of-loop"), { x: around(shown.loop_z), y: around(shown.loop_force), xName: names.slip, yName: names.friction, left: 62, lines: loops });
  find("#numbers").replaceChildren(...shown.rows.map(([name, text]) => tableRow(name, text, "words")));
  const of = (named) => (named.length > 1 ? named.map((name, k) => keyLine(massColour(k), name)) : []);
  const stuck = make("span", {}, make("span", { className: "band" }), "all contacts stick");
  find("#key").replaceChildren(...spaced([...of(shown.masses), ...of(shown.contacts), stuck]));
}

/** Show a record that is being added, or why it is refused. */
async function add(answer, refused) {
  refused.hidden = true;
  try {
    const { record, records } = await answer;
    controls.offer("record", records, inControls(view));
    change({ record });
  } catch (error) {
    [refused.textContent, refused.hidden] = [error.message, false];
  }
}

/** Fields for a pulse, whose numbers may have units. */
function takePulses(kinds) {
  const kind = make("select", { id: "pulse-kind" }, ...kinds.map((name) => new Option(name, name)));
  const number = (id, placeholder) => make("input", { id, type: "text", placeholder, autocomplete: "off" });
  const amplitude = number("pulse-amplitude", "such as 0.4 g or 1");
  const duration = number("pulse-duration", "such as 0.5 s or 2");
  const refused = make("p", { className: "refused", hidden: true, role: "alert" });
  const button = make("button", { type: "button", id: "pulse-add" }, "add the pulse");
  const named = (field, text) => make("label", { htmlFor: field.id }, text);
  const fields = [named(kind, "shape"), kind, named(amplitude, "largest value"), amplitude, named(duration, "duration"), duration, button, refused];
  find("#file").nextElementSibling.after(make("details", { id: "pulse" }, make("summary", {}, "or define a pulse"), ...fields));
  const take = () => add(server.addPulse({ kind: kind.value, amplitude: amplitude.value, duration: duration.value }), refused);
  button.addEventListener("click", take);
  for (const field of [amplitude, duration]) field.addEventListener("keydown", ({ key }) => key === "Enter" && take());
}

/** A field for files of records, which may also be dropped anywhere on the page. */
function takeFiles() {
  const field = make("input", { type: "file", id: "file", ariaLabel: "File of a record" });
  const refused = make("p", { className: "refused", hidden: true, role: "alert" });
  const label = make("label", { htmlFor: "file" }, "or choose a file, or drop it here");
  find("#record").after(label, field, refused);
  const take = async (file) => {
    await add(server.addRecord(file), refused);
    field.value = "";
  };
  field.addEventListener("change", () => field.files.length && take(field.files[0]));
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    if (event.dataTransfer.files.length) take(event.dataTransfer.files[0]);
  });
}

async function begin() {
  const scene = await server.scene();
  document.title = `${scene.title} – frictionmap`;
  [find("#title").textContent, find("#system").textContent] = [scene.title, scene.system];
  view = scene.view;
  controls = new Controls(find("#controls"), scene, change, null, (given) => server.checked(queryOf(given)));
  await server.checked(location.hash.slice(1)).then((found) => (view = found), (error) => say(error.message));
  takeFiles();
  takePulses(scene.pulses);
  controls.set(inControls(view));
  ask();
}

const repaint = () => shown && paint();
for (const scheme of SCHEMES) matchMedia(scheme).addEventListener("change", () => (forgetColours(), repaint()));
new ResizeObserver(repaint).observe(find("#figure"));
begin().catch((error) => say(error.message));
