// Computing times of pictures, estimated from earlier ones.

/** Assumed computing times before the first picture: of one mass; of structures where proofs decide most cells
 *  (mu = 1); of others, for every mass. */
const GUESS = {
  one: { cells: 30000, milliseconds: 30 },
  proved: { cells: 2000, milliseconds: 40 },
  unproved: { cells: 500, milliseconds: 200 },
};

/** Power of the number of cells that their time goes with: between 1, where every cell is followed, and 1/2, where
 *  proofs decide whole columns.  Sixteen times the cells are then foreseen within a factor 2. */
const POWER = 0.75;

export class Costs {
  /** @type {Map<string, {cells: number, milliseconds: number}>} the last picture of a kind */
  #seen = new Map();

  /** Estimated milliseconds of a picture with this number of cells. @param {{view: object, scene: object}} request */
  of(request, cells) {
    const { cells: known, milliseconds } = this.#seen.get(kindOf(request)) ?? guessed(request);
    return milliseconds * (cells / known) ** POWER;
  }

  /**
   * Start a picture: `column` estimates the milliseconds of its next columns from the last ones;
   * `add` records the time that columns took.  Left and right may differ much, so all columns seen so far count.
   */
  begin(request, columns, rows) {
    const taken = { columns: 0, milliseconds: 0 };
    const cost = { column: this.of(request, columns * rows) / columns };
    cost.add = (count, milliseconds) => {
      cost.column = milliseconds / count;
      taken.columns += count;
      taken.milliseconds += milliseconds;
      const whole = (taken.milliseconds * columns) / taken.columns;
      this.#seen.set(kindOf(request), { cells: columns * rows, milliseconds: whole });
    };
    return cost;
  }
}

/** Key of everything that the computing time of a cell depends on. */
function kindOf({ view }) {
  return [view.mu > 1, view.quantity, view.start, view.contact].join();
}

function guessed({ view, scene: { masses, quick, unloaded } }) {
  if (quick) return GUESS.one;
  if (view.mu === 1 && !unloaded) return GUESS.proved;
  return { ...GUESS.unproved, milliseconds: masses * GUESS.unproved.milliseconds };
}
