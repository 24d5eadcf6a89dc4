"""Synthetic measurements with known parameters: `python -m frictionmap.examples FOLDER` writes them.

They are computed by the models of the package, with normal noise from a seeded generator; nothing in them was
measured.  `configs/rigs` holds what this module writes.
"""

import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from .datasets.provenance import to_toml, value_text
from .files.config import parse
from .files.template import section_text
from .identify.chain.estimates import chain_names
from .identify.chain.two_masses import log_amplitude
from .identify.decay.motion import Decay, displacement
from .identify.history.drive import Drive
from .identify.history.model import NAMES, Measured, Model
from .identify.parameters import ALIKE, CONTACT_STIFFNESS
from .identify.rigs.keys import TABLES, rig_keys
from .identify.signals.phasors import harmonics_at
from .identify.time_series.motion import LAW, Shaken, motion
from .model.system import System
from .steady.curves import curves

#: True parameters by the name of the example, in Hz, mm and s.
TRUTHS: Mapping[str, Mapping[str, float]] = {
    "free-decay": {"f_n": 3.12, "zeta": 0.008, "x_F": 0.2, "X0": 9.5, "t0": -0.03, "centre": 0.25},
    "forced": {"beta_1": 0.2, "beta_2": 0.4, "f_n": 3.12, "zeta": 0.008},
    "sweep": {"f0": 3.1, "f1": 1.85, "f2": 4.9},
    "record": {"f_n": 3.12, "zeta": 0.008, "x_F": 0.7, "mu": 1.2, "offset_x": -0.1},
    "loop": {"friction": 60.0, "contact_stiffness": 150.0, "offset": 2.0},
    "forced-spring": {"beta_1": 0.4, "beta_2": 0.8, "f_n": 3.12, "zeta": 0.008, "contact_stiffness": 3.0},
    "record-spring": {"f_n": 3.12, "zeta": 0.008, "x_F": 0.9, "contact_stiffness": 3.0, "offset_x": -0.1},
    "record-runup": {"f_n": 3.12, "zeta": 0.012, "x_F": 0.6, "offset_x": 0.2},
}

#: Kind of data of those that are not called after it.
_KINDS = {"forced-spring": "forced", "record-spring": "record", "record-runup": "record"}

#: Samples of a decay: rate [1/s], length [s], error [mm].
_RATE, _LENGTH, _DECAY_ERROR = 200, 4, 0.03

#: Amplitude of the base [mm], which makes beta of x_F; errors of lags [deg], and of amplitudes, relative.
_BASE, _LAG_ERROR, _AMPLITUDE_ERROR = 1.75, 0.7, 0.01

#: Frequency [Hz] and harmonics [mm] of the base of a record; rate [1/s] and length [s] of its samples, and
#: errors of mass and base [mm].
_SHAKEN_AT, _HARMONICS = 1.0, (0.0, 1.75, 0.018j)
_RECORD_RATE, _RECORD_LENGTH, _RECORD_ERRORS = 100, 8, (0.01, 0.003)
_SPRING_LENGTH = 4

#: Frequencies [Hz] and amplitude [mm] of a base whose frequency rises; samples, and errors as of a record.
_RISING, _RISING_AMPLITUDE, _RISING_SAMPLES = (1.0, 5.0), 1.2, 500

#: Rate [1/s] and number of samples of a damper test, steps between two of them; amplitude [mm]; errors
#: [mm, N].
_LOOP_RATE, _LOOP_SAMPLES, _LOOP_FINE, _LOOP_AMPLITUDE, _LOOP_ERRORS = 200, 600, 50, 1.6, (0.003, 0.5)

_HEAD = """\
# Above each key: its meaning and its valid values.  A line that begins with # and a key shows the default or,
# if there is none, an example.
"""

_SYNTHETIC = "# Synthetic: made by frictionmap.examples, not measured."

