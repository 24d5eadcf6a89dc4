"""One structure at one frequency: free and held oscillators, and the conversion between their coordinates.

A sliding structure is described by the free oscillators, which are the modes unless the damping couples them.
In a stop the contact keeps its displacement, and the rest moves as the held oscillators about the static
shape that belongs to this displacement.  Both states are in units of one scan step: row 0 holds the
coordinates, row 1 their change per step.  Outputs are linear in the coordinates and in the reduced velocities
p: the velocities in t = tau/r less their direct feedthrough from the load.

With a joined base-wall all displacements are relative to the base; its contact is then that with a fixed wall
under another load (`modes.relative_load`), and no kernel handles a moving base.
"""

import math
from typing import NamedTuple

import numpy as np

from ..closed_form import fastest_rate
from ..compiler import entry, kernel
from ..compiler.vectors import LANES, filled, load, root, store, total
from ..taylor_series import series_terms
from .block import EQUATION, REACH, STEADY, STEADY_IM, STEADY_LOAD, STEADY_RE, block_size, fill_block
from .oscillators import (
    COLUMNS,
    F1,
    FC,
    FS,
    OMEGA,
    OW,
    OZ,
    YC,
    YS,
    ZETA,
    D,
    H,
    K,
    fill_steps,
    make_state,
    padded,
    value,
    watch_load,
)

# Rows of the table of free oscillators: frequency, damping ratio, response to a contact force, static shape;
# coefficients of the coordinate and of p in the contact load, in z, and in dz/dt; cos and sin of the
# feedthrough of the load into the velocity.
W, DAMPING, PUSH, STATIC_SHAPE, LOAD, LOAD_RATE, Z, Z_RATE, SPEED, SPEED_RATE = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
FEEDTHROUGH_COS, FEEDTHROUGH_SIN = 10, 11
MODE_ROWS = 12

#: Largest number of load periods that `held_period` examines.
_LONGEST_REPEAT = 256


class StructureAtFrequency(NamedTuple):
    """Structure at one frequency; all fields depend on (system, r, steps) only."""

    n: int  # participating free oscillators
    m: int  # held oscillators, n - 1
    r: float
    h: float  # scan step in tau
    rate: float  # r/h: velocity in t per change in one step
    terms: int
    inverse_mass: float  # 1/m_eff
    stiffness: float  # static stiffness at the contact
    reach: float  # largest load in the contact of a motion of unit energy
    overlap: float  # cosine of the angle in this norm between motions with the most load, and the most speed
    norm: float  # upper bound on the energy norm over that of the free oscillators; 1 for modes
    free_cos: float  # load in the contact while it slides, without the oscillators' part
    free_sin: float
    displacement_cos: float  # z without the oscillators' part
    displacement_sin: float
    modes: np.ndarray  # (MODE_ROWS, padded(n))
    free: np.ndarray  # (n + 1, COLUMNS) tables of `oscillators`
    held: np.ndarray  # (m + 1, COLUMNS)
    free_block: np.ndarray  # eight scan steps at once, see `block`
    held_block: np.ndarray
    held_feedthrough: np.ndarray  # (2, padded(m)) cos and sin of the feedthrough of the load into y'
    into_held: np.ndarray  # (2n, 2 padded(m)) what each free (u, v) adds to all y, then to all p
    into_free: np.ndarray  # (2m, 2 padded(n)) what each held (y, p) adds to all u, then to all v


class Model(NamedTuple):
    """Numerical model of a system; no field depends on r."""

    modes: np.ndarray  # as of `StructureAtFrequency`, with the feedthrough rows empty
    omega: np.ndarray  # (m,) held oscillators
    ratio: np.ndarray
    watch: np.ndarray  # (2m,) coefficients of (y, p) in the load in the contact
    to_free: np.ndarray  # (2n, 2m), see `held.HeldStructure`
    to_held: np.ndarray  # (2m, 2n)
    inverse_mass: float
    stiffness: float
    reach: float
    overlap: float
    norm: float


