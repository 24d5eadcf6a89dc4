"""Contacts whose normal force moves with the structure: no slip, steady sliding, flutter; closed forms.

    r^2 M x'' + r C x' + K x + c f + d (N - N0) = p,   N = N0 + k_n d.x,   |f| <= phi N

x is measured from the preloaded equilibrium, and d.x > 0 presses.  What follows holds while N > 0; motions
that separate are not followed here, nor by the kernels.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from .held import largest
from .slopes import POLISHED, REAL, finite_zeros, first_order, rates_with

#: Growth below this share of the fastest rate is rounding: eigenvalues are compared between candidates, where
#: they are simple.
_ROUNDING = 1e-9


class Structure(NamedTuple):
    """Mass, damping and stiffness, (n, n), over the units of the load."""

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray


class NormalSpring(NamedTuple):
    """Directions of the friction and of the normal force, (n,), and the stiffness k_n > 0 of the latter."""

    friction: np.ndarray
    normal: np.ndarray
    stiffness: float


def _pressed(structure: Structure, contact: NormalSpring) -> np.ndarray:
    """Stiffness of the closed contact without friction, K + k_n d d^T."""
    return structure.stiffness + contact.stiffness * np.outer(contact.normal, contact.normal)


def coupling(structure: Structure, contact: NormalSpring) -> float:
    """Change of the normal force per constant friction force, eta = -k_n d.(K + k_n d d^T)^-1 c."""
    moved = np.linalg.solve(_pressed(structure, contact), contact.friction)
    return float(-contact.stiffness * contact.normal @ moved)


def locks_itself(structure: Structure, contact: NormalSpring, phi: float) -> bool:
    """Whether a constant force in the contact can hold any load: |phi eta| >= 1."""
    return abs(phi * coupling(structure, contact)) >= 1.0


def _held_phasors(
    structure: Structure, contact: NormalSpring, spring: float | None, r: float, order: int, load: np.ndarray
) -> tuple[complex, complex]:
    """Friction force and change of the normal force under a harmonic, in a contact that does not slip."""
    c, rate = contact.friction, order * r
    matrix = _pressed(structure, contact) - rate**2 * structure.mass + 1j * rate * structure.damping
    if spring is None:
        bordered = np.block([[matrix, c[:, np.newaxis]], [c[np.newaxis], np.zeros((1, 1))]])
        found = np.linalg.solve(bordered, np.append(load, 0.0))
        x, force = found[:-1], found[-1]
    else:
        x = np.linalg.solve(matrix + spring * np.outer(c, c), load)
        force = spring * (c @ x)
    return complex(force), complex(contact.stiffness * (contact.normal @ x))


def no_slip_preload(
    structure: Structure, contact: NormalSpring, phi: float, r: float, loads: Mapping[int, np.ndarray],
    spring: float | None = None,
) -> float:  # fmt: skip
    """Least normal force at rest with which a contact never slips; it does not separate either.

    Of the forces F + g that hold the contact the constant g is free, and changes the normal force by eta g.
    One is within the limits iff

        2 phi N0 >= (1 + phi eta) max(F - phi N1) - (1 - phi eta) min(F + phi N1)

    Parameters
    ----------
    structure, contact : Structure, NormalSpring
    phi : friction coefficient at rest, mu phi of a rigid contact
    r : frequency ratio
    loads : phasors (n,) of the load by their order >= 1
    spring : stiffness in series with the slider; None: rigid

    Returns
    -------
    float : 0 where the contact locks itself
    """
    if locks_itself(structure, contact, phi):
        return 0.0
    eta = coupling(structure, contact)
    orders = np.array(sorted(loads), dtype=float)
    both = np.array([_held_phasors(structure, contact, spring, r, n, loads[n]) for n in sorted(loads)])
    force, normal = both[:, 0], both[:, 1]
    above, below = largest(orders, force - phi * normal), largest(orders, -force - phi * normal)
    return float((1.0 + phi * eta) * above + (1.0 - phi * eta) * below) / (2.0 * phi)


def sliding_stiffness(structure: Structure, contact: NormalSpring, phi: float, sense: int) -> np.ndarray:
    """Stiffness in a slide of the sense s, K + k_n (d + s phi c) d^T: not symmetric."""
    push = contact.normal + sense * phi * contact.friction
    return structure.stiffness + contact.stiffness * np.outer(push, contact.normal)


class SteadySliding(NamedTuple):
    """Equilibrium on a belt."""

    place: np.ndarray  # (n,) x; NaN where there is none
    normal_force: float  # N; <= 0: the contact opens, and this is no equilibrium
    growth: float  # largest real part of the roots, over omega_1; > 0: unstable
    frequency: float  # its imaginary part


def steady_sliding(
    structure: Structure, contact: NormalSpring, phi: float, sense: int, preload: float
) -> SteadySliding:
    """Steady sliding on a belt, K_s x = -s phi N0 c, and the roots of l^2 M + l C + K_s.

    Parameters
    ----------
    structure, contact, phi : Structure, NormalSpring, friction coefficient
    sense : of the slide, that of the contact relative to the belt: 1 or -1
    preload : normal force at rest, N0 > 0
    """
    stiffness = sliding_stiffness(structure, contact, phi, sense)
    roots = _roots(structure, stiffness)
    worst = roots[np.lexsort((roots.imag, roots.real))[-1]]
    try:
        place = np.linalg.solve(stiffness, -sense * phi * preload * contact.friction)
    except np.linalg.LinAlgError:
        place = np.full(contact.normal.size, np.nan)
    pressed = preload + contact.stiffness * float(contact.normal @ place)
    return SteadySliding(place, pressed, float(worst.real), float(worst.imag))


def _roots(structure: Structure, stiffness: np.ndarray) -> np.ndarray:
    """Roots l of l^2 M + l C + K, (2 n,)."""
    if not structure.damping.any():  # from l^2: pairs without real parts keep none
        squares = np.linalg.eigvals(-np.linalg.inv(structure.mass) @ stiffness).astype(complex)
        return np.concatenate((np.sqrt(squares), -np.sqrt(squares)))
    return np.linalg.eigvals(first_order(structure.mass, structure.damping, stiffness)).astype(complex)


class Limit(NamedTuple):
    """The least friction coefficient at which steady sliding is unstable."""

    phi: float  # inf: it never is
    kind: str  # "flutter", or "divergence": the contact locks itself; "" without a limit


def sliding_limit(structure: Structure, contact: NormalSpring, sense: int) -> Limit:
    """Least phi > 0 above which steady sliding of the sense s is unstable.

    A root crosses the imaginary axis at i o where phi = -s/(k_n d.Z^-1 c) is real, Z = K + k_n d d^T - o^2 M
    + i o C; without damping two of them meet there, where phi has an extreme over o^2.  Between these values
    the number of unstable roots does not change.
    """
    divergence = sense / coupling(structure, contact) if coupling(structure, contact) != 0.0 else np.inf
    if structure.damping.any():
        found = _crossings(structure, contact, sense)
    else:
        found = _meetings(structure, contact, sense)
    candidates = np.unique([phi for phi in (*found, divergence) if 0.0 < phi < np.inf])
    for k, phi in enumerate(candidates):
        beyond = 0.5 * (phi + candidates[k + 1]) if k + 1 < candidates.size else 2.0 * phi
        roots = _roots(structure, sliding_stiffness(structure, contact, beyond, sense))
        if roots.real.max() > _ROUNDING * np.abs(roots).max():
            return Limit(float(phi), "divergence" if phi == divergence else "flutter")
    return Limit(np.inf, "")


def _crossings(structure: Structure, contact: NormalSpring, sense: int) -> list[float]:
    """phi at which a root may cross the imaginary axis, damped: where G(i o) = d.Z^-1 c is real."""
    n, c, d = contact.normal.size, contact.friction, contact.normal
    inverse, pressed = np.linalg.inv(structure.mass), _pressed(structure, contact)
    b, out = np.concatenate((np.zeros(n), inverse @ c)), np.concatenate((d, np.zeros(n)))
    found = []
    for o in rates_with(first_order(structure.mass, structure.damping, pressed), b, out, -1.0):
        for _ in range(POLISHED):
            value, slope = _response(structure, pressed, contact, o)
            o -= value.imag / slope.imag if slope.imag != 0.0 else 0.0
        value, _ = _response(structure, pressed, contact, o)
        found.append(-sense / (contact.stiffness * value.real))
    return found


def _response(
    structure: Structure, pressed: np.ndarray, contact: NormalSpring, o: float
) -> tuple[complex, complex]:
    """G(i o) = d.Z^-1 c and its derivative by o."""
    matrix = pressed - o * o * structure.mass + 1j * o * structure.damping
    x = np.linalg.solve(matrix, contact.friction.astype(complex))
    y = np.linalg.solve(matrix.T, contact.normal.astype(complex))
    slope = -y @ (-2.0 * o * structure.mass + 1j * structure.damping) @ x
    return complex(contact.normal @ x), complex(slope)


def _meetings(structure: Structure, contact: NormalSpring, sense: int) -> list[float]:
    """phi at which two roots meet, undamped: zeros of the derivative of h(s) = d.(K' - s M)^-1 c, s = o^2."""
    n, c, d = contact.normal.size, contact.friction, contact.normal
    pressed, mass = _pressed(structure, contact), structure.mass
    none = np.zeros((n, n))
    pencil = np.block(
        [
            [pressed, none, c[:, np.newaxis]],
            [-mass, pressed, np.zeros((n, 1))],
            [np.zeros((1, n)), d[np.newaxis], np.zeros((1, 1))],
        ]
    )
    shift = np.block(
        [
            [mass, none, np.zeros((n, 1))],
            [none, mass, np.zeros((n, 1))],
            [np.zeros((1, 2 * n + 1))],
        ]
    )
    found = []
    for zero in finite_zeros(pencil, shift):
        if abs(zero.imag) <= REAL * abs(zero):
            s = float(zero.real)
            for _ in range(POLISHED):
                x = np.linalg.solve(pressed - s * mass, c)
                once = np.linalg.solve(pressed - s * mass, mass @ x)
                twice = np.linalg.solve(pressed - s * mass, mass @ once)
                bend = 2.0 * float(d @ twice)
                s -= float(d @ once) / bend if bend != 0.0 else 0.0
            value = float(d @ np.linalg.solve(pressed - s * mass, c))
            if value != 0.0:
                found.append(-sense / (contact.stiffness * value))
    return found
