"""Quantities of a steady state over a cycle: harmonics, works, phases."""

import numpy as np

from .._kernels.general.problem import SECTION
from ..model.system import System
from .held import base_seen_by_dampers
from .loops import undetermined_forces
from .outputs import output_values
from .problem import general_of, static_offset
from .steps import Steps

#: Samples per period and step among which the largest displacement is looked for.
_SAMPLES = 8

#: Steps to the phase of a maximum.
_REFINED = 6

#: Amplitude over P/k1 at or below which a contact rests.
_ROUNDING = 1e-12

#: A whole period of the load.
_TURN = 2.0 * np.pi

#: Speed of a mass at rest, over its largest, and the shortest stop that holds a maximum.
_STILL, _LEAST_STOP = 1e-9, 1e-7

#: Phasor that is not known.
_UNKNOWN = complex(np.nan, np.nan)


def parts(phasors: np.ndarray) -> np.ndarray:
    """Real and imaginary parts as a last dimension."""
    return np.stack((phasors.real, phasors.imag), axis=-1)


def _lag(phasors: np.ndarray) -> np.ndarray:
    return np.where(phasors == 0.0, np.nan, -np.angle(np.where(phasors == 0.0, 1.0, phasors)))


def _contact_harmonics(system: System, steps: Steps, x: np.ndarray, highest: int) -> np.ndarray:
    """Harmonics of the displacements in the contacts, complex (N, highest + 1)."""
    general = general_of(system)
    if general.points is None:
        return steps.harmonics("z", highest)
    found = general.points.vectors @ x
    for order, u in general.base.items():
        if order <= highest:
            found[:, order] -= u * general.joined
    return found


def harmonic_values(system: System, steps: Steps, highest: int) -> dict[str, np.ndarray]:
    """Harmonics 0 to `highest` of masses, contacts and forces; NaN of a motion that does not repeat."""
    offset_z, offset_x = static_offset(system)
    x = steps.displacement_harmonics(highest)
    z, f = _contact_harmonics(system, steps, x, highest), steps.harmonics("f", highest)
    x[:, 0] += offset_x
    z[:, 0] += offset_z
    general = general_of(system)
    if general.loop:
        f[undetermined_forces(general.vectors.T, steps.senses == 0).any(axis=0)] = _UNKNOWN
    phasors = {"displacement_harmonic": x, "contact_harmonic": z, "friction_harmonic": f}
    if steps.period and steps.drifts:  # forces repeat, and displacements do not
        unknown = {name: np.full_like(values, _UNKNOWN) for name, values in phasors.items()}
        return unknown | {"friction_harmonic": f}
    if steps.period:
        return phasors
    return {name: np.full_like(values, _UNKNOWN) for name, values in phasors.items()}


def _damping_work(system: System, steps: Steps) -> float:
    """Work of viscous damping per period of the load, r times the integral of x'.C1 x'."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    x = 0.5 * (1.0 + nodes) * (steps.lengths[:, np.newaxis] / steps.h)
    series = steps.series[:, steps.rows("q")]
    velocity = steps.values(series[:, :, np.newaxis, :], x[:, np.newaxis, :], 1)
    damping, seen = steps.problem.damping, base_seen_by_dampers(system)
    if seen is not None:
        base = _base_velocity(system, steps, x)
        velocity = steps.modal.phi @ velocity + seen[:, np.newaxis] * base[:, np.newaxis, :]
        damping = steps.modal.viscous
    power = np.einsum("sig,ij,sjg->sg", velocity, damping, velocity)
    whole = np.sum(power * 0.5 * weights * steps.lengths[:, np.newaxis])
    return float(steps.r * whole / steps.period)


def _base_velocity(system: System, steps: Steps, x: np.ndarray) -> np.ndarray:
    tau = SECTION + steps.begins[:, np.newaxis] + x * steps.h
    found = np.zeros_like(tau)
    for order, phasor in general_of(system).base.items():
        found += (1j * order * phasor * np.exp(1j * order * tau)).real
    return found


def work_values(system: System, steps: Steps) -> dict[str, np.ndarray]:
    """Works per cycle; with base excitation, and of a drifting motion, the input follows from the balance.

    Of a motion that does not repeat only the work of friction is known, an average.
    """
    general = general_of(system)
    friction, wall = (
        output_values(f"work_{of}", system, steps.cells)[0, 0, 0] for of in ("friction", "wall")
    )
    if not steps.period:
        unknown = np.array(np.nan)
        return {"work_input": unknown, "work_damping": unknown, "work_friction": friction}
    damping = _damping_work(system, steps)
    if general.base or steps.drifts:
        given = friction.sum() + damping - wall.sum()
    else:
        highest = max(general.loads)
        x = steps.displacement_harmonics(highest)
        given = np.pi * sum(n * (p * x[:, n].conj()).imag.sum() for n, p in general.loads.items())
    return {"work_input": np.array(given), "work_damping": np.array(damping), "work_friction": friction}


def first_harmonics(found: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Amplitudes and lags of the first harmonics."""
    x, z = found["displacement_harmonic"][:, 1], found["contact_harmonic"][:, 1]
    return {
        "first_harmonic_amplitude": np.abs(x), "first_harmonic_phase": _lag(x),
        "contact_first_harmonic_amplitude": np.abs(z), "contact_first_harmonic_phase": _lag(z),
    }  # fmt: skip


