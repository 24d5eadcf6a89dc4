"""The numerical torture test: cells at and around every singular point, against 40-digit arithmetic.

Every number that has an answer in 40 digits (`reference`) is compared with it.  Digits lost are those of the
relative error over the rounding of a double, 2^-53; its condition number, the relative change of the answer
per relative change of what it is computed from (r, beta, mu, zeta, ratios of masses and springs), explains
log10 of it.  What is lost beyond counts; cells with more than `ALLOWED` are listed, one by one.

Regimes at mu = 1 are proved: continuous below beta_lim, stuck from beta_stick on; boundaries of 40 digits say
on which side a double lies.  Between them motions stop, or turn more than twice a cycle.  A wrong regime is
`at rounding` where it is nearer to the boundary than the rounding of r can tell, else it is listed.  Stops
are counted by the 40-digit steady state, found from rest, or for mu = 1 from anywhere.  Where there is no
such answer, outputs have to agree with each other and their status.  Random cells (`random_cells`) follow.
"""

import math
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.colors import BoundaryNorm, ListedColormap

import frictionmap as fm
from frictionmap import regimes

from ...references import closed_forms as reference
from ...references.closed_forms import Number, mp
from ...report.figures import new_figure, save_figure
from ...report.record import pinned, save, table
from . import random_cells

ALLOWED = 2.0  # digits beyond the condition number
SLOW = 10.0  # seconds for a cell
ROUNDING = 2.0**-53
OUTPUTS = (
    "regime", "stops_per_cycle", "contact_amplitude", "stuck_fraction", "period", "origin", "cycles",
    "status",
)  # fmt: skip

#: Numbers below this are compared as zero: the least normal double and its rounding.
_NOTHING = 1e-290

#: Slides a 40-digit march may take, a millisecond or two each.
_MOST_SLIDES = 100

#: Stops next to the boundaries are counted in every so many rows: a march takes a second.
_EVERY = 19

#: Masses up to which the condition number counts every ratio, and a name lists them.
_FEW = 5

#: Random cells wanted, and seconds after which to be content with fewer; by quick.
RANDOM_CELLS = {False: (1_000_000, 600.0), True: (300, 5.0)}

#: Turns a cycle of what beta_lim is the boundary of, with some room for a turn at the end of the samples.
_TWO = 2.5

#: Relative change of beta that rounding makes of some ten operations.
_BESIDE = mp.mpf(10) ** -15

STATUS_NAMES = {code.value: code.name for code in regimes.STATUSES}


# ---------------------------------------------------------------- what is tested


@dataclass(frozen=True)
class Body:
    """One structure, to the package and in 40 digits."""

    name: str
    system: fm.System
    masses: tuple[float, ...]
    springs: tuple[float, ...]
    zeta: float
    ground: tuple[float, ...] = ()  # springs of every mass to the ground beside the chain's, if any

    def precise(self, masses: Sequence, springs: Sequence, zeta: Number) -> reference.Structure:
        """In 40 digits, with these numbers."""
        mass, stiffness = reference.chain_matrices(masses, springs)
        for i, spring in enumerate(self.ground):
            stiffness[i, i] += mp.mpf(spring)
        n = len(masses)
        load = [0.0] * n
        load[(self.system.load_mass or 1) - 1] = 1.0
        return reference.structure(
            mass, stiffness, self.system.contact_vector.tolist(), load, self.system.base_motion, [zeta] * n
        )

    @cached_property
    def own(self) -> reference.Structure:
        """In 40 digits."""
        return self.precise(self.masses, self.springs, self.zeta)


def one_mass(zeta: float, contact: str = "fixed-wall") -> Body:
    """One mass."""
    name = f"{'wall' if contact == 'fixed-wall' else 'base-wall'}, zeta = {zeta!r}"
    return Body(name, fm.System(contact=contact, damping_ratios=zeta), (1.0,), (1.0,), zeta)


def chain(
    masses: Sequence[float], springs: Sequence[float], zeta: float, contact: Sequence[int], load: int = 1
) -> Body:
    """A chain; contact between a mass and a wall, or between two masses."""
    system = fm.System(
        contact="fixed-wall" if len(contact) == 1 else "between-masses", contact_masses=contact,
        load_mass=load, mass_ratios=masses, stiffness_ratios=springs, damping_ratios=zeta,
    )  # fmt: skip
    name = f"chain m {_few(masses)} k {_few(springs)}, contact {list(contact)}, zeta = {zeta!r}"
    return Body(name, system, tuple(masses), tuple(springs), zeta)


def _few(values: Sequence[float]) -> str:
    return f"{list(values)}".replace(".0", "") if len(values) <= _FEW else f"[{len(values)}]"


def close_modes(n: int, coupling: float, zeta: float) -> Body:
    """Equal oscillators, each on a spring of its own, coupled weakly: n frequencies within 2 `coupling`."""
    springs = [coupling] * n
    ground = [1.0] * n
    stiffness = np.diag(ground) + np.diag(springs) + np.diag(np.append(springs[1:], 0.0))
    stiffness -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
    # what the package gets is rounded: in 40 digits it is the same
    system = fm.System(
        matrices={"M": np.eye(n), "K": stiffness}, frequency_scale=1.0, contact_masses=[1], load_mass=1,
        damping_ratios=zeta,
    )  # fmt: skip
    return Body(
        f"{n} oscillators coupled by {coupling:g}, zeta = {zeta!r}", system, (1.0,) * n, tuple(springs), zeta,
        tuple(np.diag(stiffness) - np.array(springs) - np.append(springs[1:], 0.0)),
    )  # fmt: skip