#: The decay and the record together: one mass with one f_n and zeta, and two friction forces.
_JOINT = f"""{_SYNTHETIC}
# The truth, in Hz, mm and s: f_n = 3.12, zeta = 0.008, mu = 1.2, x_F_decay = 0.2, x_F_shaken = 0.7
title = "One storey, pulled aside and let go, then on a shaken base (synthetic)"

[[data]]
kind = "free-decay"
file = "free-decay.csv"
label = "decay"

[[data]]
kind = "record"
file = "record.csv"
label = "shaken"

[system]
contact = "fixed-wall"
excitation = "base"
damping_reference = "base"

[known]
stiffness = 1191.0        # N/m: the friction forces in N
"""


def rig_files(seed: int = 1) -> dict[str, str]:
    """Return the texts of all files by name: a configuration and a table for each example."""
    files = {}
    for kind in _TABLES:
        files[f"{kind}.csv"] = rig_table(kind, seed)
        files[f"{kind}.toml"] = _configuration(kind)
    return files | {"joint.toml": _JOINT}


def starting_rig(kind: str) -> tuple[str, str]:
    """A configuration of a rig with every key and its meaning, and the table that it reads, `KIND.csv`.

    It has no title: what it draws is called after the file of data.
    """
    said = parse(_configuration(kind))
    parts = [_HEAD]
    tables = rig_keys(kind)
    if kind == "sweep":  # of as many masses as it has
        tables["known"] = tuple(key for key in tables["known"] if key.name in chain_names(2))
    for section, keys in tables.items():
        table = said.get(section, {}) if section else {}  # a title would outlive the synthetic data
        texts = {key: value_text(value) for key, value in table.items()}
        parts.append(section_text(section, keys, texts, TABLES.get(section, "")))
    return "".join(parts), rig_table(kind)


def short_rig(kind: str) -> tuple[str, str]:
    """A short configuration of a rig, and the table that it reads; it has no title, as `starting_rig`."""
    tree = parse(_configuration(kind))
    del tree["title"]
    return to_toml(tree).lstrip("\n"), rig_table(kind)


def rig_table(kind: str, seed: int = 1) -> str:
    """The synthetic measurements of a kind, as CSV."""
    rng = np.random.default_rng([seed, list(_TABLES).index(kind)])
    return f"{_SYNTHETIC}\n{_TABLES[kind](rng, TRUTHS[kind])}"


def write_rigs(folder: Path, seed: int = 1) -> None:
    """Write all files into a folder, which is made if it is not there; files of these names are replaced."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in rig_files(seed).items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


#: Title of each configuration, and its tables in addition to the kind and the file.
_CONFIGURATIONS = {
    "free-decay": (
        "One storey of a frame, pulled aside and let go",
        """
[known]
base_mm = 1.75            # the base motion for which beta = x_F/Y is wanted
stiffness = 1191.0        # N/m: the friction force in N
""",
    ),
    "forced": (
        "One storey on a shaken base, with two friction forces",
        """sigma_phase_deg = 0.7     # errors of the data; by default they are taken from the residuals
sigma_amplitude = 0.01

[system]
contact = "fixed-wall"
excitation = "base"
damping_reference = "base"

[known]
mu = 1.0
""",
    ),
    "sweep": (
        "Two storeys without friction on a shaken base",
        """sigma_amplitude = 0.02    # error of the data; by default it is taken from the residuals

[system]
excitation = "base"
masses = 2
""",
    ),
    "record": (
        "One storey on a shaken base, which sticks and slips",
        """
[system]
contact = "fixed-wall"
excitation = "base"
damping_reference = "base"
""",
    ),
    "loop": ("A friction damper that an actuator moves to and fro, N and mm", ""),
    "forced-spring": (
        "One storey on a shaken base, with a spring in the contact and two friction forces",
        """sigma_phase_deg = 0.7
sigma_amplitude = 0.01

[system]
contact = "fixed-wall"
excitation = "base"
damping_reference = "base"

[known]
stiffness = 1191.0        # N/m: friction forces in N, and the stiffness of the contact in N/m

[fit]
free = ["beta", "f_n", "zeta", "contact_stiffness"]
""",
    ),
    "record-runup": (
        "One storey on a base whose frequency rises",
        """
[system]
contact = "fixed-wall"
excitation = "base"
damping_reference = "base"

[known]
mu = 1.0
stiffness = 1191.0        # N/m: the friction force in N

