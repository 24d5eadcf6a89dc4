"""Features of the regimes and of the continuous motion that need no map: limits, peaks, invariant points.

Equation numbers are those of theory.md 7 and of the thesis (T).
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from . import checks
from ._kernels.boundary.functions import fill_damping_functions
from .errors import InputError
from .model.free_structure import FreeStructure
from .model.general import refuse_general
from .model.modes import ModalModel
from .model.system import System
from .roots import FrequencyRange, find_roots, shaped, union, with_poles, without

__all__ = [
    "FirstHarmonicPoints",
    "HighFrequency",
    "all_mass_invariant_points",
    "first_harmonic_invariant_points",
    "first_harmonic_points",
    "high_frequency_limits",
    "invariant_points",
    "mass_invariant_points",
    "one_phase",
    "peak_amplitudes",
    "peak_thresholds",
    "quasi_static_displacement",
]


def __dir__() -> list[str]:
    return sorted(__all__)


#: Largest number of invariant points sought, from the highest down: they accumulate towards r = 0, where
#: hardly any motion is continuous.
MOST_POINTS = 1000

#: Phase difference below which two loads are in phase: a few units of rounding of an exponential.
_ONE_PHASE = 1e-14


class HighFrequency(NamedTuple):
    """Boundaries in the limit r -> infinity; infinite where they grow without bound.

    Examples
    --------
    With a wall that moves with the base both boundaries grow without bound:

    >>> import frictionmap as fm
    >>> fm.features.high_frequency_limits(fm.System(excitation="base", contact="joined-base-wall"))
    HighFrequency(beta_lim=inf, beta_stick=inf)
    """

    beta_lim: float
    beta_stick: float


def peak_thresholds(system: System) -> np.ndarray:
    """Least beta for which the i-th resonant peak is finite, T(6.2), (6.26), (7.62); shape (n,).

    (pi/4)|lambda_i/chi_i| without damping; with damping T(7.62), which is approximate.  Infinite for a mode
    that does not participate; NaN for a mode that C couples to others.

    Parameters
    ----------
    system : System
        With one rigid contact under one harmonic load.

    Returns
    -------
    array, shape (n,)
        Friction over load amplitude [-], mode by mode.

    Raises
    ------
    InputError
        An argument is out of range, or the system has other contacts or loads.

    Examples
    --------
    Without damping the peak of one mass is infinite below beta = pi/4, as Den Hartog found:

    >>> import numpy as np
    >>> import frictionmap as fm
    >>> fm.features.peak_thresholds(fm.System()) / (np.pi / 4)
    array([1.])
    """
    refuse_general(system, "compute peak thresholds")
    modes = system.modes
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.abs(np.diagonal(modes.participation(modes.w))) / np.abs(modes.chi)  # each at its own w
    x = math.pi * modes.zeta
    # (cosh x - 1)/(2 zeta sinh x) = tanh(x/2)/(2 zeta), which is pi/4 at zeta = 0
    factor = np.full(x.size, 0.25 * math.pi)
    np.divide(np.tanh(0.5 * x), 2.0 * modes.zeta, out=factor, where=modes.zeta > 0.0)
    return np.where(modes.coupled_modes, np.nan, np.where(modes.chi == 0.0, np.inf, ratio * factor))


def peak_amplitudes(system: System, beta: float) -> np.ndarray:
    """Amplitude of every mass at every resonance, T(7.60), approximate; shape (n, n): mass, mode.

    It decreases linearly with beta, to 0 at the `peak_thresholds` of the mode; at and above it the motion is
    not continuous and the value is NaN.  Infinite without damping; NaN for a mode that C couples to others.

    Parameters
    ----------
    system : System
        With one rigid contact under one harmonic load.
    beta : float
        Friction over load amplitude [-], >= 0.

    Returns
    -------
    array, shape (n, n)
        Amplitudes over P/k1 (Y), >= 0: rows are masses, columns modes in the order of their frequencies.

    Raises
    ------
    InputError
        An argument is out of range, or the system has other contacts or loads.

    Examples
    --------
    Without friction the amplitude at resonance is 1/(2 zeta):

    >>> import frictionmap as fm
    >>> fm.features.peak_amplitudes(fm.System(damping_ratios=0.05), beta=0.0)
    array([[10.]])
    """
    refuse_general(system, "compute peak amplitudes")
    beta = checks.number(beta, "beta", least=0.0)
    modes = system.modes
    part = np.abs(modes.phi * np.diagonal(modes.participation(modes.w))) / modes.w**2
    with np.errstate(divide="ignore", invalid="ignore"):
        # |phi chi|/w^2 sinh/(cosh - 1) is the frictionless peak over the threshold
        left = 1.0 - beta / peak_thresholds(system) if beta > 0.0 else np.ones(modes.w.size)
        peaks = np.where(part > 0.0, part / (2.0 * modes.zeta) * left, 0.0)
    return np.where((left > 0.0) & ~modes.coupled_modes, peaks, np.nan)


def high_frequency_limits(system: System, mu: float = 1.0) -> HighFrequency:
    """beta_lim and beta_stick for r -> infinity, T(2.31), (6.8), (6.28), (6.29), with mu squared.

    Zero if the load does not act on a mass in contact.  With a joined base-wall they grow with r^2, with
    dashpots to the base with r.

    Parameters
    ----------
    system : System
        With one rigid contact under one harmonic load.
    mu : float
        Static over kinetic friction [-], >= 1.

    Returns
    -------
    HighFrequency
        Both boundaries, friction over load amplitude [-].

    Raises
    ------
    InputError
        An argument is out of range, or the system has other contacts or loads.

    Examples
    --------
    For one mass on a fixed wall they are 2/sqrt(4 + pi^2) and 1:

    >>> import frictionmap as fm
    >>> limits = fm.features.high_frequency_limits(fm.System(), mu=1.0)
    >>> round(limits.beta_lim, 6), limits.beta_stick
    (0.537029, 1.0)
    """
    refuse_general(system, "compute high-frequency limits")
    mu = checks.number(mu, "mu", least=1.0)
    modes = system.modes
    if system.base_motion or modes.contact_acceleration(modes.load_rate) != 0.0:
        return HighFrequency(math.inf, math.inf)
    # where the growing terms cancel, the effect of C in the next power of r remains: c^T M^-1 (load - C M^-1
    # load_rate)
    left = modes.load - modes.damping @ np.linalg.solve(modes.mass, modes.load_rate)
    share = abs(modes.contact_acceleration(left)) / modes.inverse_mass
    return HighFrequency(float(share) * 2.0 / math.hypot(2.0 * mu, math.pi), float(share) / mu)


def quasi_static_displacement(system: System, beta: float) -> np.ndarray:
    """Displacements for r -> 0 while the contact slides: K x0 = p - beta c, T(6.5); shape (n,).

    They are the displacements at tau = 0, where the load equals the real part of its phasor, with the contact
    sliding towards larger z.  The contact sticks instead unless beta is below beta_stick at r = 0.

    Parameters
    ----------
    system : System
        With one rigid contact under one harmonic load.
    beta : float
        Friction over load amplitude [-], >= 0.

    Returns
    -------
    array, shape (n,)
        Displacements of the masses over P/k1 (Y).

    Raises
    ------
    InputError
        An argument is out of range, or the system has other contacts or loads.

    Examples
    --------
    One mass: the load less the friction, 1 - beta.

    >>> import frictionmap as fm
    >>> fm.features.quasi_static_displacement(fm.System(), beta=0.25)
    array([0.75])
    """
    refuse_general(system, "compute the quasi-static displacement")
    beta = checks.number(beta, "beta", least=0.0)
    modes = system.modes
    return np.linalg.solve(modes.stiffness, modes.load.real - beta * modes.contact)


def _range(modes: ModalModel, low: object, high: object, most: object) -> FrequencyRange:
    """Check the range, and raise its lower end so that it has at most about `most` edges.

    Edges are the natural frequencies and, for every participating mode or oscillator that vibrates, the
    damped frequency over 1, 3, 5...: there u of T(7.11) has its poles, or changes sign without a pole.
    """
    low = checks.number(low, "low", above=0.0)
    high = checks.number(high, "high", above=low, most=checks.LARGEST_RATIO)
    most = checks.whole(most, "most", least=1)
    free = modes.free
    vibrating = free.zeta < 1.0
    edges, poles = [modes.w], [modes.w[modes.zeta == 0.0]]
    for w, zeta in zip(free.omega[vibrating], free.zeta[vibrating], strict=True):
        top = w * math.sqrt((1.0 - zeta) * (1.0 + zeta))
        first = 2.0 * math.floor(0.5 * top / high) + 1.0
        last = min(top / low, first + 2.0 * most)
        found = top / np.arange(first, last + 1.0, 2.0)
        edges.append(found)
        if zeta == 0.0:
            poles.append(found)
    inside = [np.unique(np.concatenate(part)) for part in (edges, poles)]
    inside = [part[(part > low) & (part < high)] for part in inside]
    if inside[0].size > most:
        low = float(inside[0][-most - 1])
        inside = [part[part > low] for part in inside]
    return FrequencyRange(low, high, *inside)


def _damping_functions(free: FreeStructure, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Damping functions u and g of participating modes or oscillators, (n_r, p) both."""
    u, g = np.empty((2, r.size, free.omega.size))
    fill_damping_functions(r, free.omega, free.zeta, u, g)
    return u, g


