"""Boundaries of the regimes over frequency, as datasets."""

import xarray as xr
from numpy.typing import ArrayLike

from .. import checks
from ..datasets.physical import with_units
from ..datasets.variables import stamp
from ..errors import InputError
from ..model.system import System
from ..solvers.choose import engine_of
from ..units.axes import KINDS, ratios
from ..units.scales import Units, scales_of
from .configured import Configured, belt_speeds, system_and_axes
from .refinement import boundary_check


def boundaries(
    system: System | Configured,
    r: ArrayLike | None = None,
    mu: ArrayLike | None = None,
    *,
    units: Units | None = None,
    wall_speed: ArrayLike | None = None,
    beta: ArrayLike | None = None,
) -> xr.Dataset:
    """Compute the boundaries of the regimes over frequency.

    Parameters
    ----------
    system : System or Config
        A configuration of `load_config` brings its axes, settings and units; arguments replace them.
    r : array_like, shape (n_r,)
        Frequency ratios omega/omega_1 [-], >= 0, increasing; omega_1 = sqrt(k_1/m_1) for a chain, else the
        system's frequency_scale.
    mu : array_like, shape (n_mu,)
        Ratios of static to kinetic friction [-], >= 1, increasing; default: 1.
    units : Units, optional
        Reference values that convert ratios to Hz and N, as in `sweep`; r may then be frequencies.
    wall_speed, beta : array_like, shape (n_v,) and (n_beta,)
        In the place of r, without a load: belt speeds and friction, as in `sweep`.

    Returns
    -------
    xarray.Dataset
        On (mu, r): `beta_lim` (continuous motion below it, theory.md 3), `beta_lim_modal` (T(5.65) with
        (5.55)) and `beta_stick` (at or above it the contact can stay stuck, theory.md 4).

        On r: the response function of z, `V` (real part) and `V_imag`, and `U`, `G`, `H`, `S`.

        Features (theory.md 7): for each mode `natural_frequency` and `peak_threshold`; `held_frequency`; for
        each mu the limits for r -> infinity, `beta_lim_high` and `beta_stick_high`; on (dof, r)
        `held_response` and `held_phase`, amplitude and phase lag [radian] of each mass with the contact held,
        infinite and NaN at its resonances.

        Within the axis: `invariant_point`, where friction does not change z (with damping: its phase);
        without damping, on (dof, mass_invariant), `mass_invariant_point`, where it does not change the
        monoharmonic amplitude of a mass; on (dof, root) `invariant_first_harmonic`, where it does not change
        the amplitude of the first harmonic; on (contact_root) `contact_invariant_first_harmonic`, the same
        for z, theory.md 9.  Rows with fewer points are padded with NaN.  About 40 points plus one per mode
        are listed, from the highest down, and those of masses for up to 12 masses; a variable without points
        is omitted.  `frictionmap.features` computes all points.

        With wall_speed: `beta_slope_lim`, `beta_slope_certificate`, `beta_sliding_lim` on wall_speed,
        `sliding_speed_lim` on beta, and for one mass `cycle_speed_lim` on (mu, beta), theory.md 11.

        Where C couples modes, `beta_lim_modal` and `peak_threshold`, which treat modes separately, are NaN.

    Raises
    ------
    InputError
        An axis is empty, not finite, not increasing or out of range.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.boundaries(fm.System(contact="joined-base-wall"), r=[0.5, 2.0])
    >>> ds.beta_stick.values
    array([[0.25, 4.  ]])
    """
    if (speeds := belt_speeds(system, wall_speed, r)) is not None:
        from ..no_load.sweep import belt_boundaries

        given = system_and_axes(system, None, beta, mu, units, needs=("beta",))
        return belt_boundaries(given.system, speeds, given.beta, given.mu, given.units)
    if beta is not None:
        raise InputError("cannot use", "beta", "without wall_speed: boundaries are over r and mu; omit it")
    system, r, _, mu, units, _ = system_and_axes(system, r, None, mu, units, needs=("r",))
    scales = scales_of(units, system)
    r = checks.axis(ratios(r, "r", KINDS["r"], scales), "r", least=0.0, most=checks.LARGEST_RATIO)
    mu = checks.axis(mu, "mu", least=1.0)
    system.costs(r)
    title = "Boundaries of the motion regimes"
    ds = engine_of(system).boundaries(r, mu)
    ds = stamp(ds, "boundaries", title, system, {"r": r, "mu": mu}, units=units)
    ds.attrs |= boundary_check(system, r, mu)
    return with_units(ds, scales)