def phase_values(steps: Steps) -> dict[str, np.ndarray]:
    """Lags of the maxima of the displacements; of those held over a stop its begin and end instead.

    NaN where the period is not 1, and of masses at rest.
    """
    count = len(steps.displacements(np.zeros(1)))
    found = {name: np.full(count, np.nan) for name in ("phase_lag", "phase_begin", "phase_end")}
    if steps.period != 1 or steps.drifts:
        return found
    tau = np.linspace(0.0, _TURN, _SAMPLES * max(64, steps.begins.size) + 1)[:-1]
    x = steps.displacements(tau)
    edges = np.append(steps.begins, _TURN)
    speeds = np.abs(steps.displacements(SECTION + 0.5 * (edges[:-1] + edges[1:]), 1))
    still = speeds <= _STILL * speeds.max(axis=1, keepdims=True)
    for i in range(count):
        if np.ptp(x[i]) <= _ROUNDING * np.abs(x).max():
            continue
        largest = np.argmax(np.abs(x[i]))
        place = _maximum(steps, i, tau[largest], tau[1])
        begin, end = _stop(edges, still[i], place)
        half = np.pi if x[i, largest] < 0.0 else 0.0  # a minimum counts as a maximum half a period later
        held = end - begin > _LEAST_STOP
        lag = np.mod((begin if held else place) + half + np.pi, _TURN) - np.pi
        found["phase_begin" if held else "phase_lag"][i] = lag
        if held:
            found["phase_end"][i] = lag + end - begin
    return found


def _maximum(steps: Steps, i: int, place: float, step: float) -> float:
    """The phase of an extreme of the displacement of mass i near a sample, `step` from the next one."""
    for _ in range(_REFINED):
        around = place + 1e-4 * step * np.array([-1.0, 0.0, 1.0])
        v = steps.displacements(around, 1, i)
        bend = (v[2] - v[0]) / (around[2] - around[0])
        if bend == 0.0:
            break
        place += float(np.clip(-v[1] / bend, -step, step))
    return place


def _stop(edges: np.ndarray, still: np.ndarray, place: float) -> tuple[float, float]:
    """Begin and end of the stop of a mass around a phase; equal if it moves there.

    edges : (K + 1,) of the steps, since the section
    still : (K,) bool: whether the mass rests in each step
    """
    k = int(np.searchsorted(edges, np.mod(place - SECTION, _TURN), side="right")) - 1
    if still.all() or not still[min(k, still.size - 1)]:
        return place, place
    moves = np.flatnonzero(~still)
    before, after = moves[moves < k], moves[moves > k]
    begin = edges[before[-1] + 1] if before.size else edges[moves[-1] + 1] - _TURN
    end = edges[after[0]] if after.size else edges[moves[0]] + _TURN
    return SECTION + float(begin), SECTION + float(end)


def equivalent_of(found: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Equivalent stiffness and damping of each contact, from F_1/Z_1; NaN where it rests."""
    z, f = found["contact_harmonic"][:, 1], found["friction_harmonic"][:, 1]
    moves = np.abs(z) > _ROUNDING
    ratio = np.where(moves, f / np.where(moves, z, 1.0), _UNKNOWN)
    return {"equivalent_stiffness": ratio.real, "equivalent_damping": ratio.imag}


def cycle_values(system: System, steps: Steps, highest: int) -> dict[str, np.ndarray]:
    """All quantities of a cell over a cycle; phasors as real and imaginary parts."""
    phasors = harmonic_values(system, steps, max(highest, 1))
    return {
        **{name: parts(values) for name, values in phasors.items()},
        **first_harmonics(phasors),
        **work_values(system, steps),
    }