def _first_damping(modes: ModalModel, r: np.ndarray) -> np.ndarray:
    """u_i/w_i^2 chi_i, and 0 for modes that do not participate, whose u may be infinite; (n_r, n)."""
    participating = modes.chi != 0.0
    u, _ = _damping_functions(modes.free, r)
    terms = np.zeros((r.size, participating.size))
    terms[:, participating] = u * (modes.chi / modes.w**2)[participating]
    return terms


def _coupled_u(modes: ModalModel, r: np.ndarray) -> np.ndarray:
    """U where the damping couples modes, theory.md 8; (n_r,)."""
    free, r = modes.free, r[:, np.newaxis]
    static, rates = free.weights(modes.chi[modes.participating])
    u, g = _damping_functions(free, r[:, 0])
    a = free.omega / r
    return u @ static - r[:, 0] * ((a * a * g + 2.0 * free.zeta * a * u) @ rates)


def _sums(terms: np.ndarray, rows: np.ndarray, which: np.ndarray | None) -> np.ndarray:
    """Sums over modes of terms (n_r, n) with weights (n_rows, n): (n_r, n_rows), or (n_r,) for one row per
    term.
    """
    return terms @ rows.T if which is None else np.einsum("ij,ij->i", terms, rows[which])


def invariant_points(system: System, low: float, high: float, most: int = MOST_POINTS) -> np.ndarray:
    """Find frequency ratios in (low, high) where friction does not change z: U = 0, T(6.9), increasing.

    Without damping, amplitude and phase of z are there the same as without friction, and all such points are
    found: between two of its poles U falls from +inf to -inf once.  With damping only the phase is unchanged.
    Of more than about `most` points the highest are returned.

    Parameters
    ----------
    system : System
        With one rigid contact under one harmonic load.
    low, high : float
        Ends of the range of frequency ratios [-], 0 < low < high.
    most : int
        About how many points are returned at most, >= 1.

    Returns
    -------
    array, shape (points,)
        Frequency ratios [-], increasing.

    Raises
    ------
    InputError
        An argument is out of range, or the system has other contacts or loads.

    Examples
    --------
    >>> import frictionmap as fm
    >>> fm.features.invariant_points(fm.System(), 0.2, 2.0).round(9)
    array([0.25, 0.5 ])
    """
    refuse_general(system, "compute invariant points")
    modes = system.modes
    where = _range(modes, low, high, most)
    if modes.free.coupled:
        return find_roots(lambda r, which=None: shaped(_coupled_u(modes, r), which), where)[0]
    row = modes.chi[np.newaxis]
    return find_roots(lambda r, which=None: _sums(_first_damping(modes, r), row, which), where)[0]