[fit]
method = "history"        # a base of any shape
sigma_x = 0.01            # noise of the mass, and of the base
sigma_drive = 0.003
free = ["f_n", "zeta", "x_F", "offset_x"]
""",
    ),
    "record-spring": (
        "One storey on a shaken base, with a spring in the contact",
        """
[system]
contact = "fixed-wall"
excitation = "base"
damping_reference = "base"

[known]
stiffness = 1191.0        # N/m: the friction force in N, and the stiffness of the contact in N/m

[fit]
free = ["f_n", "zeta", "x_F", "contact_stiffness", "offset_x"]
""",
    ),
}


def _configuration(kind: str) -> str:
    title, rest = _CONFIGURATIONS[kind]
    truth = ", ".join(f"{name} = {value:g}" for name, value in TRUTHS[kind].items())
    head = f"{_SYNTHETIC}\n# The truth, in Hz, mm and s: {truth}\n"
    of = _KINDS.get(kind, kind)
    return f'{head}title = "{title} (synthetic)"\n\n[data]\nkind = "{of}"\nfile = "{kind}.csv"\n{rest}'


def _decay(rng: np.random.Generator, truth: Mapping[str, float]) -> str:
    """Simulate a record that ends at rest."""
    time = np.arange(_RATE * _LENGTH) / _RATE
    decay = Decay(**truth)
    halves = _half_cycles(decay)
    x = displacement(decay, halves, time) + rng.normal(0.0, _DECAY_ERROR, time.size)
    return _table("time_s,x_mm", (time, "g"), (x, ".4f"))


def _half_cycles(decay: Decay) -> int:
    """Number of half cycles before rest, with mu = 1: A_{j+1} = q A_j - (1 + q) x_F."""
    q = np.exp(-np.pi * decay.zeta / np.sqrt(1.0 - decay.zeta**2))
    height, count = abs(decay.X0), 0
    while height > decay.x_F:
        height, count = q * height - (1.0 + q) * decay.x_F, count + 1
    return count


def _forced(rng: np.random.Generator, truth: Mapping[str, float]) -> str:
    """Simulate first harmonics at the same frequencies for two friction forces."""
    system = System(
        excitation="base", damping_reference="base", damping_ratios=truth["zeta"],
        contact_stiffness=truth.get(CONTACT_STIFFNESS),
    )  # fmt: skip
    r = np.array([0.55, 0.65, 0.75, 0.85, 0.92, 0.97, 1.03, 1.08, 1.15, 1.25, 1.4, 1.6, 1.8, 2.0])
    beta = [truth["beta_1"], truth["beta_2"]]
    ds = curves(system, r, beta, quantities=["first_harmonic"], threads=1).isel(mu=0, dof=0)
    lag = np.degrees(ds["first_harmonic_phase"].values.T) + rng.normal(0.0, _LAG_ERROR, (2, r.size))
    blur = np.exp(rng.normal(0.0, _AMPLITUDE_ERROR, (2, r.size)))
    ratio = ds["first_harmonic_amplitude"].values.T * blur
    return _table(
        "set,frequency_Hz,phase_lag_deg,amplitude_ratio,base_mm",
        (np.repeat([1, 2], r.size), "d"), (np.tile(truth["f_n"] * r, 2), ".4f"), (lag.ravel(), ".3f"),
        (ratio.ravel(), ".5f"), (np.full(2 * r.size, _BASE), "g"),
    )  # fmt: skip


def _sweep(rng: np.random.Generator, truth: Mapping[str, float]) -> str:
    """Simulate amplitudes of the first of two masses around both peaks and the zero between them."""
    f = np.concatenate((np.linspace(0.6, 1.7, 7), np.linspace(2.0, 4.6, 14), np.linspace(5.2, 7.6, 6)))
    logarithm = log_amplitude(np.array([truth[name] for name in ("f0", "f1", "f2")]), f)
    return _table(
        "frequency_Hz,amplitude_ratio_1", (f, ".4f"),
        (np.exp(logarithm + rng.normal(0.0, 2.0 * _AMPLITUDE_ERROR, f.size)), ".5f"),
    )  # fmt: skip


def _record(rng: np.random.Generator, truth: Mapping[str, float]) -> str:
    """Simulate base and mass in steady motion."""
    elastic = CONTACT_STIFFNESS in truth
    time = np.arange(_RECORD_RATE * (_SPRING_LENGTH if elastic else _RECORD_LENGTH)) / _RECORD_RATE
    phases = np.mod(2.0 * np.pi * _SHAKEN_AT * time, 2.0 * np.pi)
    order = np.argsort(phases, kind="stable")
    base = np.array(_HARMONICS)
    mass = Shaken("fixed-wall", "base", _SHAKEN_AT, base, (0.0, 0.0), phases[order], order, elastic)
    values = np.array([{**ALIKE, **truth}[name] for name in mass.names])
    if elastic:
        values[LAW] = 1.0 / values[LAW]
    x = motion(mass, values).places
    channels = [
        places + rng.normal(0.0, error, time.size)
        for places, error in zip((x, harmonics_at(base, phases)), _RECORD_ERRORS, strict=True)
    ]
    return _table("time_s,base_mm,x_mm", (time, "g"), (channels[1], ".4f"), (channels[0], ".4f"))


def _run_up(rng: np.random.Generator, truth: Mapping[str, float]) -> str:
    """Simulate one mass on a base whose frequency rises, from rest, and measure base and mass."""
    time = np.arange(_RISING_SAMPLES) / _RECORD_RATE
    first, last = _RISING
    turns = first * time + 0.5 * (last - first) * time**2 / time[-1]
    base = _RISING_AMPLITUDE * np.sin(2.0 * np.pi * turns)
    drive = Drive(time, base, 0, False, True, np.ones(time.size, dtype=bool))
    known = {**dict.fromkeys(NAMES, 0.0), "mu": 1.0, "gain": 1.0, "stiffness": 1.0, **truth}
    model = Model(Measured(drive, time, base, 0, False))
    x = model.course(np.array([known[name] for name in NAMES])).x
    channels = [
        places + rng.normal(0.0, error, time.size)
        for places, error in zip((x, base), _RECORD_ERRORS, strict=True)
    ]
    return _table("time_s,base_mm,x_mm", (time, "g"), (channels[1], ".4f"), (channels[0], ".4f"))


def _loop(rng: np.random.Generator, truth: Mapping[str, float]) -> str:
    """Simulate a damper that follows a cosine: the spring's force is added up, and friction limits it."""
    time = np.arange(_LOOP_SAMPLES * _LOOP_FINE) / (_LOOP_RATE * _LOOP_FINE)
    u = _LOOP_AMPLITUDE * np.cos(2.0 * np.pi * time)
    force, carried = np.empty(time.size), 0.0
    for k, step in enumerate(np.diff(u, prepend=u[0])):
        carried += truth["contact_stiffness"] * float(step)
        force[k] = carried = min(max(carried, -truth["friction"]), truth["friction"])
    channels = [
        values[::_LOOP_FINE] + rng.normal(0.0, error, _LOOP_SAMPLES)
        for values, error in zip((u, force + truth["offset"]), _LOOP_ERRORS, strict=True)
    ]
    return _table(
        "time_s,displacement_mm,force_N",
        (time[::_LOOP_FINE], "g"),
        (channels[0], ".4f"),
        (channels[1], ".3f"),
    )


def _table(names: str, *columns: tuple[np.ndarray, str]) -> str:
    """Rows of a table, every column in its format."""
    rows = zip(*([format(value, how) for value in values.tolist()] for values, how in columns), strict=True)
    return "\n".join([names, *(",".join(row) for row in rows)]) + "\n"


#: What makes the table of each example.
_TABLES: Mapping[str, Callable[[np.random.Generator, Mapping[str, float]], str]] = {
    "free-decay": _decay,
    "forced": _forced,
    "sweep": _sweep,
    "record": _record,
    "forced-spring": _forced,
    "record-spring": _record,
    "loop": _loop,
    "record-runup": _run_up,
}

if __name__ == "__main__":
    write_rigs(Path(sys.argv[1] if len(sys.argv) > 1 else "rigs"))
