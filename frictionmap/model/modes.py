"""Modes of a structure, participation factors of contact and load, and the structure with its contact held.

All quantities are dimensionless, as in theory.md 1.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .balance import Body, Polynomial, contact_responses, dynamic_stiffness, held_motions
from .free_structure import FreeStructure, modal_structure

_EPS = float(np.finfo(float).eps)

#: Squared frequencies from an eigenvalue solver have errors of up to 3 sqrt(n) eps times the largest of them
#: (observed for structures with repeated frequencies and spreads of up to 10^8).  Two that differ by less
#: than this factor times sqrt(n) eps are not resolved, and the solver returns an arbitrary mix of their
#: modes.
_SAME_FREQUENCY = 8.0

#: Computed modes are orthonormal to a few n eps, so a product with them that vanishes is computed as a few n
#: eps of its upper bound.  Products below this factor times n eps of the bound are set to zero; no product
#: that double precision resolves is lost.
ZERO_PRODUCT = 64.0


def _merge_equal(squares: np.ndarray, rounding: np.ndarray) -> np.ndarray:
    """Replace increasing squared frequencies that differ by no more than `rounding` (n,) by their mean."""
    first_of_group = np.concatenate(([True], np.diff(squares) > rounding[1:]))
    group = np.cumsum(first_of_group) - 1
    means = np.bincount(group, weights=squares) / np.bincount(group)
    return np.where(np.bincount(group)[group] > 1, means[group], squares)


def solve_modes(mass: np.ndarray, stiffness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Solve for the natural frequencies w (n,), increasing, and the modes phi (n, n), in columns, with phi^T
    M phi = 1.

    Frequencies that differ by rounding error only are made equal to the bit.
    """
    if mass.shape == (1, 1):
        return np.sqrt(stiffness[0] / mass[0]), 1.0 / np.sqrt(mass)
    from scipy.linalg import eigh  # not needed, and not loaded, for one mass

    squares, phi = eigh(stiffness, mass)
    gap = _SAME_FREQUENCY * np.sqrt(squares.size) * _EPS * squares[-1]
    squares = _merge_equal(squares, np.full(squares.size, gap))
    return np.sqrt(np.maximum(squares, 0.0)), phi  # rounding may make one negative


