"""Modes of a structure, participation of contact and load, and the structure with its contact held.

Everything is dimensionless, as in theory.md 1.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .balance import Body, Polynomial, contact_responses, dynamic_stiffness, held_motions
from .free_structure import FreeStructure, modal_structure

_EPS = float(np.finfo(float).eps)

#: An eigen-solver's squared frequencies are off by up to 3 sqrt(n) eps times the largest of them (seen over
#: structures with repeated frequencies and spreads of up to 10^8).  Two that differ by less than this times
#: sqrt(n) eps are one to it, and it returns an arbitrary mix of their modes.
_SAME_FREQUENCY = 8.0

#: Computed modes are orthonormal to a few n eps.  A product with them that vanishes comes out as such a
#: multiple of the most that it could be; this times n eps of it is above the rounding, and nothing that
#: double precision could tell from zero is lost.
ZERO_PRODUCT = 64.0


def _merge_equal(squares: np.ndarray, rounding: np.ndarray) -> np.ndarray:
    """Increasing squared frequencies, those made equal to the bit that `rounding` (n,) alone tells apart."""
    first_of_group = np.concatenate(([True], np.diff(squares) > rounding[1:]))
    group = np.cumsum(first_of_group) - 1
    means = np.bincount(group, weights=squares) / np.bincount(group)
    return np.where(np.bincount(group)[group] > 1, means[group], squares)


def solve_modes(mass: np.ndarray, stiffness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Natural frequencies w (n,), increasing, and modes phi (n, n), one a column, with phi^T M phi = 1.

    Frequencies that rounding alone tells apart are made equal to the bit.
    """
    if mass.shape == (1, 1):
        return np.sqrt(stiffness[0] / mass[0]), 1.0 / np.sqrt(mass)
    from scipy.linalg import eigh  # not needed, and not loaded, for one mass

    squares, phi = eigh(stiffness, mass)
    gap = _SAME_FREQUENCY * np.sqrt(squares.size) * _EPS * squares[-1]
    squares = _merge_equal(squares, np.full(squares.size, gap))
    return np.sqrt(np.maximum(squares, 0.0)), phi  # rounding may make one negative