@dataclass
class Group:
    """What came of one group of cells."""

    name: str
    answers: list[dict] = field(default_factory=list)  # numbers compared: what, k, lost, explained
    cells: int = 0
    statuses: Counter = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)  # regimes
    at_rounding: int = 0
    many_turns: int = 0  # without stops above beta_lim, by more than two turns a cycle
    miscounted: list[str] = field(default_factory=list)
    flagged_miscounts: int = 0  # wrong counts under a status that says so
    miscounts_at_rounding: int = 0  # right for a beta that differs by rounding
    counted: int = 0  # cells whose stops were counted in 40 digits
    inconsistent: list[str] = field(default_factory=list)
    trouble: list[str] = field(default_factory=list)  # exceptions, warnings, hangs
    slowest: float = 0.0
    seconds: float = 0.0

    def compare(
        self,
        what: str,
        k: int | None,
        value: float,
        exact: Number,
        explained: Callable[[], Iterable],
    ) -> None:
        """Digits lost by a number; `explained` gives the parts of its condition number, one by one.

        Of these no more are asked for than it takes to explain what is lost.
        """
        lost = digits_lost(value, exact)
        known, total = 0.0, mp.mpf(0)
        for part in explained() if lost > ALLOWED else ():
            total += part
            known = float(min(mp.log10(max(total, 1)), 99))
            if lost - known <= ALLOWED:
                break
        self.answers.append({"what": what, "k": k, "lost": lost, "explained": known})

    @property
    def beyond(self) -> list[dict]:
        """Answers that lost more than is allowed."""
        return [row for row in self.answers if row["lost"] - row["explained"] > ALLOWED]


def digits_lost(value: float, exact: Number) -> float:
    """log10 of the relative error over the rounding of a double, 0 to 16."""
    if mp.isinf(exact) or math.isinf(value):
        return 0.0 if mp.isinf(exact) and math.isinf(value) else 16.0
    if math.isnan(value):
        return 16.0
    error = abs(mp.mpf(value) - exact)
    if error == 0 or (abs(exact) < _NOTHING and abs(value) < _NOTHING):
        return 0.0
    if exact == 0:
        return 16.0
    return float(min(max(mp.log10(error / abs(exact) / ROUNDING), 0), 16))


def _watched(group: Group, what: str, call: Callable[[], xr.Dataset], cells: int) -> xr.Dataset | None:
    """A call of the package; exceptions, warnings and hangs are noted."""
    began = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            found = call()
        except Exception as problem:  # of any kind: that there is one is what is looked for
            group.trouble.append(f"{what}: {type(problem).__name__}: {problem}")
            return None
    taken = (time.perf_counter() - began) / cells
    group.slowest = max(group.slowest, taken)
    if taken > SLOW:
        group.trouble.append(f"{what}: {taken:.0f} s a cell")
    return found


# ---------------------------------------------------------------- curves


def _curve_values(body: reference.Structure, r: Number, mu: float, tau: Number = None) -> tuple[dict, Number]:
    found = reference.functions(body, r, tau)
    values = {
        "V": abs(found.v), "U": found.u, "G": found.g, "H": found.h, "S": found.s,
        "beta_lim": reference.beta_lim(body, r, mu, found),
    }  # fmt: skip
    return values, found.tau


def check_curves(
    group: Group, body: Body, points: Iterable[tuple[int | None, float]], mu: float = 1.0
) -> None:
    """V, U, G, H, S, beta_lim and beta_stick at points (k, r)."""
    own = body.own
    for k, r in points:
        what = f"{body.name}, r = {r!r}"
        ds = _watched(group, what, partial(fm.boundaries, body.system, [r], mu), 1)
        if ds is None:
            continue
        group.cells += 1
        exact, tau = _curve_values(own, r, mu)
        got = {name: float(ds[name].values.ravel()[0]) for name in ("U", "G", "H", "S", "beta_lim")}
        got["V"] = math.hypot(float(ds.V.item()), float(ds.V_imag.item()))
        for name, value in got.items():
            group.compare(
                f"{name}: {what}", k, value, exact[name], _curve_condition(body, own, r, mu, tau, name)
            )
        if own.base_motion == 0 or len(own.w) == 1:
            group.compare(
                f"beta_stick: {what}", k, float(ds.beta_stick.item()), _stick(own, r, mu),
                partial(_conditions, body, partial(_stick, mu=mu), own, r),
            )  # fmt: skip


def _stick(body: reference.Structure, r: Number, mu: float) -> Number:
    try:
        return reference.held_force(body, r) / mp.mpf(mu)
    except ZeroDivisionError:  # the held structure resonates, to the bit
        return mp.inf


def _curve_condition(
    body: Body, own: reference.Structure, r: float, mu: float, tau: Number, name: str
) -> Callable[[], Iterable]:
    return lambda: _conditions(body, lambda one, x: _curve_values(one, x, mu, tau)[0][name], own, r)