def solve_chain_modes(masses: np.ndarray, springs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Solve for frequencies and modes of a chain, each frequency with full relative accuracy.

    K = B^T diag(springs) B with the stretches B x = x_i - x_{i-1}: the frequencies are the singular values of
    the bidiagonal sqrt(springs) B / sqrt(masses), which QR iteration (gesvd) finds to high relative accuracy
    for any ratio of masses or springs.  The entries of K are sums, in which the digits of a soft spring next
    to a stiff one are lost.
    """
    from scipy.linalg import svd

    root = np.sqrt(masses)
    stretches = np.diag(np.sqrt(springs) / root) - np.diag(np.sqrt(springs[1:]) / root[:-1], 1)  # transposed
    shapes, w, _ = svd(stretches, lapack_driver="gesvd")
    squares = w[::-1] ** 2
    equal = _merge_equal(squares, _SAME_FREQUENCY * np.sqrt(w.size) * _EPS * squares)
    # the square root of an unchanged square would round twice
    w = np.where(equal == squares, w[::-1], np.sqrt(equal))
    return w, np.ascontiguousarray((shapes / root[:, np.newaxis])[:, ::-1])


def modal_damping(mass: np.ndarray, w: np.ndarray, phi: np.ndarray, zeta: np.ndarray) -> np.ndarray:
    """Matrix C1 with phi^T C1 phi = diag(2 zeta w)."""
    shaped = mass @ phi
    return (shaped * (2.0 * zeta * w)) @ shaped.T


def load_rate(damping: np.ndarray, to_base: bool) -> np.ndarray:
    """Part of the load that is proportional to i r, complex (n,): C1 ones for dashpots that end at a moving
    base.
    """
    rate = damping.sum(axis=1) if to_base else np.zeros(len(damping))
    return rate.astype(complex)


def damped_modes(damping: np.ndarray, w: np.ndarray, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Damping ratios and modes of a structure with the damping matrix C1.

    Returns
    -------
    zeta : (n,) from the diagonal of phi^T C1 phi = 2 zeta w
    phi : (n, n) the modes; modes of equal frequency are rotated among each other so that they diagonalise C1
    coupling : largest |(phi^T C1 phi)_ij| off the diagonal over sqrt(its ii times its jj), without rounding
        error
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
    for i in range(
        1, n
    ):  # equal to rounding: made equal, so that these modes can be aligned with the contact
        if w[i] == w[i - 1] and abs(rates[i] - rates[i - 1]) <= rounding:
            rates[i] = rates[i - 1]
    size = np.sqrt(np.outer(rates, rates))
    beyond = np.abs(product - np.diag(np.diag(product))) - rounding
    coupling = np.divide(beyond, size, out=np.where(beyond > 0.0, np.inf, 0.0), where=size > 0.0)
    return rates / (2.0 * w), phi, float(coupling.max(initial=0.0))


def align_with_contact(w: np.ndarray, zeta: np.ndarray, phi: np.ndarray, contact: np.ndarray) -> np.ndarray:
    """Rotate modes of equal frequency and damping among each other so that only one of them participates.

    Any basis of such a group is valid; with this one a single mode of the group has a pole.
    """
    phi = phi.copy()
    for value in np.unique(np.column_stack((w, zeta)), axis=0):
        group = np.flatnonzero((w == value[0]) & (zeta == value[1]))
        if group.size > 1:
            part = phi[:, group]
            # the first column of the orthogonal factor is parallel to chi, the others are perpendicular to it
            turn = np.linalg.qr((contact @ part)[:, np.newaxis], mode="complete")[0]
            phi[:, group] = part @ turn
    return phi


def modulus(values: np.ndarray) -> np.ndarray:
    """Moduli of complex numbers, each rounded independently of the others, as in `times`."""
    return np.hypot(values.real, values.imag)


def angles(values: np.ndarray) -> np.ndarray:
    """Arguments of complex numbers (n_r,), each rounded independently of the others, as in `times`."""
    return np.array([math.atan2(value.imag, value.real) for value in values])


def wrapped(angle: np.ndarray | float) -> np.ndarray:
    """Wrap angles to (-pi, pi] by whole turns."""
    return angle - math.tau * np.ceil((angle - math.pi) / math.tau)


def times(rows: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Multiply complex rows (n_r, n) by a real matrix (n, k), each row rounded independently of the others.

    A library's matrix product may round a row differently at each position, and so may complex arithmetic on
    arrays; real arithmetic, number by number, does not.
    """
    total = np.zeros((rows.shape[0], matrix.shape[1]), dtype=complex)
    for column, row in zip(rows.T, matrix, strict=True):
        total.real += column.real[:, np.newaxis] * row
        total.imag += column.imag[:, np.newaxis] * row
    return total


def _rows(polynomial: Polynomial, r: np.ndarray) -> np.ndarray:
    """Evaluate a polynomial at r, complex (n_r, n)."""
    return polynomial.at(np.asarray(r, dtype=float)).rows()


def _weighted(parts: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Multiply complex parts (n_r, n) by real weights (n,), each rounded independently, as in `times`."""
    found = np.empty_like(parts)
    found.real, found.imag = parts.real * weights, parts.imag * weights
    return found


def _modal_sum(stiffness: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Sum of parts/stiffness over the modes, both (n_r, n); infinite at a resonance with a nonzero part."""
    resonant = (stiffness == 0.0) & (parts != 0.0)
    terms = np.where(parts != 0.0, parts, 0.0) / np.where(stiffness == 0.0, 1.0, stiffness)
    return np.where(resonant.any(axis=1), np.inf, np.where(resonant, 0.0, terms).sum(axis=1))


def weighted_sum(responses: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Sum over modes of responses (n_r, n) with weights (n,); infinite where a weighted one is infinite."""
    infinite = np.isinf(responses)
    total = times(np.where(infinite, 0.0, responses), weights[:, np.newaxis])[:, 0]
    return np.where((infinite & (weights != 0.0)).any(axis=1), np.inf, total)


def _held_squares(mass: np.ndarray, stiffness: np.ndarray, contact: np.ndarray) -> np.ndarray:
    """Squared natural frequencies of the undamped structure with c.x = 0 held, (n - 1,)."""
    if contact.size == 1:
        return np.empty(0)
    from scipy.linalg import eigh

    # an orthonormal basis of the motions with c.x = 0
    basis = np.linalg.svd(contact[np.newaxis])[2][1:].T
    return eigh(basis.T @ stiffness @ basis, basis.T @ mass @ basis, eigvals_only=True)


def _solve_unexcited_resonance(
    bordered: np.ndarray, mass: np.ndarray, right: np.ndarray
) -> np.ndarray | None:
    """Solve equations that are singular to rounding, for a load that does not excite the resonance.

    The solution is the limit in which the resonant motions are absent: it is orthogonal to them with respect
    to the mass.  Returns None if the load excites them.
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
    """Motion with c.x = 0 and the force that holds the contact, (n_r, n + 1), at resonances of the held
    structure.

    `load` is (n_r, n).  All values are infinite where the load excites the resonance.
    """
    n = contact.size
    bordered = np.zeros((n + 1, n + 1), dtype=complex)
    # the border is scaled to the size of the stiffness (by a power of two, without rounding): otherwise the
    # units of the structure would decide whether the equations are singular
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
    """A structure in modal coordinates; it depends on r through functions of r only (theory.md 1).

    Attributes
    ----------
    w, zeta : (n,) natural frequencies, in the unit of r, and damping ratios
    phi : (n, n) modes in columns, with phi^T M phi = 1
    contact : (n,) c
    load, load_rate : (n,) complex; the load phasor is p(r) = load + i r load_rate
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
        """Participation factors vector.phi_i (n,), exactly zero where they are rounding error.

        |v.phi_i| <= sqrt(v^T M^-1 v) by the Cauchy-Schwarz inequality, as phi_i^T M phi_i = 1.  Without this
        step the 1e-17 of an eigenvalue solver would give U, or V, a pole at a mode that the contact, or the
        load, does not excite.
        """
        shares = vector @ self.phi
        most = np.sqrt(np.real(np.conj(vector) @ np.linalg.solve(self.mass, vector)))
        return np.where(np.abs(shares) <= ZERO_PRODUCT * self.w.size * _EPS * most, 0.0, shares)

    @cached_property
    def chi(self) -> np.ndarray:
        """Participation factors of the contact, c.phi_i (n,); exactly 0 for modes that do not participate."""
        return self._participation_factors(self.contact)

    @property
    def participating(self) -> np.ndarray:
        """Participating modes, which friction in the contact excites, bool (n,)."""
        return self.chi != 0.0

    @property
    def coupled_modes(self) -> np.ndarray:
        """Modes that the damping couples to others, bool (n,)."""
        return np.zeros(self.w.size, dtype=bool)

    def participating_coupling(self) -> np.ndarray | None:
        """Coupling of the participating modes by the damping; None without coupling."""
        return None

    def damping_in_modes(self) -> np.ndarray:
        """C in modal coordinates (n, n), without the rounding errors of modes that it does not couple."""
        if self.participating_coupling() is None:
            return np.diag(2.0 * self.zeta * self.w)
        return self.phi.T @ self.damping @ self.phi

    @cached_property
    def free(self) -> FreeStructure:
        """The participating modes as oscillators."""
        which = self.participating
        return modal_structure(self.w[which], self.zeta[which], self.chi[which])

    @cached_property
    def _load_participation(self) -> Polynomial:
        """Participation factors of load and load_rate; there is no part proportional to r^2."""
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
        """Participation factors of the parts of `relative_load`."""
        return Polynomial(*(self._participation_factors(part).astype(complex) for part in self._relative))

    @cached_property
    def _body(self) -> Body:
        """The structure as arrays for the force balance."""
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
        """Acceleration c^T M^-1 load of the contact under a load (n,); exactly 0 where it is rounding."""
        across = np.linalg.solve(self.mass, load)
        most = np.sqrt(self.inverse_mass * np.real(np.conj(load) @ across))  # by Cauchy and Schwarz
        value = complex(self.contact @ across)
        return 0.0 if abs(value) <= ZERO_PRODUCT * self.w.size * _EPS * most else value

    def participation(self, r: np.ndarray) -> np.ndarray:
        """Participation factors of the load, lambda_i = p(r).phi_i, complex (n_r, n)."""
        return _rows(self._load_participation, r)

    def total_load(self, r: np.ndarray) -> np.ndarray:
        """Load phasor p(r) on the masses, (n_r, n)."""
        return _rows(Polynomial(self.load, self.load_rate, np.zeros(self.w.size)), r)

    def relative_load(self, r: np.ndarray) -> np.ndarray:
        """Load phasor for the displacements x - s relative to the other side of the contact, (n_r, n).

        With base motion it is p - (K - r^2 M + i r C1) ones = r^2 M ones + i r (load_rate - C1 ones),
        evaluated without the cancellation in p - K ones; else it is p.
        """
        return _rows(self._relative, r)

    def relative_participation(self, r: np.ndarray) -> np.ndarray:
        """Participation factors relative_load(r).phi_i, (n_r, n)."""
        return _rows(self._relative_participation, r)

    def dynamic_stiffness(self, r: np.ndarray) -> np.ndarray:
        """w_i^2 - r^2 + 2 i zeta_i w_i r of each single mode, (n_r, n), without cancellation at resonance.

        Coupling between modes is not included.
        """
        return dynamic_stiffness(self.w, self.zeta, np.asarray(r, dtype=float)).rows()

    def modal_responses(self, r: np.ndarray, loads: np.ndarray) -> np.ndarray:
        """Modal coordinates under modal loads, both (n_r, n); infinite at an excited undamped resonance."""
        stiffness = self.dynamic_stiffness(r)
        resonant = stiffness == 0.0
        found = np.where(resonant, 0.0, loads) / np.where(resonant, 1.0, stiffness)
        return np.where(resonant & (loads != 0.0), np.inf, found)

    def damping_form(self, q: np.ndarray) -> np.ndarray:
        """Quadratic form q^H C q of modal phasors (n_r, n), including coupling by the damping; (n_r,)."""
        return (2.0 * self.zeta * self.w * modulus(q) ** 2).sum(axis=1)

    def response(self, r: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Compute sum_i weights_i lambda_i/(w_i^2 - r^2 + 2 i zeta_i w_i r), complex (n_r,).

        It is V_k of a mass with the weights phi[k].  It is infinite at an undamped resonance that is both
        loaded and weighted.
        """
        return _modal_sum(self.dynamic_stiffness(r), _weighted(self.participation(r), weights))

    def mass_responses(self, r: np.ndarray) -> np.ndarray:
        """Displacements V_k without friction, complex (n_r, n); infinite as in `response`."""
        return np.column_stack([self.response(r, row) for row in self.phi])

    def contact_response(self, r: np.ndarray) -> np.ndarray:
        """Response function V of z, theory.md 2, complex (n_r,); infinite as in `response`.

        It equals response(r, chi) - s, without the cancellation of that difference at small r.
        """
        return contact_responses(np.asarray(r, dtype=float), self._body)

    def held(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacements x - s (n_r, n) and force F (n_r,) with the contact held, theory.md 4.

        All values are infinite where the load excites an undamped resonance of the held structure.  Modes
        that do not participate respond as if free and do not change F; they are removed from the equations,
        which they would otherwise make singular.
        """
        r = np.asarray(r, dtype=float)
        key = r.tobytes()
        known = self._last_held.get(key)
        if known is None:
            known = self._held(r)
            self._last_held.clear()
            self._last_held[key] = known
        return known[0].copy(), known[1].copy()

    @cached_property
    def _last_held(self) -> dict[bytes, tuple[np.ndarray, np.ndarray]]:
        """The last result of `held`: boundaries and cells of a map ask for the same frequencies."""
        return {}

    def _held(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Compute what `held` returns."""
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
        """Displacements (n_r, n) from the participating modes q and the others, which `parts` excites."""
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

        Infinite where the load excites an undamped resonance of the held structure.
        """
        return self.held(r)[1]

    def held_response(self, r: np.ndarray) -> np.ndarray:
        """Displacement phasors X of all masses with the contact held, theory.md 4; (n_r, n).

        Infinite where the load excites an undamped resonance of the held structure.
        """
        return self.held(r)[0] + self.base_motion

    def held_at_rest(self) -> np.ndarray:
        """Masses that stay at rest with the contact held, whatever the frequency, bool (n,).

        These are the mass held by a fixed wall, and masses connected to the load only through it.
        """
        if self.base_motion or np.count_nonzero(self.contact) > 1:
            return np.zeros(self.w.size, dtype=bool)
        free = self.contact == 0.0
        tied = (self.stiffness != 0.0) | (self.mass != 0.0) | (self.damping != 0.0)
        moved = free & ((self.load != 0.0) | (self.load_rate != 0.0))
        for _ in range(self.w.size):  # propagate from mass to mass, away from the load
            moved |= free & tied @ moved
        return ~moved

    def held_frequencies(self) -> np.ndarray:
        """Natural frequencies of the undamped structure with its contact held, shape (n - 1,)."""
        return np.sqrt(_held_squares(self.mass, self.stiffness, self.contact))
