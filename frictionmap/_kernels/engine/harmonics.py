"""Exact harmonics of a steady state: those of friction from its segments, the others from the equations of
motion.

x_k = X_k0 + Re sum X_kn e^{i n tau}.  The response to friction is linear: the harmonics Q_n of the modes are
(delta_n1 lambda - chi F_n)/(w^2 - n^2 r^2 + 2 i zeta w n r).  Where this is 0/0, or close to it, because an
undamped mode resonates with the n-th harmonic, the mode itself is integrated.
"""

import cmath
import math
from typing import NamedTuple

import numpy as np

from ..compiler import entry, kernel
from ..structure.oscillators import F1, FC, FS, OW, OZ, YC, YS, D, K
from ..structure.state import DAMPING, PUSH, STATIC_SHAPE, W
from .periods import half_periods
from .segment_table import COS, LENGTH, SENSE, SIGN, SIN, STATE, STOP_Z
from .transforms import Driven, end_of, near_harmonic, transform


class Spectrum(NamedTuple):
    """Harmonics 0..N of a cell, and work arrays for them."""

    friction: np.ndarray  # (N + 1,) complex
    modes: np.ndarray  # (N + 1, n) complex
    near: np.ndarray  # (N + 1, n) bool, whether a mode is close to resonance and is integrated itself
    waves: np.ndarray  # (N + 2,) complex, integrals of e^{-i n theta} over a segment
    turns: np.ndarray  # (N + 2,) complex, e^{-i n theta} at its end
    parts: np.ndarray  # (2, n) complex, Fourier integrals of the held oscillators y and p
    ends: np.ndarray  # (2, n) state of the oscillators at its end, velocities in tau


@entry
def make_spectrum(st, harmonics):
    """Allocate the arrays for a number of harmonics, at least 1, of a structure at one frequency."""
    near = np.zeros((harmonics + 1, st.n), dtype=np.bool_)
    square = 1.0 / (st.h * st.h)
    for n in range(harmonics + 1):
        for i in range(st.n):
            near[n, i] = near_harmonic(st.free[i, K] * square, st.free[i, D] / st.h, n)
    return Spectrum(
        np.zeros(harmonics + 1, dtype=np.complex128), np.zeros((harmonics + 1, st.n), dtype=np.complex128),
        near, np.zeros(harmonics + 2, dtype=np.complex128), np.zeros(harmonics + 2, dtype=np.complex128),
        np.zeros((2, st.n), dtype=np.complex128), np.zeros((2, st.n)),
    )  # fmt: skip


@kernel
def _driven(st, table, i, n, friction, row):
    """Build the i-th of the n oscillators that move in a segment."""
    square = 1.0 / (st.h * st.h)
    phase = complex(row[COS], row[SIN])
    return Driven(
        table[i, K] * square, table[i, D] / st.h, complex(table[i, FC], -table[i, FS]) * square * phase,
        table[i, F1] * square * friction, row[STATE + i], row[STATE + n + i] / st.r,
    )  # fmt: skip


@kernel
def _wave(spectrum, m):
    """Integral of e^{-i m theta} over the segment; m may be -1."""
    return spectrum.waves[m] if m >= 0 else spectrum.waves[-m].conjugate()


@kernel
def _under_load(spectrum, force, constant, n):
    """Integral of (Re(force e^{i theta}) + constant) e^{-i n theta} over the segment."""
    swing = force * _wave(spectrum, n - 1) + force.conjugate() * _wave(spectrum, n + 1)
    return 0.5 * swing + constant * spectrum.waves[n]


@kernel
def _one_transform(o, spectrum, i, n, length):
    """Integrals of y e^{-i n theta} and of y' e^{-i n theta} over the segment for the i-th oscillator."""
    turn = spectrum.turns[n]
    change = spectrum.ends[0, i] * turn - o.y
    push = spectrum.ends[1, i] * turn - o.v
    drive = _under_load(spectrum, o.force, o.constant, n)
    moved = transform(o, float(n), length, change, push, drive)
    return moved, change + complex(0.0, n) * moved


@kernel
def _prepare_segment(st, row, oscillators, n, friction, spectrum):
    """Fill the arrays that all harmonics of a segment share, for its first n oscillators."""
    length = row[LENGTH]
    step = cmath.exp(complex(0.0, -length))
    spectrum.turns[0], spectrum.waves[0] = 1.0, length
    for m in range(1, spectrum.turns.size):
        turn = spectrum.turns[m - 1] * step
        spectrum.turns[m] = turn
        spectrum.waves[m] = complex(-turn.imag, turn.real - 1.0) / m
    for i in range(n):
        o = _driven(st, oscillators, i, n, friction, row)
        spectrum.ends[0, i], spectrum.ends[1, i] = end_of(o, length)