def _real_load(modes: ModalModel) -> np.ndarray:
    """The load with its largest entry rotated to a positive real number; the motion is rotated with it."""
    return modes.load * np.exp(-1j * np.angle(modes.load[np.argmax(np.abs(modes.load))]))


def one_phase(system: System) -> bool:
    """Whether all loads are in phase or in opposition; otherwise no amplitude is invariant.

    Parameters
    ----------
    system : System
        Any; with a load on one mass, or a base that moves, it is true.

    Returns
    -------
    bool

    Examples
    --------
    >>> import frictionmap as fm
    >>> pair = {"mass_ratios": [1, 1], "stiffness_ratios": [1, 1]}
    >>> [fm.features.one_phase(fm.System(load=load, **pair)) for load in ([1, -1], [1, 1j])]
    [True, False]
    """
    turned = _real_load(system.modes)
    return bool(np.all(np.abs(turned.imag) <= _ONE_PHASE * np.abs(turned)))


def _undamped(system: System) -> ModalModel:
    """The structure without its damping and with a real load."""
    if not one_phase(system):
        raise InputError(
            "load", f"must have one phase for invariant points of a mass; got {system.modes.load.tolist()}"
        )
    modes = system.modes
    turned = _real_load(modes)
    none = np.zeros(modes.w.size)
    return ModalModel(
        modes.w, modes.phi, none, modes.contact, turned.real.astype(complex), none.astype(complex),
        modes.base_motion, modes.mass, modes.stiffness, np.zeros_like(modes.damping), modes.springs,
    )  # fmt: skip