def _conditions(
    body: Body, function: Callable[[reference.Structure, Number], Number], own: reference.Structure, r: float
) -> Iterator:
    """Condition numbers with respect to r, to zeta, and with few masses to every ratio."""
    yield reference.condition(lambda x: function(own, x), r)
    if body.zeta:
        yield reference.condition(
            lambda zeta: function(body.precise(body.masses, body.springs, zeta), r), body.zeta
        )
    n = len(body.masses)
    if 1 < n <= _FEW:
        yield reference.condition(
            lambda *x: function(body.precise((1.0, *x[: n - 1]), (1.0, *x[n - 1 :]), body.zeta), r),
            *body.masses[1:],
            *body.springs[1:],
        )


def around(centre: Number, exponents: Iterable[int]) -> list[tuple[int | None, float]]:
    """(k, centre (1 +- 10^-k)), doubles, and the centre itself (k = 16)."""
    points: list[tuple[int | None, float]] = [(16, float(centre))]
    for k in exponents:
        points += [(k, float(centre * (1 + sign * mp.mpf(10) ** -k))) for sign in (1, -1)]
    return points


# ---------------------------------------------------------------- cells


@dataclass(frozen=True)
class Row:
    """What 40 digits say of one structure at one (r, mu)."""

    body: Body
    own: reference.Structure
    r: float
    mu: float
    found: reference.Functions
    lim: Number
    stick: Number
    slack: float  # relative distance to a boundary that the rounding of r makes

    @classmethod
    def of(cls, body: Body, r: float, mu: float = 1.0) -> "Row":
        """Find it."""
        own = body.own
        found = reference.functions(own, r)
        lim = reference.beta_lim(own, r, mu, found)
        at = reference.condition(
            lambda x: reference.beta_lim(own, x, mu, reference.functions(own, x, found.tau)), r
        )
        return cls(
            body, own, r, mu, found, lim, _stick(own, r, mu), 4.0 * ROUNDING * (1.0 + float(min(at, 1e20)))
        )

    def regime(self, beta: float) -> int | None:
        """What is proved: for mu = 1 all, for mu > 1 (from rest, one mass) sticking only."""
        if mp.mpf(beta) >= self.stick:
            return regimes.PERMANENT_STICKING
        if self.mu > 1.0:
            return None
        return regimes.CONTINUOUS if mp.mpf(beta) < self.lim else regimes.STICK_SLIP

    def near(self, beta: float) -> bool:
        """Whether rounding can decide on which side of a boundary beta lies."""
        return any(
            abs(mp.mpf(beta) - edge) <= self.slack * abs(edge)
            for edge in (self.lim, self.stick)
            if mp.isfinite(edge)
        )

    def amplitude(self, beta: Number, r: Number = None) -> Number:
        """Z of the continuous motion."""
        found = self.found if r is None else reference.functions(self.own, r, self.found.tau)
        return reference.continuous_amplitude(found, beta)


def check_cells(
    group: Group, row: Row, cells: Iterable[tuple[int | None, float]], *, count: bool = False,
    **settings: Any,
) -> None:  # fmt: skip
    """Cells (k, beta) of one row; with `count` (one mass) those with stops against 40-digit steady states."""
    k_of = {beta: k for k, beta in cells if beta >= 0.0}
    betas = sorted(k_of)
    where = f"{row.body.name}, r = {row.r!r}, mu = {row.mu!r}"
    ds = _watched(
        group, where,
        lambda: fm.sweep(
            row.body.system, [row.r], betas, row.mu, threads=1, outputs=OUTPUTS, **settings
        ),
        len(betas),
    )  # fmt: skip
    if ds is None:
        return
    for j, beta in enumerate(betas):
        cell = {name: ds[name].values[0, 0, j].item() for name in OUTPUTS}
        what = f"{where}, beta = {beta!r}"
        group.cells += 1
        group.statuses[cell["status"]] += 1
        _check_consistent(group, what, cell)
        _check_regime(group, row, beta, what, cell)
        if cell["regime"] == regimes.CONTINUOUS and row.regime(beta) == regimes.CONTINUOUS:
            group.compare(
                f"amplitude: {what}", k_of[beta], cell["contact_amplitude"], row.amplitude(beta),
                partial(_amplitude_condition, row, beta),
            )  # fmt: skip
        elif count and cell["regime"] == regimes.STICK_SLIP:
            _check_count(group, row, k_of[beta], beta, what, cell)


def _amplitude_condition(row: Row, beta: float) -> Iterator:
    yield reference.condition(lambda r: row.amplitude(beta, r), row.r)
    if beta > 0.0:
        yield reference.condition(row.amplitude, beta)