@kernel
def _add_slide(st, row, beta, near, spectrum):
    """Add a slide to the harmonics; `near`: whether any mode is integrated."""
    _prepare_segment(st, row, st.free, st.n if near else 0, beta, spectrum)
    sign, turn = row[SIGN], row[SIGN] * complex(row[COS], -row[SIN])
    factor = complex(sign, 0.0)
    for n in range(spectrum.friction.size):
        spectrum.friction[n] += factor * (beta * spectrum.waves[n])
        if near:
            for i in range(st.n):
                if spectrum.near[n, i]:
                    o = _driven(st, st.free, i, st.n, beta, row)
                    moved, _ = _one_transform(o, spectrum, i, n, row[LENGTH])
                    spectrum.modes[n, i] += factor * moved
        factor *= turn


@kernel
def _held_parts(st, row, phase, n, spectrum):
    """Fill the integrals of the held oscillators, and return that of the load in the contact."""
    shared = complex(st.held[st.m, YC], -st.held[st.m, YS]) * phase
    load = _under_load(spectrum, shared, st.stiffness * row[STOP_Z], n)
    for k in range(st.m):
        o = _driven(st, st.held, k, st.m, 0.0, row)
        moved, rate = _one_transform(o, spectrum, k, n, row[LENGTH])
        feedthrough = complex(st.held_feedthrough[0, k], -st.held_feedthrough[1, k]) * phase
        spectrum.parts[0, k] = moved
        spectrum.parts[1, k] = st.r * rate - _under_load(spectrum, feedthrough, 0.0, n)
        load += st.held[k, OZ] * moved + st.held[k, OW] * st.h * rate
    return load


@kernel
def _add_stop(st, row, near, spectrum):
    """Add a stop to the harmonics; in a stop the friction force balances the load in the contact."""
    _prepare_segment(st, row, st.held, st.m, 0.0, spectrum)
    phase = complex(row[COS], row[SIN])
    sign, turn = row[SIGN], row[SIGN] * phase.conjugate()
    factor = complex(sign, 0.0)
    for n in range(spectrum.friction.size):
        spectrum.friction[n] -= factor * _held_parts(st, row, phase, n, spectrum)
        if near:
            for i in range(st.n):
                if spectrum.near[n, i]:
                    moved = st.modes[STATIC_SHAPE, i] * row[STOP_Z] * spectrum.waves[n]
                    for k in range(st.m):
                        moved += st.into_free[k, i] * spectrum.parts[0, k]
                        moved += st.into_free[st.m + k, i] * spectrum.parts[1, k]
                    spectrum.modes[n, i] += factor * moved
        factor *= turn


@kernel
def _any_near_harmonic(spectrum):
    """Whether any mode is close to resonance with one of the harmonics."""
    found = False
    for n in range(spectrum.near.shape[0]):
        for i in range(spectrum.near.shape[1]):
            found = found or spectrum.near[n, i]
    return found


@kernel
def _modal_response(st, i, n, friction):
    """n-th harmonic of a mode under load and friction; 0 where the mode is not excited, even at resonance.

    An undamped mode excited at resonance has no bounded harmonic; callers treat that case themselves.
    """
    w, zeta = st.modes[W, i], st.modes[DAMPING, i]
    square = st.r * st.r / (st.h * st.h)
    force = -st.modes[PUSH, i] * friction
    if n == 1:
        force += complex(st.free[i, FC], -st.free[i, FS]) * square
    stiffness = complex((w - n * st.r) * (w + n * st.r), 2.0 * zeta * w * n * st.r)
    if force == 0.0 or stiffness == 0.0:
        return 0j
    return force / stiffness


@kernel
def harmonics_of_segments(st, beta, table, spectrum):
    """Fill the harmonics of the steady state of a segment table; return its duration in half periods."""
    near = _any_near_harmonic(spectrum)
    for n in range(spectrum.friction.size):
        spectrum.friction[n] = 0j
        for i in range(st.n):
            spectrum.modes[n, i] = 0j
    total = 0.0
    for k in range(table.shape[0]):
        total += table[k, LENGTH]
        if table[k, SENSE] > 0.0:
            _add_slide(st, table[k], beta, near, spectrum)
        else:
            _add_stop(st, table[k], near, spectrum)
    halves = half_periods(total)
    for n in range(spectrum.friction.size):
        scale = (1.0 if n == 0 else 2.0) / (math.pi * halves)
        if halves % 2 == 1 and n % 2 == 0:
            scale = 0.0  # the motion is antiperiodic: even harmonics vanish
        spectrum.friction[n] *= scale
        for i in range(st.n):
            if spectrum.near[n, i]:
                spectrum.modes[n, i] *= scale
            else:
                spectrum.modes[n, i] = _modal_response(st, i, n, spectrum.friction[n])
    return halves


@kernel
def harmonics_of_continuous(st, beta, phase, spectrum):
    """Fill the harmonics of the continuous orbit, whose friction is a square wave; `phase` is the load phase
    at a maximum of z.
    """
    turn = cmath.exp(complex(0.0, -phase))
    factor = complex(1.0, 0.0)
    for n in range(spectrum.friction.size):
        odd = n % 2 == 1
        spectrum.friction[n] = factor * complex(0.0, 4.0 * beta / (math.pi * n)) if odd else 0j
        for i in range(st.n):
            spectrum.modes[n, i] = _modal_response(st, i, n, spectrum.friction[n])
        factor *= turn