class Loads(NamedTuple):
    """Load at every r; arrays (n_r, n), (n_r, m) and (n_r,)."""

    free_cos: np.ndarray  # (n_r, n) load on the free oscillators
    free_sin: np.ndarray
    free_feedthrough_cos: np.ndarray  # (n_r, n)
    free_feedthrough_sin: np.ndarray
    held_cos: np.ndarray  # (n_r, m) load on the held oscillators
    held_sin: np.ndarray
    held_feedthrough_cos: np.ndarray  # (n_r, m)
    held_feedthrough_sin: np.ndarray
    contact_cos: np.ndarray  # (n_r,) load acting directly on the contact
    contact_sin: np.ndarray


@kernel
def _fill_free(loads, i, scale, n, modes, free):
    """Fill the table of the free oscillators, and the feedthrough of the load into their velocities."""
    square = scale * scale
    for j in range(n):
        w = modes[W, j]
        zeta = modes[DAMPING, j]
        free[j, K] = (w * scale) * (w * scale)
        free[j, D] = 2.0 * zeta * (w * scale)
        free[j, FC] = loads.free_cos[i, j] * square
        free[j, FS] = loads.free_sin[i, j] * square
        free[j, F1] = -modes[PUSH, j] * square
        free[j, OZ] = modes[SPEED, j] * scale
        free[j, OW] = modes[SPEED_RATE, j]
        free[j, OMEGA] = w
        free[j, ZETA] = zeta
        modes[FEEDTHROUGH_COS, j] = loads.free_feedthrough_cos[i, j]
        modes[FEEDTHROUGH_SIN, j] = loads.free_feedthrough_sin[i, j]


@kernel
def _fill_held(model, loads, i, scale, held, feedthrough):
    """Fill the table of the held oscillators; return cos and sin of the load in the contact without their
    part.
    """
    m = model.omega.size
    square = scale * scale
    contact_cos = -loads.contact_cos[i]
    contact_sin = -loads.contact_sin[i]
    for j in range(m):
        omega = model.omega[j]
        held[j, K] = (omega * scale) * (omega * scale)
        held[j, D] = 2.0 * model.ratio[j] * (omega * scale)
        held[j, FC] = loads.held_cos[i, j] * square
        held[j, FS] = loads.held_sin[i, j] * square
        held[j, OZ] = model.watch[j]
        held[j, OW] = model.watch[m + j] / scale
        held[j, OMEGA] = omega
        held[j, ZETA] = model.ratio[j]
        feedthrough[0, j] = loads.held_feedthrough_cos[i, j]
        feedthrough[1, j] = loads.held_feedthrough_sin[i, j]
        contact_cos -= model.watch[m + j] * feedthrough[0, j]
        contact_sin -= model.watch[m + j] * feedthrough[1, j]
    return contact_cos, contact_sin


@kernel
def _feedthrough(modes, row):
    """Direct-feedthrough terms, cos and sin, of a velocity row."""
    cosine, sine = 0.0, 0.0
    for j in range(modes.shape[1]):
        cosine -= modes[row, j] * modes[FEEDTHROUGH_COS, j]
        sine -= modes[row, j] * modes[FEEDTHROUGH_SIN, j]
    return cosine, sine


@entry
def _padded_parts(matrix, rows, parts, n):
    """Return a matrix (rows, parts n) with each part padded by zeros to whole vectors."""
    width = padded(n)
    out = np.zeros((rows, parts * width))
    for row in range(rows):
        for part in range(parts):
            for j in range(n):
                out[row, part * width + j] = matrix[row, part * n + j]
    return out