def solve_chain_modes(masses: np.ndarray, springs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same of a chain, each frequency to rounding of its own however far apart masses or springs are.

    K = B^T diag(springs) B with the stretches B x = x_i - x_{i-1}: frequencies are the singular values of the
    bidiagonal sqrt(springs) B / sqrt(masses), which QR iteration (gesvd) finds to high relative accuracy.  K
    itself, whose entries are sums, has lost the digits of a soft spring beside a stiff one.
    """
    from scipy.linalg import svd

    root = np.sqrt(masses)
    stretches = np.diag(np.sqrt(springs) / root) - np.diag(np.sqrt(springs[1:]) / root[:-1], 1)  # transposed
    shapes, w, _ = svd(stretches, lapack_driver="gesvd")
    squares = w[::-1] ** 2
    equal = _merge_equal(squares, _SAME_FREQUENCY * np.sqrt(w.size) * _EPS * squares)
    # the square root of an untouched square would round twice
    w = np.where(equal == squares, w[::-1], np.sqrt(equal))
    return w, np.ascontiguousarray((shapes / root[:, np.newaxis])[:, ::-1])


def modal_damping(mass: np.ndarray, w: np.ndarray, phi: np.ndarray, zeta: np.ndarray) -> np.ndarray:
    """The matrix C1 with phi^T C1 phi = diag(2 zeta w)."""
    shaped = mass @ phi
    return (shaped * (2.0 * zeta * w)) @ shaped.T


def load_rate(damping: np.ndarray, to_base: bool) -> np.ndarray:
    """What the load has that grows with i r, complex (n,): C1 ones if the damping ends at a moving base."""
    rate = damping.sum(axis=1) if to_base else np.zeros(len(damping))
    return rate.astype(complex)


def damped_modes(damping: np.ndarray, w: np.ndarray, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Damping ratios and modes of a structure with the damping matrix C1.

    Returns
    -------
    zeta : (n,) from the diagonal of phi^T C1 phi = 2 zeta w
    phi : (n, n) the modes, turned among those of one frequency so that they diagonalise C1
    coupling : largest |(phi^T C1 phi)_ij| off the diagonal over sqrt(its ii times its jj), rounding left out
    """
    n = w.size
    phi = phi.copy()
    for value in np.unique(w):
        group = np.flatnonzero(w == value)
        if group.size > 1:
            part = phi[:, group]
            phi[:, group] = part @ np.linalg.eigh(part.T @ damping @ part)[1]
    product = phi.T @ damping @ phi
    rates = np.diag(product).copy()
    rounding = ZERO_PRODUCT * n * _EPS * rates.max(initial=0.0)
    rates[rates <= rounding] = 0.0
    for i in range(1, n):  # equal to rounding: made equal, so that the contact can turn these modes
        if w[i] == w[i - 1] and abs(rates[i] - rates[i - 1]) <= rounding:
            rates[i] = rates[i - 1]
    size = np.sqrt(np.outer(rates, rates))
    beyond = np.abs(product - np.diag(np.diag(product))) - rounding
    coupling = np.divide(beyond, size, out=np.where(beyond > 0.0, np.inf, 0.0), where=size > 0.0)
    return rates / (2.0 * w), phi, float(coupling.max(initial=0.0))


def align_with_contact(w: np.ndarray, zeta: np.ndarray, phi: np.ndarray, contact: np.ndarray) -> np.ndarray:
    """Modes turned among those of one frequency and damping so that the contact sees one of them only.

    Any basis of such a group is as good: with this one the group has one pole, and the others none.
    """
    phi = phi.copy()
    for value in np.unique(np.column_stack((w, zeta)), axis=0):
        group = np.flatnonzero((w == value[0]) & (zeta == value[1]))
        if group.size > 1:
            part = phi[:, group]
            # the first column of the orthogonal factor lies along chi, the others across it
            turn = np.linalg.qr((contact @ part)[:, np.newaxis], mode="complete")[0]
            phi[:, group] = part @ turn
    return phi


def modulus(values: np.ndarray) -> np.ndarray:
    """Moduli of complex numbers, each as if it were alone, as `times`."""
    return np.hypot(values.real, values.imag)


def angles(values: np.ndarray) -> np.ndarray:
    """Arguments of complex numbers (n_r,), each as if it were alone, as `times`."""
    return np.array([math.atan2(value.imag, value.real) for value in values])


def wrapped(angle: np.ndarray | float) -> np.ndarray:
    """Angles in (-pi, pi], by whole turns."""
    return angle - math.tau * np.ceil((angle - math.pi) / math.tau)


def times(rows: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Complex rows (n_r, n) times a real matrix (n, k); every row as if it were alone.

    A matrix product by a library rounds a row by its place among the others, and so may complex arithmetic
    on arrays; real arithmetic, number by number, does not.
    """
    total = np.zeros((rows.shape[0], matrix.shape[1]), dtype=complex)
    for column, row in zip(rows.T, matrix, strict=True):
        total.real += column.real[:, np.newaxis] * row
        total.imag += column.imag[:, np.newaxis] * row
    return total


def _rows(polynomial: Polynomial, r: np.ndarray) -> np.ndarray:
    """Its values at r, complex (n_r, n)."""
    return polynomial.at(np.asarray(r, dtype=float)).rows()


def _weighted(parts: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Complex parts (n_r, n) times real weights (n,); every row as if it were alone, as `times`."""
    found = np.empty_like(parts)
    found.real, found.imag = parts.real * weights, parts.imag * weights
    return found


def _modal_sum(stiffness: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Sum over modes of parts/stiffness, both (n_r, n); infinite at a resonance with a part."""
    resonant = (stiffness == 0.0) & (parts != 0.0)
    terms = np.where(parts != 0.0, parts, 0.0) / np.where(stiffness == 0.0, 1.0, stiffness)
    return np.where(resonant.any(axis=1), np.inf, np.where(resonant, 0.0, terms).sum(axis=1))


def weighted_sum(responses: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Sum over modes of answers (n_r, n) by weights (n,); infinite where one that has a weight is."""
    infinite = np.isinf(responses)
    total = times(np.where(infinite, 0.0, responses), weights[:, np.newaxis])[:, 0]
    return np.where((infinite & (weights != 0.0)).any(axis=1), np.inf, total)


def _held_squares(mass: np.ndarray, stiffness: np.ndarray, contact: np.ndarray) -> np.ndarray:
    """Squared natural frequencies of the undamped structure with c.x = 0 held, (n - 1,)."""
    if contact.size == 1:
        return np.empty(0)
    from scipy.linalg import eigh

    # an orthonormal basis of the motions that leave the contact alone
    basis = np.linalg.svd(contact[np.newaxis])[2][1:].T
    return eigh(basis.T @ stiffness @ basis, basis.T @ mass @ basis, eigvals_only=True)


def _solve_unexcited_resonance(
    bordered: np.ndarray, mass: np.ndarray, right: np.ndarray
) -> np.ndarray | None:
    """Solution of equations that rounding alone keeps from being singular, if the load feeds no resonance.

    It is the limit, in which the resonant motions are absent: what remains is orthogonal to them with
    respect to the mass.  None if the load feeds them.
    """
    rounding = ZERO_PRODUCT * right.size * _EPS
    left, sizes, rows = np.linalg.svd(bordered)
    kept = sizes > rounding * sizes[0]
    along = left.conj().T @ right
    if np.any(np.abs(along[~kept]) > rounding * np.linalg.norm(right)):
        return None
    solution = rows[kept].conj().T @ (along[kept] / sizes[kept])
    resonant = rows[~kept].conj().T
    shape = mass @ resonant[:-1]
    amounts = np.linalg.solve(shape.conj().T @ resonant[:-1], shape.conj().T @ solution[:-1])
    return solution - resonant @ amounts


def solve_held(
    mass: np.ndarray,
    stiffness: np.ndarray,
    damping: np.ndarray,
    contact: np.ndarray,
    r: np.ndarray,
    load: np.ndarray,
) -> np.ndarray:
    """The motion with c.x = 0 and the force that holds it, (n_r, n + 1), at resonances of the held structure.

    `load` is (n_r, n).  Infinite, all of it, where the load feeds the resonance.
    """
    n = contact.size
    bordered = np.zeros((n + 1, n + 1), dtype=complex)
    # the border in the size of the rest (a power of two rounds nothing): else the units of the structure
    # would decide what is singular
    size = 2.0 ** np.round(np.log2(np.abs(stiffness).max()))
    bordered[:n, n] = size * contact
    bordered[n, :n] = size * contact
    units = np.append(np.ones(n), size)
    held = np.empty((r.size, n + 1), dtype=complex)
    for k, at in enumerate(r):
        bordered[:n, :n] = stiffness - at**2 * mass + 1j * at * damping
        right = np.append(load[k], 0.0)
        solution = _solve_unexcited_resonance(bordered, mass, right)
        if solution is None:
            try:
                solution = np.linalg.solve(bordered, right)
            except np.linalg.LinAlgError:
                solution = np.full(n + 1, np.inf)
        held[k] = units * solution
    return held


@dataclass(frozen=True)
class ModalModel:
    """A structure in its modes; it depends on r through functions of r only (theory.md 1).

    Attributes
    ----------
    w, zeta : (n,) natural frequencies, in the unit of r, and damping ratios
    phi : (n, n) modes, one a column, with phi^T M phi = 1
    contact : (n,) c
    load, load_rate : (n,) complex; the load's phasor is p(r) = load + i r load_rate
    base_motion : s; if it is 1, load = K ones, and load_rate is zero or C1 ones
    mass, stiffness, damping : (n, n) M/r^2, K and C1 = C/r
    springs : (n,) of a chain, spring i between masses i - 1 and i; else None
    """

    w: np.ndarray
    phi: np.ndarray
    zeta: np.ndarray
    contact: np.ndarray
    load: np.ndarray
    load_rate: np.ndarray
    base_motion: int
    mass: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    springs: np.ndarray | None = None

    def _participation_factors(self, vector: np.ndarray) -> np.ndarray:
        """vector.phi_i (n,), exactly zero where it is zero but for rounding.

        |v.phi_i| <= sqrt(v^T M^-1 v) by Cauchy and Schwarz, as phi_i^T M phi_i = 1.  Left as they are, the
        1e-17 of an eigen-solver would give U, or V, a pole of a mode that the contact, or the load, does
        not touch.
        """
        shares = vector @ self.phi
        most = np.sqrt(np.real(np.conj(vector) @ np.linalg.solve(self.mass, vector)))
        return np.where(np.abs(shares) <= ZERO_PRODUCT * self.w.size * _EPS * most, 0.0, shares)

    @cached_property
    def chi(self) -> np.ndarray:
        """Participation of the contact, c.phi_i (n,); exactly 0 in modes that the contact does not see."""
        return self._participation_factors(self.contact)

    @property
    def participating(self) -> np.ndarray:
        """Modes that the contact sees, bool (n,)."""
        return self.chi != 0.0

    @property
    def coupled_modes(self) -> np.ndarray:
        """Modes that the damping couples to others, bool (n,)."""
        return np.zeros(self.w.size, dtype=bool)

    def participating_coupling(self) -> np.ndarray | None:
        """What the damping has between the modes that the contact sees; None: nothing."""
        return None

    @cached_property
    def free(self) -> FreeStructure:
        """The modes that the contact sees as oscillators."""
        which = self.participating
        return modal_structure(self.w[which], self.zeta[which], self.chi[which])

    @cached_property
    def _load_participation(self) -> Polynomial:
        """Participation of load, of load_rate, and of nothing that grows with r^2."""
        return Polynomial(
            self._participation_factors(self.load),
            self._participation_factors(self.load_rate),
            np.zeros(self.w.size),
        )

    @cached_property
    def _relative(self) -> Polynomial:
        """`relative_load` in its parts: constant, times i r, times r^2; complex (n,) each."""
        nothing = np.zeros(self.w.size, dtype=complex)
        if not self.base_motion:
            return Polynomial(self.load.astype(complex), self.load_rate.astype(complex), nothing)
        ones = np.ones(self.w.size)
        return Polynomial(nothing, self.load_rate - self.damping @ ones, (self.mass @ ones).astype(complex))

    @cached_property
    def _relative_participation(self) -> Polynomial:
        """Participation of these parts."""
        return Polynomial(*(self._participation_factors(part).astype(complex) for part in self._relative))

    @cached_property
    def _body(self) -> Body:
        """The structure in the numbers that its balance takes."""
        return Body(
            self.w, self.zeta, self.phi, self.chi, self.contact, self.mass, self.stiffness, self.springs,
            self.mass @ self.phi, self._relative, self._relative_participation,
            ZERO_PRODUCT * _EPS,
        )  # fmt: skip

    @cached_property
    def inverse_mass(self) -> float:
        """1/m_eff of the contact."""
        return float(self.contact @ np.linalg.solve(self.mass, self.contact))

    def contact_acceleration(self, load: np.ndarray) -> complex:
        """c^T M^-1 load, acceleration in the contact by a load (n,); exactly 0 where it is but rounding."""
        across = np.linalg.solve(self.mass, load)
        most = np.sqrt(self.inverse_mass * np.real(np.conj(load) @ across))  # by Cauchy and Schwarz
        value = complex(self.contact @ across)
        return 0.0 if abs(value) <= ZERO_PRODUCT * self.w.size * _EPS * most else value

    def participation(self, r: np.ndarray) -> np.ndarray:
        """Participation of the load, lambda_i = p(r).phi_i, complex (n_r, n)."""
        return _rows(self._load_participation, r)

    def total_load(self, r: np.ndarray) -> np.ndarray:
        """Phasor p(r) of the load on the masses, (n_r, n)."""
        return _rows(Polynomial(self.load, self.load_rate, np.zeros(self.w.size)), r)

    def relative_load(self, r: np.ndarray) -> np.ndarray:
        """Phasor of the load on x - s, which is x as seen from the contact's other side, (n_r, n).

        With base motion p - (K - r^2 M + i r C1) ones = r^2 M ones + i r (load_rate - C1 ones), without
        the difference of nearly equal numbers that p - K ones would be; else p.
        """
        return _rows(self._relative, r)

    def relative_participation(self, r: np.ndarray) -> np.ndarray:
        """relative_load(r).phi_i, (n_r, n)."""
        return _rows(self._relative_participation, r)

    def dynamic_stiffness(self, r: np.ndarray) -> np.ndarray:
        """w_i^2 - r^2 + 2 i zeta_i w_i r, shape (n_r, n), without cancellation at resonance.

        Of each mode by itself: what couples it to others is not in it.
        """
        return dynamic_stiffness(self.w, self.zeta, np.asarray(r, dtype=float)).rows()

    def modal_responses(self, r: np.ndarray, loads: np.ndarray) -> np.ndarray:
        """Coordinates of the modes under loads on them, (n_r, n) both; infinite at an undamped resonance."""
        stiffness = self.dynamic_stiffness(r)
        resonant = stiffness == 0.0
        found = np.where(resonant, 0.0, loads) / np.where(resonant, 1.0, stiffness)
        return np.where(resonant & (loads != 0.0), np.inf, found)

    def damping_form(self, q: np.ndarray) -> np.ndarray:
        """q^H C q of phasors of the modes (n_r, n), with the damping between them; (n_r,)."""
        return (2.0 * self.zeta * self.w * modulus(q) ** 2).sum(axis=1)

    def response(self, r: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """sum_i weights_i lambda_i/(w_i^2 - r^2 + 2 i zeta_i w_i r), complex (n_r,).

        V_k of a mass with weights phi[k].  Infinite at an undamped resonance that is loaded and weighted.
        """
        return _modal_sum(self.dynamic_stiffness(r), _weighted(self.participation(r), weights))

    def mass_responses(self, r: np.ndarray) -> np.ndarray:
        """V_k, displacements without friction, complex (n_r, n); infinite as `response`."""
        return np.column_stack([self.response(r, row) for row in self.phi])

    def contact_response(self, r: np.ndarray) -> np.ndarray:
        """V of theory.md 2, the response function of z, complex (n_r,); infinite as `response`.

        It is response(r, chi) - s, without the loss of digits that the difference would have at small r.
        """
        return contact_responses(np.asarray(r, dtype=float), self._body)

    def held(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """x - s (n_r, n) and F (n_r,) with the contact held, theory.md 4.

        Infinite, all of it, where the load feeds an undamped resonance of the held structure.  Modes that
        the contact does not see move as if free and leave F alone: taken out of the equations they cannot
        make them singular.
        """
        r = np.asarray(r, dtype=float)
        participating = self.chi != 0.0
        found, force, singular = held_motions(r, self._body)
        at = np.flatnonzero(singular)
        if participating.all():
            load = self.relative_load(r[at])
            solved = solve_held(self.mass, self.stiffness, self.damping, self.contact, r[at], load)
            found[at], force[at] = solved[:, :-1], solved[:, -1]
            return found, force
        w, zeta, chi = self.w[participating], self.zeta[participating], self.chi[participating]
        parts = self.relative_participation(r)
        solved = solve_held(
            np.eye(w.size),
            np.diag(w**2),
            np.diag(2.0 * zeta * w),
            chi,
            r[at],
            parts[np.ix_(at, participating)],
        )
        found[np.ix_(at, participating)], force[at] = solved[:, :-1], solved[:, -1]
        return self._displacements(r, parts, found, participating, np.isinf(force)), force

    def _displacements(
        self, r: np.ndarray, parts: np.ndarray, q: np.ndarray, participating: np.ndarray, resonant: np.ndarray
    ) -> np.ndarray:
        """Displacements (n_r, n) of participating modes q and of the others, which `parts` move freely."""
        stiffness = self.dynamic_stiffness(r)
        free = np.where(participating, 0.0, parts)
        motion = np.column_stack([_modal_sum(stiffness, _weighted(free, row)) for row in self.phi])
        motion += times(
            np.where(resonant[:, np.newaxis], 0.0, q)[:, participating], self.phi[:, participating].T
        )
        motion[resonant] = np.inf
        return motion

    def static_response(self) -> np.ndarray:
        """Displacements of the masses without friction at r = 0, complex (n,)."""
        return np.linalg.solve(self.stiffness, self.load)

    def held_load(self, r: np.ndarray) -> np.ndarray:
        """Phasor F of the force that holds the contact at z' = 0, theory.md 4; complex (n_r,).

        Infinite where the load feeds an undamped resonance of the held structure.
        """
        return self.held(r)[1]

    def held_response(self, r: np.ndarray) -> np.ndarray:
        """Phasors X of the displacements of all masses with the contact held, theory.md 4; (n_r, n).

        Infinite where the load feeds an undamped resonance of the held structure.
        """
        return self.held(r)[0] + self.base_motion

    def held_at_rest(self) -> np.ndarray:
        """Masses that no load moves with the contact held, bool (n,).

        The one that a fixed wall holds, and those that are tied to the load through it only.
        """
        if self.base_motion or np.count_nonzero(self.contact) > 1:
            return np.zeros(self.w.size, dtype=bool)
        free = self.contact == 0.0
        tied = (self.stiffness != 0.0) | (self.mass != 0.0) | (self.damping != 0.0)
        moved = free & ((self.load != 0.0) | (self.load_rate != 0.0))
        for _ in range(self.w.size):  # from mass to mass, away from the load
            moved |= free & tied @ moved
        return ~moved

    def held_frequencies(self) -> np.ndarray:
        """Natural frequencies of the undamped structure with its contact held, shape (n - 1,)."""
        return np.sqrt(_held_squares(self.mass, self.stiffness, self.contact))
