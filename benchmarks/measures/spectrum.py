"""Friction response spectra: nanoseconds a sample and oscillator, those of an event, a whole spectrum.

One thread, everything compiled, least of several runs.  The record is coloured noise of 20,000 samples of
0.02 s.  "held" never moves, and "sliding" is a block under noise about 2, which never stops: both are the
cost of a sample without an event.  The cost of an event is what a spectrum of one period takes beyond that of
"sliding", over its stops, starts and turns.
"""

from pathlib import Path

import numpy as np

from frictionmap import spectrum
from frictionmap.motions.record import Record

from ..report.record import pinned, save, spread, table, timed

#: Samples of the record, by quick, and their distance [s].
SAMPLES, STEP = {False: 20_000, True: 500}, 0.02

#: Periods and friction of the whole spectrum.
PERIODS, FRICTION = np.geomspace(0.15, 4.0, 32), np.geomspace(0.01, 0.8, 16)

#: Spectra of one period: oscillators, and period [s], friction.
CELLS = 512
CASES = {
    "held": (1.0, np.linspace(2.0, 3.0, CELLS)),
    "sliding": (np.inf, np.linspace(0.1, 0.9, CELLS)),
    "period 0.3 s": (0.3, np.geomspace(0.01, 0.4, CELLS)),
    "period 1 s": (1.0, np.geomspace(0.01, 0.4, CELLS)),
    "period 4 s": (4.0, np.geomspace(0.01, 0.4, CELLS)),
}
_ROUNDS = {False: 7, True: 1}

#: A suite: records, those that are measured, periods, friction forces, samples of each record.
SUITE = {False: (40, 4, 100, 20, 10_000), True: (2, 1, 5, 3, 200)}


def record(count: int, seed: int = 1) -> Record:
    """Coloured noise with the largest modulus 1."""
    noise = np.random.default_rng(seed).standard_normal(count)
    values = np.convolve(noise, np.exp(-np.arange(40) / 8.0), "same")
    return Record(values / np.abs(values).max(), dt=STEP)


def measured(
    given: Record | list[Record], periods: object, friction: np.ndarray, rounds: int
) -> tuple[dict, float]:
    """Seconds of a spectrum, and its events."""
    runs = [
        timed(lambda: spectrum(given, periods, friction, damping=0.05, threads=1)) for _ in range(rounds + 1)
    ]
    ds = runs[-1][1]
    return spread([seconds for seconds, _ in runs[1:]]), float(2 * ds.stops.sum() + ds.turns.sum())


def suite(quick: bool) -> dict:
    """Seconds of a suite of records: some are measured, and their time is scaled to all."""
    count, some, periods, friction, samples = SUITE[quick]
    given = [record(samples, seed) for seed in range(some)]
    axes = np.geomspace(0.1, 4.0, periods), np.geomspace(0.01, 0.8, friction)
    seconds, _ = measured(given, *axes, 1)
    return {
        "records": count, "measured records": some, "seconds": seconds,
        "seconds, all": seconds["least"] * count / some,
    }  # fmt: skip


def run(quick: bool, results: Path) -> dict:
    """Measure, print and save."""
    given, rounds = record(SAMPLES[quick]), _ROUNDS[quick]
    one_sided = Record(given.values + 2.0, dt=STEP)
    with pinned():
        found = {
            name: measured(one_sided if name == "sliding" else given, *case, rounds)
            for name, case in CASES.items()
        }
        whole, _ = measured(given, PERIODS, FRICTION, rounds)
        records = suite(quick)
    rows, cells = {}, SAMPLES[quick] * CELLS
    quiet = found["sliding"][0]["least"] / cells
    for name, (seconds, events) in found.items():
        each = (seconds["least"] - quiet * cells) / events if events > 0.01 * cells else np.nan
        rows[name] = {
            "seconds": seconds, "ns_a_sample": seconds["least"] / cells * 1e9,
            "events_a_sample": events / cells, "ns_an_event": each * 1e9,
        }  # fmt: skip
    table(
        ("spectrum", "ns a sample", "events a sample", "ns an event"),
        [(n, row["ns_a_sample"], row["events_a_sample"], row["ns_an_event"]) for n, row in rows.items()],
    )
    print(f"{PERIODS.size} periods, {FRICTION.size} friction forces, {SAMPLES[quick]} samples: {whole}")
    print(f"suite: {records}")
    content = {"one period": rows, "spectrum": whole, "suite": records, "samples": SAMPLES[quick]}
    save("spectrum", content, results)
    return content