def _responses(modes: ModalModel, r: np.ndarray) -> np.ndarray:
    """lambda_i/(w_i^2 - r^2) without damping and with a real load, away from resonances; (n_r, n)."""
    return modes.participation(r).real / modes.dynamic_stiffness(r).real


def _displacement_rows(modes: ModalModel, masses: np.ndarray) -> np.ndarray:
    """Rows phi_k of the masses (counted from 1), (n_masses, n), with exact zeros at the nodes of a mode."""
    rows = modes.phi[masses - 1]
    return np.where(np.abs(rows) <= 1e-13 * np.abs(modes.phi).max(axis=0), 0.0, rows)


def _follows_contact(modes: ModalModel, rows: np.ndarray) -> np.ndarray:
    """Whether the displacement of a mass equals z, as for the mass at a fixed wall; bool (n_masses,)."""
    return (not modes.base_motion) & np.isclose(np.abs(rows), np.abs(modes.chi), 1e-12, 1e-13).all(axis=1)


def _antiresonances(modes: ModalModel, where: FrequencyRange) -> np.ndarray:
    """Zeros of V, where V_k/V has its poles unless V_k is zero there as well."""
    return find_roots(lambda r, which=None: shaped(modes.contact_response(r).real, which), where)[0]


class _Motions(NamedTuple):
    """Masses, and last the contact, as weights of the modes; (n_rows, n) and (n_rows,)."""

    rows: np.ndarray
    own: np.ndarray  # whether the displacement equals z

    def ratios(self, modes: ModalModel, r: np.ndarray, which: np.ndarray | None) -> np.ndarray:
        """V_k/V without damping, (n_r, n_rows), or (n_r,) for one row per frequency; 1 for the contact
        itself.
        """
        v_k, v = _sums(_responses(modes, r), self.rows, which), shaped(modes.contact_response(r).real, which)
        own = self.own if which is None else self.own[which]
        safe = np.where(v == 0.0, 1.0, v)
        return np.where(own, 1.0, np.where(v == 0.0, 0.0, v_k / safe))