@entry
def make_structure(model, loads, i, r, steps):
    """Build the structure at the i-th frequency, r > 0, for `steps` scan steps per period of the fastest
    part.
    """
    n = model.modes.shape[1]
    m = model.omega.size
    fastest = 0.0
    for j in range(n):
        fastest = max(fastest, fastest_rate(model.modes[W, j], model.modes[DAMPING, j]))
    for j in range(m):
        fastest = max(fastest, fastest_rate(model.omega[j], model.ratio[j]))
    turn, terms = series_terms(steps)
    h = turn / max(1.0, fastest / r)
    scale = h / r
    free = np.zeros((n + 1, COLUMNS))
    modes = _padded_parts(model.modes, MODE_ROWS, 1, n)
    _fill_free(loads, i, scale, n, modes, free)
    fill_steps(free, h, terms)
    speed_cos, speed_sin = _feedthrough(modes, SPEED_RATE)
    watch_load(free, speed_cos * scale, speed_sin * scale)
    held = np.zeros((m + 1, COLUMNS))
    feedthrough = make_state(m)
    held_cos, held_sin = _fill_held(model, loads, i, scale, held, feedthrough)
    fill_steps(held, h, terms)
    watch_load(held, held_cos, held_sin)
    free_block = np.zeros(block_size(n))
    fill_block(free, free_block)
    held_block = np.zeros(block_size(m))
    fill_block(held, held_block)
    _fill_steady(held, held_block)
    load_cos, load_sin = _feedthrough(modes, LOAD_RATE)
    displacement_cos, displacement_sin = _feedthrough(modes, Z_RATE)
    return StructureAtFrequency(
        n, m, r, h, r / h, terms, model.inverse_mass, model.stiffness, model.reach,
        model.overlap, model.norm,
        load_cos - loads.contact_cos[i], load_sin - loads.contact_sin[i], displacement_cos, displacement_sin,
        modes, free, held, free_block, held_block, feedthrough,
        _padded_parts(model.to_held.T, 2 * n, 2, m), _padded_parts(model.to_free.T, 2 * m, 2, n),
    )  # fmt: skip


@kernel
def contact_displacement(st, state, c, s):
    """Contact displacement z of a free state."""
    total = st.displacement_cos * c + st.displacement_sin * s
    rate = 0.0
    for i in range(st.n):
        total += st.modes[Z, i] * state[0, i]
        rate += st.modes[Z_RATE, i] * state[1, i]
    return total + st.rate * rate


@kernel
def contact_load(st, state, c, s):
    """Load in the contact while it slides, theory.md 5."""
    total = st.free_cos * c + st.free_sin * s
    for i in range(st.n):
        total += st.modes[LOAD, i] * state[0, i] + st.modes[LOAD_RATE, i] * (st.rate * state[1, i])
    return total


@kernel
def held_load(st, held, z, c, s):
    """Load in the contact while it is held at z."""
    return value(st.held, held, c, s) + st.stiffness * z


@kernel
def hold(st, state, z, c, s, held):
    """Convert free-mode coordinates to held-mode coordinates (requires z' = 0)."""
    n, modes = st.n, st.modes
    width = padded(st.m)
    for first in range(0, width, LANES):
        y = filled(0.0)
        p = filled(0.0)
        for i in range(n):
            u = state[0, i] - modes[STATIC_SHAPE, i] * z
            v = st.rate * state[1, i] - (modes[FEEDTHROUGH_COS, i] * c + modes[FEEDTHROUGH_SIN, i] * s)
            of_u = 2 * width * i + first
            of_v = 2 * width * (n + i) + first
            y = y + (u * load(st.into_held, of_u) + v * load(st.into_held, of_v))
            p = p + (u * load(st.into_held, of_u + width) + v * load(st.into_held, of_v + width))
        feedthrough = c * load(st.held_feedthrough, first) + s * load(st.held_feedthrough, width + first)
        store(y, held, first)
        store((p + feedthrough) * (1.0 / st.rate), held, held.shape[1] + first)


@kernel
def release(st, held, z, c, s, state):
    """Convert held-mode coordinates to free-mode coordinates."""
    m, modes = st.m, st.modes
    width = padded(st.n)
    for first in range(0, width, LANES):
        u = z * load(modes, STATIC_SHAPE * width + first)
        v = c * load(modes, FEEDTHROUGH_COS * width + first) + s * load(
            modes, FEEDTHROUGH_SIN * width + first
        )
        for k in range(m):
            y = held[0, k]
            p = st.rate * held[1, k] - (st.held_feedthrough[0, k] * c + st.held_feedthrough[1, k] * s)
            of_y = 2 * width * k + first
            of_p = 2 * width * (m + k) + first
            u = u + (y * load(st.into_free, of_y) + p * load(st.into_free, of_p))
            v = v + (y * load(st.into_free, of_y + width) + p * load(st.into_free, of_p + width))
        store(u, state, first)
        store(v * (1.0 / st.rate), state, state.shape[1] + first)


