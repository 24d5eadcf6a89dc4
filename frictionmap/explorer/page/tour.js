// A tour of the page in six steps.

import { make } from "./dom.js";

/** Where a step points, the first of these that has a box of its own, and what it says. */
const STEPS = [
  ["#stage", "The map", "Each point is one steady state. Across is the frequency of the excitation, up is the friction force. The colours show what the contact does: it slides, stops several times per cycle, or stays stuck."],
  [".live", "The motion", "This is the motion in the circled cell, slowed. The lamp is on while the contact is stuck. Pause it, or drag in the charts below, to look at one moment."],
  ["#stage", "Other cells", "Point at the map to see the motion there. A click selects the cell, so that it stays. Zoom with the wheel, with two fingers or with + and −."],
  ["#controls, #controls > .slider", "Parameters", "Sliders change friction, damping and masses, and the map and the motion follow. The first menu has other systems. Undo takes a change back."],
  ["[data-cut=r]", "Response curves", "This shows the amplitude along the frequency or the friction, through the selected cell. A line links the curve to the map."],
  ["#save", "Save", "Save a link, a configuration, a picture or the cells. Help lists the keys."],
];

/** Steps whose words differ on a belt without a load, by their numbers; one without words is left out. */
const UNLOADED = {
  0: "Each point is one steady motion. Across is the belt speed, up is the friction force. The colours show which motions are stable: steady sliding, a stick-slip cycle, a cycle without stops, or several of them.",
  4: "",
};

/** Windows in which the page is higher than the window. */
const SCROLLS = matchMedia("(max-width: 64rem)");

export class Tour {
  #step = 0;

  /** @param {boolean} unloaded  whether the page is of a belt without a load */
  constructor(unloaded) {
    this.steps = STEPS.map(([place, title, text], k) => [place, title, unloaded ? UNLOADED[k] ?? text : text]).filter(([, , text]) => text);
    const button = (text, does) => make("button", { type: "button", textContent: text, onclick: does });
    this.title = make("h2");
    this.text = make("p");
    this.back = button("Back", () => this.#go(this.#step - 1));
    this.next = button("Next", () => this.#go(this.#step + 1));
    this.card = make("section", { id: "tour", hidden: true, ariaLabel: "Tour", ariaLive: "polite" },
      this.title, this.text, make("div", {}, this.back, this.next, button("End the tour", () => this.#end())));
    this.card.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      this.#end();
      event.stopPropagation();
    });
    document.body.append(this.card);
  }

  begin() {
    this.from = document.activeElement;
    this.card.hidden = false;
    this.#go(0);
    this.next.focus();
  }

  #go(step) {
    document.querySelector(".toured")?.classList.remove("toured");
    if (step >= this.steps.length) {
      this.#end();
      return;
    }
    this.#step = step;
    const [place, title, text] = this.steps[step];
    this.title.textContent = `${step + 1} of ${this.steps.length}: ${title}`;
    this.text.textContent = text;
    this.back.disabled = step === 0;
    this.next.textContent = step === this.steps.length - 1 ? "Done" : "Next";
    const target = [...document.querySelectorAll(place)].find((part) => part.checkVisibility());
    target?.classList.add("toured");
    target?.scrollIntoView({ block: SCROLLS.matches ? "start" : "nearest" });
    this.card.classList.remove("above"); // it is at the bottom
    this.card.classList.toggle("above", Boolean(target) && this.#covers(target.getBoundingClientRect()));
  }

  /** Whether the card covers the upper left corner of a box. */
  #covers({ left, top }) {
    const card = this.card.getBoundingClientRect();
    return top > card.top - 40 && left < card.right;
  }

  #end() {
    document.querySelector(".toured")?.classList.remove("toured");
    this.card.hidden = true;
    this.from?.focus();
  }
}
