// Where maps and motions come from: the server on this machine.

import { queryOf, typedQuery } from "./address.js";
import { unpack } from "./packet.js";

/** A refusal by the server, in one line. */
export class Refused extends Error {}

function presetOf(search) {
  const preset = new URLSearchParams(search).get("preset");
  return preset ? `preset=${encodeURIComponent(preset)}&` : "";
}

/** The server of this page. */
export class Server {
  /** @type {null} Maps come at any resolution. */
  fixed = null;
  live = true;
  /** Every request of this page cancels the previous one of its kind. */
  #page = Math.random().toString(36).slice(2);
  /** Key of the preset in the address of this page, as a query begins with it. */
  #preset = presetOf(location.search);
  /** Requests are counted: they may arrive in another order than they were made in. */
  #turn = 0;

  async #get(path, query, signal) {
    let response;
    try {
      response = await fetch(`${path}?${this.#preset}${query}`, { signal });
    } catch (error) {
      if (error.name === "AbortError") throw error;
      throw new Refused("Cannot reach frictionmap: it does not respond. Start it again and reload this page.");
    }
    if (response.status === 204) throw new DOMException("outdated", "AbortError");
    if (!response.ok) throw new Refused((await response.text()).trim());
    return response;
  }

  /** The scene, with the system as a view changes it. */
  async scene(query = "", signal) {
    return (await this.#get("scene", query, signal)).json();
  }

  /** State of compilation. */
  async state() {
    return (await this.#get("state", "")).json();
  }

  /** One motion in time under a record. @param {string} query */
  async inTime(query) {
    return unpack(await (await this.#get("motion", query)).arrayBuffer());
  }

  /** Add the record in a file; its number and all records. @param {File} file */
  addRecord(file) {
    return this.#post(`record?name=${encodeURIComponent(file.name)}`, file, "The file was not taken: frictionmap does not respond, or the file is too large.");
  }

  /** Add a pulse; its number and all records. @param {object} pulse  kind, amplitude, duration */
  addPulse(pulse) {
    return this.#post(`pulse?${new URLSearchParams(pulse)}`, "", "Cannot reach frictionmap: it does not respond. Start it again and reload this page.");
  }

  async #post(path, body, lost) {
    const response = await fetch(path, { method: "POST", body }).catch(() => {
      throw new Refused(lost);
    });
    if (!response.ok) throw new Refused((await response.text()).trim());
    return response.json();
  }

  /** Numbers of a query as ratios, and what it does not have as the page begins with it. */
  async checked(query) {
    return (await this.#get("ratios", query)).json();
  }

  /** Numbers as ratios: they may have units. @param {object} given  keys of a query */
  async ratios(view, scene, given) {
    return (await this.#get("ratios", typedQuery(view, scene, given))).json();
  }

  async #packet(path, view, scene, further, signal) {
    const query = queryOf(view, scene, { ...further, page: this.#page, turn: (this.#turn += 1) });
    const response = await this.#get(path, query, signal);
    return unpack(await response.arrayBuffer());
  }

  /** Columns `first` to before `last` of a picture of a view. */
  map(view, scene, piece, signal) {
    return this.#packet("map", view, scene, { ...piece, quantity: view.quantity }, signal);
  }

  /** Whether there are motions of a view. */
  hasMotions() {
    return true;
  }

  /** The motion in a cell. */
  motion(view, scene, cell, signal) {
    return this.#packet("motion", view, scene, { at: cell.join(",") }, signal);
  }

  /** The cell whose motion a page opens with: {cell}, null if nothing moves. */
  async example(view, scene, signal) {
    const query = queryOf(view, scene, { page: this.#page, turn: (this.#turn += 1) });
    return (await this.#get("example", query, signal)).json();
  }

  /** The boundaries of a view at a given number of frequencies; `known`: those that take no search. */
  lines(view, scene, count, signal, known = false) {
    return this.#packet("lines", view, scene, known ? { count, known: "" } : { count }, signal);
  }

  /** Stability of a cell, and the motion from the other initial state. */
  others(view, scene, cell, signal) {
    return this.#packet("others", view, scene, { at: cell.join(",") }, signal);
  }

  /** A response curve through a cell. */
  cut(view, scene, along, place, count, signal) {
    return this.#packet("cut", view, scene, { along, place, count }, signal);
  }

  /** The result for a goal of a design. @param {object} goal  keys of the query */
  async goal(view, scene, goal, signal) {
    const query = queryOf(view, scene, { ...goal, page: this.#page, turn: (this.#turn += 1) });
    return (await this.#get("goal", query, signal)).json();
  }

  /** The configuration of a view. */
  async configuration(view, scene, size) {
    const query = queryOf(view, scene, { ...size, quantity: view.quantity });
    return (await this.#get("configuration.toml", query)).text();
  }

  /** About how large the files of a view's cells are, in words, by their endings. */
  async sizes(view, scene, size) {
    return (await this.#get("sizes", queryOf(view, scene, { ...size, quantity: view.quantity }))).json();
  }

  /** The address of a view's cells as a file. */
  file(view, scene, size, ending) {
    return `map.${ending}?${this.#preset}${queryOf(view, scene, { ...size, quantity: view.quantity })}`;
  }
}