@kernel
def mirror(st, state):
    """Change the sign of a free state."""
    for i in range(st.n):
        state[0, i] = -state[0, i]
        state[1, i] = -state[1, i]


@kernel
def energy(st, state):
    """Energy norm of theory.md 6 of a free state or of a difference of two, or an upper bound on it.

    It is sqrt(sum w_i^2 q_i^2 + q_i'^2) over the modes, with derivatives in t.  Where the damping couples the
    modes it is multiplied by a factor that makes it an upper bound on the energy norm, which never grows.
    """
    total = 0.0
    for i in range(st.n):
        total += (st.modes[W, i] * state[0, i]) ** 2 + (st.rate * state[1, i]) ** 2
    return st.norm * math.sqrt(total)


@kernel
def _in_step(table, k, h):
    """Whether an undamped oscillator without load vibrates at the excitation frequency, and thus never
    decays.
    """
    still = table[k, D] == 0.0 and table[k, FC] == 0.0 and table[k, FS] == 0.0
    # its frequency equals r to rounding
    return still and abs(table[k, K] - h * h) <= 1e-15 * h * h


@kernel
def vibrates_in_step(st):
    """Whether a held oscillator vibrates at the excitation frequency undamped: the load in a stop then
    depends on the initial state.
    """
    found = False
    if st.held_block[STEADY] != 0.0:
        return found
    for k in range(st.m):
        found = found or _in_step(st.held, k, st.h)
    return found


@kernel
def held_period(st):
    """Load periods after which the load and all held oscillators repeat; infinite if they do not.

    A load that has not released the contact within this time never will.  `_largest_load_to_come` cannot show
    this, because it adds the amplitudes of the oscillators as if their maxima coincided.
    """
    for k in range(st.m):
        if st.held[k, D] != 0.0 or math.isinf(_steady(st.held, k, st.h)[0]):
            return math.inf
    for periods in range(1, _LONGEST_REPEAT + 1):
        repeats = True
        for k in range(st.m):
            turns = periods * math.sqrt(st.held[k, K]) / st.h
            # an integer, to the rounding of both frequencies
            repeats = repeats and abs(turns - math.floor(turns + 0.5)) <= 1e-15 * turns
        if repeats:
            return float(periods)
    return math.inf


@kernel
def _steady(table, k, h):
    """Phasor a of the steady response Re(a e^{i tau}) of an oscillator; infinite at an undamped resonance."""
    f_re, f_im = table[k, FC], -table[k, FS]
    if f_re == 0.0 and f_im == 0.0:
        return 0.0, 0.0
    d_re = table[k, K] - h * h
    d_im = h * table[k, D]
    size = d_re * d_re + d_im * d_im
    if size == 0.0:
        return math.inf, 0.0
    return (f_re * d_re + f_im * d_im) / size, (f_im * d_re - f_re * d_im) / size


@kernel
def _fill_steady(table, block):
    """Fill the steady response of the held oscillators into their block, unless one never decays."""
    m = table.shape[0] - 1
    width = padded(m)
    h = table[m, H]
    y_re, y_im = table[m, YC], -table[m, YS]
    for k in range(m):
        a_re, a_im = _steady(table, k, h)
        if math.isinf(a_re) or _in_step(table, k, h):
            return
        y_re += table[k, OZ] * a_re - table[k, OW] * h * a_im
        y_im += table[k, OZ] * a_im + table[k, OW] * h * a_re
        block[EQUATION + STEADY_RE * width + k] = a_re
        block[EQUATION + STEADY_IM * width + k] = a_im
        block[EQUATION + REACH * width + k] = _unit_energy_amplitude(table, k)
    block[STEADY_LOAD], block[STEADY] = math.hypot(y_re, y_im), 1.0