def _check_consistent(group: Group, what: str, cell: dict) -> None:
    """Outputs that cannot all be true."""
    z, stops, stuck = cell["contact_amplitude"], cell["stops_per_cycle"], cell["stuck_fraction"]
    resolved = cell["status"] == regimes.RESOLVED
    regime = cell["regime"]
    slips = regime == regimes.STICK_SLIP
    for wrong, words in (
        (resolved and regime == regimes.UNRESOLVED, "resolved without a regime"),
        (resolved and math.isnan(z), "resolved, amplitude NaN"),
        (resolved and slips and math.isnan(stops), "resolved, stops NaN"),
        (resolved and slips and not stops > 0.0, f"slips with {stops} stops"),
        (regime == regimes.CONTINUOUS and stops != 0.0, f"continuous with {stops} stops"),
        (z < 0.0 or stops < 0.0, "negative"),
        (not (0.0 <= stuck <= 1.0) and not math.isnan(stuck), f"stuck for {stuck}"),
        (regime == regimes.PERMANENT_STICKING and z != 0.0, "stuck with an amplitude"),
        (resolved and slips and cell["period"] < 1, f"period {cell['period']}"),
    ):
        if wrong:
            group.inconsistent.append(f"{what}: {words}")


def _check_regime(group: Group, row: Row, beta: float, what: str, cell: dict) -> None:
    want, regime = row.regime(beta), cell["regime"]
    if want is None or regime in (want, regimes.UNRESOLVED):
        return
    if (want, regime) == (regimes.STICK_SLIP, regimes.CONTINUOUS) and _turns(row, beta) > _TWO:
        group.many_turns += 1
        return
    if row.near(beta):
        group.at_rounding += 1
        return
    edge = min((row.lim, row.stick), key=lambda x: abs(mp.mpf(beta) - x))
    distance = float((mp.mpf(beta) - edge) / edge) if edge else math.inf
    group.wrong.append(
        f"{what}: regime {regime}, is {want}; {distance:+.1e} from the boundary, "
        f"status {STATUS_NAMES[cell['status']]}"
    )