def _motions(modes: ModalModel) -> _Motions:
    masses = _displacement_rows(modes, np.arange(1, modes.w.size + 1))
    own = np.append(_follows_contact(modes, masses), True)
    return _Motions(np.vstack((masses, modes.chi)), own)


def all_mass_invariant_points(
    system: System, low: float, high: float, most: int = MOST_POINTS
) -> list[np.ndarray]:
    """Find the `mass_invariant_points` of every mass, at about the cost of one mass.

    Parameters
    ----------
    system, low, high, most
        As in `invariant_points`.

    Returns
    -------
    list of arrays, one for each mass
        Frequency ratios [-], increasing.

    Raises
    ------
    InputError
        As in `invariant_points`, or loads have different phases.

    Examples
    --------
    >>> import frictionmap as fm
    >>> pair = fm.System(contact_masses=[2], mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    >>> [points.round(6).tolist() for points in fm.features.all_mass_invariant_points(pair, 0.5, 2.0)]
    [[0.527585, 0.551958, 0.828219, 1.549362], [0.543048, 1.449813]]
    """
    refuse_general(system, "compute invariant points")
    modes = _undamped(system)
    where = _range(modes, low, high, most)
    where = with_poles(where, _antiresonances(modes, where))
    motions = _motions(modes)
    n = system.n

    def functions(r: np.ndarray, which: np.ndarray | None = None) -> np.ndarray:
        row = np.arange(n) if which is None else which % n
        u = _first_damping(modes, r)
        u_k, u_z = _sums(u, motions.rows, None if which is None else row), u @ modes.chi
        if which is None:
            u_k, u_z = u_k[:, :n], u_z[:, np.newaxis]
        ratios = motions.ratios(modes, r, None if which is None else row)
        ratios = ratios[:, :n] if which is None else ratios
        # for the contact itself T(6.10) is never zero, but the factor it is multiplied by here is
        other = np.where(motions.own[row] | (u_k == 0.0), 0.0, u_k - 2.0 * ratios * u_z)
        return np.hstack((u_k, other)) if which is None else np.where(which < n, u_k, other)

    roots = find_roots(functions, where)
    return [union(roots[k], roots[k + n]) for k in range(n)]


def mass_invariant_points(
    system: System, mass: int, low: float, high: float, most: int = MOST_POINTS
) -> np.ndarray:
    """Find the invariant points of the displacement of one mass: U_k = 0, and 1 - 2 V_k U/(V U_k) = 0,
    T(6.10).

    At these points friction changes from lowering the monoharmonic amplitude T(5.50) to raising it, or back;
    they are the limits for beta -> 0 of the `inversion_points` of the exact amplitude.  For a mass in contact
    with a fixed wall they are the `invariant_points`.  Damping is neglected: with damping the points are
    approximate, T 7.4.3.  All loads must be in phase.

    Parameters
    ----------
    system, low, high, most
        As in `invariant_points`.
    mass : int or str
        The mass, counted from 1, or its name.

    Returns
    -------
    array, shape (points,)
        Frequency ratios [-], increasing.

    Raises
    ------
    InputError
        As in `invariant_points`, there is no such mass, or loads have different phases.

    Examples
    --------
    >>> import frictionmap as fm
    >>> pair = fm.System(contact_masses=[2], mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    >>> fm.features.mass_invariant_points(pair, 1, 0.5, 2.0).round(6)
    array([0.527585, 0.551958, 0.828219, 1.549362])
    """
    refuse_general(system, "compute invariant points")
    mass = system.dofs.number(mass, "mass")
    return all_mass_invariant_points(system, low, high, most)[system.dofs.row(mass)]