@kernel
def _unit_energy_amplitude(table, k):
    """Largest y of free motion of an oscillator of unit energy."""
    return math.sqrt(table[k, OZ] * table[k, OZ] / table[k, K] + table[k, OW] * table[k, OW])


@kernel
def _free_load(st, held, c, s):
    """Upper bound on the load in the contact of the remaining free motion, whose energy never grows."""
    block, width = st.held_block, padded(st.m)
    free = filled(0.0)
    for first in range(0, width, LANES):
        at = EQUATION + first
        a_re = load(block, at + STEADY_RE * width)
        a_im = load(block, at + STEADY_IM * width)
        z_off = load(held, first) - (c * a_re - s * a_im)
        w_off = load(held, held.shape[1] + first) + st.h * (s * a_re + c * a_im)
        energy = root(load(block, at + K * width) * z_off * z_off + w_off * w_off)
        free = free + load(block, at + REACH * width) * energy
    return total(free)


@kernel
def _largest_load_to_come(st, held, z, c, s):
    """Upper bound on the load in the contact as long as it is held; infinite at an undamped resonance."""
    if st.held_block[STEADY] != 0.0:
        return st.held_block[STEADY_LOAD] + abs(st.stiffness * z) + _free_load(st, held, c, s)
    y_re, y_im = st.held[st.m, YC], -st.held[st.m, YS]
    free = 0.0
    h = st.h
    table = st.held
    for k in range(st.m):
        # the steady response of the oscillator, and the remaining free motion
        a_re, a_im = _steady(table, k, h)
        if math.isinf(a_re):
            return math.inf
        if _in_step(table, k, h):
            a_re = held[0, k] * c - held[1, k] / h * s
            a_im = -held[0, k] * s - held[1, k] / h * c
        z_off = held[0, k] - (a_re * c - a_im * s)
        w_off = held[1, k] + h * (a_re * s + a_im * c)
        y_re += table[k, OZ] * a_re - table[k, OW] * h * a_im
        y_im += table[k, OZ] * a_im + table[k, OW] * h * a_re
        free += _unit_energy_amplitude(table, k) * math.sqrt(table[k, K] * z_off * z_off + w_off * w_off)
    return math.hypot(y_re, y_im) + abs(st.stiffness * z) + free


@kernel
def load_never_exceeds(st, held, z, c, s, most):
    """Whether the load in the contact, as long as it is held, is certain not to exceed `most` in size."""
    if st.held_block[STEADY] != 0.0 and st.held_block[STEADY_LOAD] > most:
        return False  # below beta_stick, where this part of the bound is too large already
    return _largest_load_to_come(st, held, z, c, s) <= most


@kernel
def release_steady(st, mu_beta, held, state):
    """Find the upward release of the contact from the steady response of the structure held at z = 0.

    Returns (whether it is released, cos, sin of the load phase); `state` becomes the free state there.
    """
    h = st.h
    table = st.held
    y_re, y_im = st.held[st.m, YC], -st.held[st.m, YS]
    for k in range(st.m):
        a_re, a_im = _steady(table, k, h)
        if math.isinf(a_re):
            return False, 1.0, 0.0
        y_re += table[k, OZ] * a_re - table[k, OW] * h * a_im
        y_im += table[k, OZ] * a_im + table[k, OW] * h * a_re
    most = math.hypot(y_re, y_im)
    if not most > mu_beta:
        return False, 1.0, 0.0
    # the load |Y| cos(tau + arg Y) falls through -mu beta
    tau = math.acos(-mu_beta / most) - math.atan2(y_im, y_re)
    c, s = math.cos(tau), math.sin(tau)
    for k in range(st.m):
        a_re, a_im = _steady(table, k, h)
        held[0, k] = a_re * c - a_im * s
        held[1, k] = -h * (a_re * s + a_im * c)
    release(st, held, 0.0, c, s, state)
    return True, c, s