def _turns(row: Row, beta: float) -> float:
    """Changes of direction in a cycle of the steady state that the package gives."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            phase = fm.response(row.body.system, row.r, beta, row.mu).phase
        except fm.NoSteadyState:
            return math.nan
    moving = phase.values[phase.values != 0]
    cycles = round(float(phase.tau[-1]) / (2.0 * math.pi))
    return float(np.count_nonzero(np.diff(moving, append=moving[0]))) / cycles


def _one_mass(row: Row, beta: Number, r: Number, mu: Number) -> tuple[reference.OneMass, Number, Number]:
    """The normalised oscillator, and amplitude and phase of the load in its contact."""
    load = mp.mpc(1)
    if row.own.base_motion:
        load = mp.mpc(mp.mpf(r) ** 2, -2 * mp.mpf(row.body.zeta) * mp.mpf(r))
    return (
        reference.OneMass(r, row.body.zeta, mp.mpf(beta) / abs(load), mu), abs(load), mp.arg(load),
    )  # fmt: skip


def _steady(row: Row, beta: Number) -> tuple[reference.Steady | None, Number]:
    """The 40-digit steady state, if one is found, and the amplitude of the load in the contact."""
    motion, load, phase = _one_mass(row, beta, row.r, row.mu)
    try:
        if row.mu == 1.0:
            guess = row.amplitude(min(mp.mpf(beta), row.lim)) / load
            return motion.unique(guess, phase, _MOST_SLIDES), load
        return motion.steady(phase, _MOST_SLIDES), load
    except ArithmeticError:
        return None, load


def _check_count(group: Group, row: Row, k: int | None, beta: float, what: str, cell: dict) -> None:
    """Stops and amplitude against the 40-digit steady state, where one is found."""
    found, load = _steady(row, beta)
    if found is None:
        return
    group.counted += 1
    if not _same_count(cell, found):
        beside = [_steady(row, mp.mpf(beta) * (1 + sign * _BESIDE))[0] for sign in (1, -1)]
        if cell["status"] != regimes.RESOLVED:
            group.flagged_miscounts += 1
        elif any(orbit is not None and _same_count(cell, orbit) for orbit in beside):
            group.miscounts_at_rounding += 1
        else:
            stops = 2.0 * found.stops / found.halves
            group.miscounted.append(
                f"{what}: {cell['stops_per_cycle']:g} stops a cycle, are {stops:g} (the shortest takes "
                f"{mp.nstr(found.shortest, 3)})"
            )
    elif cell["status"] == regimes.RESOLVED:
        group.compare(
            f"amplitude: {what}", k, cell["contact_amplitude"], found.amplitude * load,
            partial(_orbit_condition, row, beta, found),
        )  # fmt: skip


def _same_count(cell: dict, found: reference.Steady) -> bool:
    stops = 2.0 * found.stops / found.halves
    return abs(cell["stops_per_cycle"] - stops) <= 1e-6 * stops


def _orbit_condition(row: Row, beta: float, found: reference.Steady) -> Iterator:
    """Of the amplitude of the orbit with respect to beta, r and mu."""

    def amplitude(beta: Number, r: Number, mu: Number) -> Number:
        motion, load, _ = _one_mass(row, beta, r, mu)
        orbit = motion.solved(found.anchor, found.slides)
        return found.amplitude * load if orbit is None else orbit.amplitude * load

    yield reference.condition(lambda b: amplitude(b, row.r, row.mu), beta)
    yield reference.condition(lambda r: amplitude(beta, r, row.mu), row.r)
    if row.mu > 1.0:
        yield reference.condition(lambda mu: amplitude(beta, row.r, mu), row.mu)


# ---------------------------------------------------------------- the groups


def _exponents(quick: bool) -> tuple[int, ...]:
    return (2, 6, 10, 14) if quick else tuple(range(1, 16))


def curves_at_r(quick: bool) -> Group:
    """One mass at r = 1, 1/(2n), 1/(2n + 1)."""
    group = Group("curves, r around 1, 1/2, 1/3 ...")
    orders = (1, 2, 3) if quick else (1, 2, 3, 4, 5, 6, 9, 10)
    for body in (one_mass(0.0), one_mass(1e-6), one_mass(0.05), one_mass(0.0, "joined-base-wall")):
        for n in orders:
            check_curves(group, body, around(mp.mpf(1) / n, _exponents(quick)))
    return group


def curves_at_zeta(quick: bool) -> Group:
    """One mass with zeta around 0 and 1, and far above."""
    group = Group("curves, zeta around 0 and 1, to 100")
    exponents = _exponents(quick)
    dampings: list[tuple[int | None, float]] = [(k, 10.0**-k) for k in exponents] + [
        p for p in around(mp.mpf(1), exponents) if p[1] != 1.0
    ]
    dampings += [(None, zeta) for zeta in (1.0, 3.0, 30.0, 100.0)]
    for k, zeta in dampings:
        for r in (0.1, 1.0 / 3.0, 1.0, 30.0) if not quick else (1.0 / 3.0, 1.0):
            check_curves(group, one_mass(zeta), [(k, r)], 1.2)
    return group


def curves_far(quick: bool) -> Group:
    """One mass, r from 1e-6 to 1e6."""
    group = Group("curves, r = 1e-6 to 1e6")
    for zeta in (0.0, 0.02, 1.0, 30.0):
        for contact in ("fixed-wall", "joined-base-wall"):
            least = -2 if quick else (-6 if zeta == 0.0 and contact == "fixed-wall" else -4)
            check_curves(group, one_mass(zeta, contact), [(None, 10.0**e) for e in range(least, 7)])
    return group


def _chains(quick: bool) -> list[Body]:
    bodies = [chain((1.0, 1.0), (1.0, 1.0), 0.0, [1]), chain((1.0, 1.0), (1.0, 1.0), 0.01, [1, 2])]
    if not quick:
        bodies += [
            chain((1.0, 0.5, 2.0), (1.0, 2.0, 0.7), 0.0, [2]),
            chain((1.0,) * 5, (1.0,) * 5, 0.0, [3]),
            chain((1.0,) * 5, (1.0,) * 5, 0.01, [2, 4], 3),
        ]
    return bodies


def curves_at_modes(quick: bool) -> Group:
    """Chains at natural frequencies, their halves and thirds, and at held frequencies."""
    group = Group("curves of chains, around w_i, w_i/2, w_i/3, held w")
    exponents = (3, 10) if quick else (1, 4, 7, 10, 13, 15)
    for body in _chains(quick):
        centres = [w / n for n in (1, 2, 3) for w in body.own.w[:2]]
        centres += [mp.mpf(float(w)) for w in body.system.modes.held_frequencies()[:2]]
        for centre in centres:
            check_curves(group, body, around(centre, exponents))
    return group


def curves_spread(quick: bool) -> Group:
    """Chains of masses and springs of very different size."""
    group = Group("curves of chains, masses or springs far apart")
    bodies = [chain((1.0, 1.0), (1.0, 1e8), 0.01, [1]), chain((1.0, 1e-8), (1.0, 1.0), 0.01, [1])]
    if not quick:
        bodies += [
            chain((1.0, 1.0, 1.0), (1.0, 1e10, 1.0), 0.01, [3]),
            chain((1.0, 1e-3, 1.0), (1.0, 1.0, 1e-3), 0.01, [1], 3),
            chain((1.0, 1e3, 1e6), (1.0, 1.0, 1.0), 0.01, [1]),
        ]
    for body in bodies:
        check_curves(group, body, [(None, r) for r in (0.3, 0.9, 2.0)])
    return group


def curves_close_modes(quick: bool) -> Group:
    """Fifty nearly equal oscillators."""
    group = Group("curves, 50 close modes")
    bodies = [close_modes(8, 1e-6, 0.01)] if quick else [
        close_modes(50, 1e-2, 0.01), close_modes(50, 1e-6, 0.01), close_modes(50, 1e-12, 0.01),
    ]  # fmt: skip
    for body in bodies:
        check_curves(group, body, [(None, r) for r in ((0.7, 1.3) if quick else (0.3, 0.7, 0.999, 1.3))])
    return group


def _rows(quick: bool) -> list[tuple[Body, float]]:
    ratios = (0.3, 1.0, 2.0) if quick else (
        0.05, 0.1, 0.2, 0.3, 1.0 / 3.0, 0.4, 0.5, 0.7, 0.999, 1.0, 1.0 + 1e-9, 1.2, 2.0, 5.0, 20.0, 100.0,
        1e4,
    )  # fmt: skip
    dampings = (0.0, 0.2) if quick else (0.0, 1e-6, 0.01, 0.2, 1.0, 3.0)
    contacts = ("fixed-wall",) if quick else ("fixed-wall", "joined-base-wall")
    return [(one_mass(z, c), r) for c in contacts for z in dampings for r in ratios]


def _check_edge(group: Group, row: Row, edge: Number, index: int, quick: bool) -> None:
    """Cells around a boundary; stops are counted in a few rows only, as that is slow."""
    check_cells(group, row, around(edge, _exponents(quick)))
    if index % _EVERY == 0:
        check_cells(group, row, around(edge, (3, 6)), count=True)


def cells_at_lim(quick: bool) -> Group:
    """beta = beta_lim (1 +- 10^-k), mu = 1."""
    group = Group("cells, beta around beta_lim")
    for index, (body, r) in enumerate(_rows(quick)):
        row = Row.of(body, r)
        if row.lim != 0 and row.lim <= row.stick:
            _check_edge(group, row, row.lim, index, quick)
    return group


def cells_at_stick(quick: bool) -> Group:
    """beta = beta_stick (1 +- 10^-k), mu = 1."""
    group = Group("cells, beta around beta_stick")
    for index, (body, r) in enumerate(_rows(quick)):
        row = Row.of(body, r)
        _check_edge(group, row, row.stick, index, quick)
    return group


def cells_without_friction(quick: bool) -> Group:
    """beta = 0, and 10^-k."""
    group = Group("cells, beta = 0 and 10^-k")
    for body, r in _rows(quick):
        check_cells(group, Row.of(body, r), [(None, 0.0), *((k, 10.0**-k) for k in _exponents(quick))])
    return group


def cells_inside(quick: bool) -> Group:
    """The strip between the boundaries, mu = 1."""
    group = Group("cells inside the strip, stops counted")
    rng = np.random.default_rng(5)
    for body, r in _rows(quick)[:: 1 if quick else 3]:
        row = Row.of(body, r)
        if row.lim < row.stick:
            share = mp.mpf(rng.uniform(0.02, 0.98))
            check_cells(group, row, [(None, float(row.lim + share * (row.stick - row.lim)))], count=True)
    return group


def cells_at_mu(quick: bool) -> Group:
    """mu = 1 + 10^-k, from rest."""
    group = Group("cells, mu = 1 + 10^-k, stops counted")
    places = (
        ((0.3, 0.0), (1.2, 0.05)) if quick else ((0.1, 0.0), (0.3, 0.0), (0.7, 0.02), (1.2, 0.05), (3.0, 0.3))
    )
    for r, zeta in places:
        for k in _exponents(quick)[:: 1 if quick else 2]:
            row = Row.of(one_mass(zeta), r, 1.0 + 10.0**-k)
            check_cells(group, row, [(k, float(row.lim + (row.stick - row.lim) / 3))], count=True)
    return group


def cells_grazing(quick: bool) -> Group:
    """beta where the number of stops changes, +- 10^-k: a dip of the velocity touches zero there."""
    group = Group("cells, grazing, stops counted")
    for r, zeta in ((0.1, 0.0),) if quick else ((0.1, 0.0), (0.25, 0.01)):
        row = Row.of(one_mass(zeta), r)
        for low, high in _changes(row, 1 if quick else 2):
            edge = mp.mpf(_bisected(row, low, high))
            cells = around(edge, (4, 8) if quick else (4, 10))
            check_cells(group, row, cells, count=True)
    return group


def _stops(row: Row, betas: Sequence[float]) -> np.ndarray:
    ds = fm.sweep(row.body.system, [row.r], betas, row.mu, threads=1)
    return np.nan_to_num(ds.stops_per_cycle.values[0, 0], nan=-1.0)


def _changes(row: Row, most: int) -> list[tuple[float, float]]:
    """Neighbours on a grid with different numbers of stops."""
    betas = np.linspace(float(row.lim) * 1.05, 0.9 * float(row.stick), 60)
    stops = _stops(row, betas.tolist())
    where = np.flatnonzero((stops[1:] != stops[:-1]) & (stops[1:] > 0) & (stops[:-1] > 0))
    return [(float(betas[j]), float(betas[j + 1])) for j in where[:most]]


def _bisected(row: Row, low: float, high: float) -> float:
    """Where the number changes, to the double."""
    below = _stops(row, [low])[0]
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return middle
        if _stops(row, [middle])[0] == below:
            low = middle
        else:
            high = middle


def cells_chattering(quick: bool) -> Group:
    """Low r: many short stops in a cycle."""
    group = Group("cells, chattering (r to 0.015), stops counted")
    for r in (0.03,) if quick else (0.03, 0.015):
        for zeta in (0.0, 0.02):
            row = Row.of(one_mass(zeta), r)
            check_cells(group, row, [(None, beta) for beta in (0.2, 0.5, 0.9)], count=True)
    return group


def cells_far(quick: bool) -> Group:
    """r from 1e-6 to 1e6."""
    group = Group("cells, r = 1e-6 to 1e6")
    for e in (-2, 3, 6) if quick else range(-6, 7):
        for zeta in (0.0, 0.05, 2.0) if e > -5 else (0.0,):
            # undamped there are 10^4 and more slides a cycle, each with its stop
            shares = (0.5,) if e < -3 and zeta == 0.0 else (0.01, 0.3, 0.7, 0.99)
            row = Row.of(one_mass(zeta), 10.0**e)
            cells = [(None, float(row.lim + mp.mpf(share) * (row.stick - row.lim))) for share in shares]
            check_cells(
                group,
                row,
                [*cells, (None, float(row.lim / 2)), (None, 2.0)],
                count=e >= 0,
                cycles=2000 if e > -5 else 20,
            )
    return group


def cells_of_chains(quick: bool) -> Group:
    """Chains: beta around both boundaries, at singular and other frequencies, mu = 1."""
    group = Group("cells of chains, beta around beta_lim, beta_stick")
    exponents = (3, 10) if quick else (1, 3, 5, 7, 9, 11, 13, 15)
    for body in _chains(quick):
        own = body.own
        held = float(body.system.modes.held_frequencies()[0])
        ratios = (0.7, float(own.w[0])) if quick else (
            0.31, 0.7, 1.3, float(own.w[0]), float(own.w[1]) * (1.0 - 1e-9), float(own.w[0]) / 2.0, held,
            held * (1.0 + 1e-6), 30.0,
        )  # fmt: skip
        for r in ratios:
            row = Row.of(body, r)
            if not (0 < row.lim < row.stick):
                continue
            cells = around(row.lim, exponents) + around((row.lim + row.stick) / 2, ())
            if mp.isfinite(row.stick):
                cells += around(row.stick, exponents)
            check_cells(group, row, [(k, beta) for k, beta in cells if math.isfinite(beta)])
    return group


def cells_of_close_modes(quick: bool) -> Group:
    """Fifty nearly equal oscillators: regimes around both boundaries."""
    group = Group("cells, 50 close modes")
    for body in (
        [close_modes(8, 1e-6, 0.01)] if quick else [close_modes(50, 1e-2, 0.01), close_modes(50, 1e-6, 0.01)]
    ):
        for r in (0.7,) if quick else (0.7, 1.3):
            row = Row.of(body, r)
            cells = (
                around(row.lim, (2, 8)) + around(row.stick, (2, 8)) + around((row.lim + row.stick) / 2, ())
            )
            check_cells(group, row, cells)
    return group


def million_cycles(quick: bool) -> Group:
    """Marched to the end, up to 10^6 cycles: what is left of the digits of the closed form."""
    group = Group("marched, cycles = 10^6" if not quick else "marched, cycles = 10^4")
    cycles = 10**4 if quick else 10**6
    for r, zeta, share in ((0.999, 0.0, 0.01), (0.97, 1e-5, 0.001), (5.0, 0.0, 0.9), (20.0, 0.0, 0.5)):
        row = Row.of(one_mass(zeta), r)
        check_cells(
            group, row, [(None, float(share * row.lim))], cycles=cycles, skip="none", steady="marched",
            tolerance=1e-15,
        )  # fmt: skip
        check_cells(
            group, row, [(None, float(row.lim + (row.stick - row.lim) / 2))], cycles=cycles, skip="none",
            steady="marched", tolerance=1e-15, count=True,
        )  # fmt: skip
    return group


GROUPS: tuple[Callable[[bool], Group], ...] = (
    curves_at_r, curves_at_zeta, curves_far, curves_at_modes, curves_spread, curves_close_modes, cells_at_lim,
    cells_at_stick, cells_without_friction, cells_inside, cells_at_mu, cells_grazing, cells_chattering,
    cells_far, cells_of_chains, cells_of_close_modes, million_cycles,
)  # fmt: skip


# ---------------------------------------------------------------- what came of it


def _summary(group: Group) -> dict:
    left = sorted(16.0 - row["lost"] for row in group.answers)
    return {
        "cells": group.cells,
        "resolved": group.statuses[regimes.RESOLVED],
        "other statuses": {
            STATUS_NAMES[s]: n for s, n in sorted(group.statuses.items()) if s != regimes.RESOLVED
        },
        "numbers compared": len(left),
        "digits left, least": left[0] if left else None,
        "digits left, median": left[len(left) // 2] if left else None,
        "digits explained by condition, most": max(
            (row["explained"] for row in group.answers), default=0.0
        ),
        "digits lost beyond, most": max(
            (max(row["lost"] - row["explained"], 0.0) for row in group.answers), default=0.0
        ),
        "more than allowed": len(group.beyond),
        "wrong regimes": len(group.wrong),
        "wrong regimes at rounding": group.at_rounding,
        "no stops, but more than two turns a cycle": group.many_turns,
        "stops counted": group.counted,
        "wrong stop counts": len(group.miscounted),
        "wrong stop counts at rounding": group.miscounts_at_rounding,
        "wrong stop counts with a status": group.flagged_miscounts,
        "inconsistent": len(group.inconsistent),
        "trouble": len(group.trouble),
        "slowest cell [s]": group.slowest,
        "seconds": group.seconds,
        "list": {
            "digits": [
                {name: row[name] if name == "what" else round(row[name], 1) for name in row if name != "k"}
                for row in group.beyond
            ],
            "regimes": group.wrong,
            "stops": group.miscounted,
            "inconsistent": group.inconsistent,
            "trouble": group.trouble,
        },
    }  # fmt: skip


def _print(content: dict) -> None:
    header = (
        "group", "cells", "resolved", "left", "median", "beyond", "> 2", "regimes", "(round.)", "counted",
        "stops", "(round.)", "(status)", "incons.", "trouble", "slowest", "s",
    )  # fmt: skip
    keys = (
        "cells", "resolved", "digits left, least", "digits left, median", "digits lost beyond, most",
        "more than allowed", "wrong regimes", "wrong regimes at rounding", "stops counted",
        "wrong stop counts", "wrong stop counts at rounding", "wrong stop counts with a status",
        "inconsistent", "trouble", "slowest cell [s]", "seconds",
    )  # fmt: skip
    table(
        header, [(name, *("-" if row[k] is None else row[k] for k in keys)) for name, row in content.items()]
    )
    for name, row in content.items():
        if row["other statuses"]:
            print(f"{name}: {', '.join(f'{n} {s}' for s, n in row['other statuses'].items())}")
    for name, row in content.items():
        lines = [
            f"{r['what']}: {r['lost']:.1f} digits lost, {r['explained']:.1f} explained"
            for r in row["list"]["digits"]
        ]
        for kind in ("regimes", "stops", "inconsistent", "trouble"):
            lines += [f"{kind}: {line}" for line in row["list"][kind]]
        for line in lines[:SHOWN]:
            print(f"{name} | {line}")
        if len(lines) > SHOWN:
            print(f"{name} | ... and {len(lines) - SHOWN} more in stress.json")


#: Lines printed of a group's list; the JSON has all.
SHOWN = 12


def run(quick: bool, results: Path) -> dict:
    """Run every group, print, save and draw."""
    groups = []
    with pinned():
        for make in GROUPS:
            began = time.perf_counter()
            group = make(quick)
            group.seconds = time.perf_counter() - began
            groups.append(group)
            print(f"{group.name}: {group.seconds:.1f} s", flush=True)
    summaries = {group.name: _summary(group) for group in groups}
    _print(summaries)
    random = random_cells.random_cells(*RANDOM_CELLS[quick])
    random_cells.report(random)
    content = {
        "allowed beyond the condition number": ALLOWED,
        "groups": summaries,
        "random cells": random,
    }
    save("stress", content, results)
    draw(groups, results / "stress.png")
    return content


#: Columns of the picture: exponents k, the singular point itself, and cells without a distance from one.
_AT_POINT = 16
_OTHER = 17


def _worst_by_distance(group: Group) -> dict[int, float]:
    """Column of the picture: digits lost beyond the condition number by the worst number in it."""
    worst: dict[int, float] = {}
    for row in group.answers:
        column = _OTHER if row["k"] is None else row["k"]
        worst[column] = max(worst.get(column, 0.0), row["lost"] - row["explained"], 0.0)
    return worst


def _verdict(group: Group) -> str:
    """Regimes and stops in a few words."""
    if not group.statuses:
        return ""
    cells = f"{len(group.wrong)} of {group.cells}"
    return cells + (f"; {len(group.miscounted)} of {group.counted}" if group.counted else "")


def draw(groups: Sequence[Group], path: Path) -> None:
    """Digits lost beyond the condition number, by group and distance from the singular point."""
    figure = new_figure(11.0, 0.33 * len(groups) + 1.7)
    axes = figure.subplots()
    lost = np.full((len(groups), _OTHER), np.nan)
    for i, group in enumerate(groups):
        for column, digits in _worst_by_distance(group).items():
            lost[i, column - 1] = digits
            axes.text(
                column, i, f"{digits:.0f}", ha="center", va="center", fontsize=8,
                color="white" if digits > 8.0 else "black",
                fontweight="bold" if digits > ALLOWED else "normal",
            )  # fmt: skip
        axes.text(_OTHER + 0.8, i, _verdict(group), va="center", fontsize=8)
    colours = ListedColormap(("#d9ead3", "#f9cb9c", "#e06666", "#990000"))
    axes.imshow(
        lost, cmap=colours, norm=BoundaryNorm((0.0, ALLOWED, 5.0, 8.0, 16.1), 4), aspect="auto",
        extent=(0.5, _OTHER + 0.5, len(groups) - 0.5, -0.5),
    )  # fmt: skip
    axes.set_yticks(range(len(groups)), [group.name for group in groups], fontsize=9)
    axes.set_xticks(range(1, _OTHER + 1), [*(str(k) for k in range(1, _AT_POINT)), "at", "other"], fontsize=8)
    axes.set_xticks(np.arange(1.5, _OTHER), minor=True)
    axes.set_yticks(np.arange(0.5, len(groups)), minor=True)
    axes.grid(which="minor", color="white", linewidth=1.2)
    axes.tick_params(which="both", length=0)
    axes.set_xlabel(
        "relative distance 10$^{-k}$ from the singular point: k;  at: the point itself", fontsize=9
    )
    axes.text(_OTHER + 0.8, -0.9, "wrong regimes; wrong stop counts", fontsize=8)
    beyond = sum(len(group.beyond) for group in groups)
    total = sum(len(group.answers) for group in groups)
    axes.set_title(
        f"Digits lost beyond what the condition number explains, worst of each group (of 16)\n"
        f"green: at most {ALLOWED:.0f}; more in {beyond} of {total} numbers",
        fontsize=10, loc="left", pad=18,
    )  # fmt: skip
    axes.set_xlim(0.5, _OTHER + 5.0)
    for side in ("top", "right", "left", "bottom"):
        axes.spines[side].set_visible(False)
    save_figure(figure, path)