class FirstHarmonicPoints(NamedTuple):
    """Frequency ratios where friction does not change a first harmonic; increasing.

    Examples
    --------
    >>> import frictionmap as fm
    >>> pair = fm.System(contact_masses=[2], mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    >>> (first, *_) = fm.features.first_harmonic_points(pair, 0.5, 2.0)
    >>> first.unchanged.round(6), first.inversions.round(6)
    (array([], dtype=float64), array([0.545895, 0.822806, 1.549463]))
    """

    unchanged: np.ndarray  # where amplitude and phase are unchanged
    inversions: (
        np.ndarray
    )  # where only the amplitude is unchanged; friction raises it on one side and lowers it on the other

    @property
    def all(self) -> np.ndarray:
        """Both kinds, increasing, each point once."""
        return union(*self)


def first_harmonic_points(
    system: System, low: float, high: float, most: int = MOST_POINTS
) -> list[FirstHarmonicPoints]:
    """Find frequency ratios in (low, high) where friction does not change a first harmonic, theory.md 9 (7).

    The list holds the points of every mass, and last those of z.  The first harmonic of friction acts through
    A_k = sum phi_ki chi_i/(w_i^2 - r^2): where it is zero, amplitude and phase are unchanged.  Furthermore
    abs(X_k1)^2 = V_k^2 + (8 beta^2/pi) A_k (V_k U/V + 2 A_k/pi) for every beta: where the bracket is zero,
    the amplitude is unchanged.  Damping is neglected; all loads must be in phase.

    Parameters
    ----------
    system, low, high, most
        As in `invariant_points`.

    Returns
    -------
    list of FirstHarmonicPoints, n + 1 of them

    Raises
    ------
    InputError
        As in `invariant_points`, or loads have different phases.

    Examples
    --------
    Points of mass 1, of mass 2 and of the contact where amplitude and phase are unchanged:

    >>> import frictionmap as fm
    >>> pair = fm.System(contact_masses=[2], mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    >>> points = fm.features.first_harmonic_points(pair, 0.5, 2.0)
    >>> [one.unchanged.round(6).tolist() for one in points]
    [[], [1.414214], [1.414214]]
    """
    refuse_general(system, "compute invariant points")
    modes = _undamped(system)
    where = _range(modes, low, high, most)
    motions = _motions(modes)
    pushed = replace(modes, load=modes.contact.astype(complex))  # A_k is V_k of a load c

    def compliances(r: np.ndarray, which: np.ndarray | None = None) -> np.ndarray:
        return _sums(_responses(pushed, r), motions.rows, which)

    def brackets(r: np.ndarray, which: np.ndarray | None = None) -> np.ndarray:
        u = shaped(_first_damping(modes, r) @ modes.chi, which)
        return motions.ratios(modes, r, which) * u + 2.0 / math.pi * compliances(r, which)

    unchanged = find_roots(compliances, where)
    inversions = find_roots(brackets, with_poles(where, _antiresonances(modes, where)))
    # where V_k is zero too, a root of A_k is also a root of the bracket
    return [
        FirstHarmonicPoints(both, without(amplitude, both))
        for both, amplitude in zip(unchanged, inversions, strict=True)
    ]


def first_harmonic_invariant_points(
    system: System, mass: int, low: float, high: float, most: int = MOST_POINTS
) -> np.ndarray:
    """All `first_harmonic_points` of one mass, the inversion points of frequency-based curves of T 4.4.

    Parameters
    ----------
    system, low, high, most
        As in `invariant_points`.
    mass : int or str
        The mass, counted from 1, or its name.

    Returns
    -------
    array, shape (points,)
        Frequency ratios [-], increasing.

    Raises
    ------
    InputError
        As in `invariant_points`, there is no such mass, or loads have different phases.

    Examples
    --------
    >>> import frictionmap as fm
    >>> pair = fm.System(contact_masses=[2], mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    >>> fm.features.first_harmonic_invariant_points(pair, 1, 0.5, 2.0).round(6)
    array([0.545895, 0.822806, 1.549463])
    """
    refuse_general(system, "compute invariant points")
    mass = system.dofs.number(mass, "mass")
    return first_harmonic_points(system, low, high, most)[system.dofs.row(mass)].all
