"""Response curves: amplitude, phase, harmonics and energy of steady states over frequency."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from ..datasets.physical import with_units
from ..datasets.variables import mass_coordinates, stamp
from ..jobs import Progress
from ..model.settings import Quantity, Solver, SolverSettings, curve_settings, merged
from ..model.system import System
from ..single.maps import checked_axes
from ..single.quantity_data import PARTS
from ..solvers.choose import engine_of
from ..units.scales import Units, scales_of
from .configured import Configured, system_and_axes
from .refinement import reduction_check


def curves(
    system: System | Configured,
    r: ArrayLike | None = None,
    beta: ArrayLike | None = None,
    mu: ArrayLike | None = None,
    *,
    harmonics: int | None = None,
    quantities: Sequence[Quantity] | None = None,
    solver: Solver | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    units: Units | None = None,
    **settings: Unpack[SolverSettings],
) -> xr.Dataset:
    """Compute response curves of the steady states on a mu-r-beta grid, through all regimes.

    Parameters
    ----------
    system : System or Config
        A configuration of `load_config` brings its axes, settings and units; arguments replace them.
    r : array_like, shape (n_r,)
        Frequency ratios omega/omega_1 [-], >= 0, increasing.
    beta : array_like, shape (n_beta,)
        Ratios of kinetic friction force to load amplitude F/P (F/(k1 Y)) [-], >= 0, increasing.
    mu : array_like, shape (n_mu,)
        Ratios of static to kinetic friction [-], >= 1, increasing; default: 1.
    harmonics : int, optional
        Highest harmonic of the displacements, of the motion in the contact and of the friction force, up to
        1000; 0: none.  Default 7 where `quantities` contains "harmonics", else none.
    quantities : sequence of str, optional
        Any of "amplitude", "phase", "first_harmonic", "energy", "harmonics", "transmitted_force" and
        "distortion"; default: all but the last two.  Only these are computed.
    solver : Solver, optional
        Settings, or single settings as keywords.  Its `outputs` are not used.
    threads : int, optional
        Number of threads; default: all processors of the process.  The result is equal to the bit for any
        number.
    progress : callable, optional
        Called as progress(done, total); the quotient is the share of the work that is done.
    units : Units, optional
        Reference values that convert ratios to Hz and N, as in `sweep`.

    Returns
    -------
    xarray.Dataset
        On (mu, r, beta), some also on dof and on (harmonic, part): `regime`, `stops_per_cycle`, `period`,
        `status`, and the variables of the requested quantities.

        * `amplitude` and `contact_amplitude`: largest moduli over time.
        * `phase_lag` and `contact_phase`: lags of the maxima [rad].  NaN where the maximum is held during a
          stop (then see `phase_begin` and `phase_end`), and where the period is not 1.  `phase` is an older
          name of `phase_lag`.
        * `first_harmonic_amplitude` and `first_harmonic_phase`: modulus and lag -arg X_1 of the first
          harmonic; also with the prefix `contact_`.
        * `sliding_distance`, `work_friction`, `work_input`, `work_damping` and `equivalent_damping`, per
          cycle.
        * `displacement_harmonic`, `contact_harmonic` and `friction_harmonic`.
        * `transmitted_force` and `transmitted_first_harmonic`.
        * `rms`: root mean square.  `distortion`: root mean square without mean and first harmonic, over that
          of the first harmonic.

        On (mu, r): `beta_lim`, `beta_stick`; on (mu, r, dof) `limit_amplitude`,
        `limit_phase`, `limit_first_harmonic_amplitude` and `limit_first_harmonic_phase` of the continuous
        motion at beta_lim; on (r, dof) `held_response` and `held_phase` with the contact held.

        Amplitudes are infinite at an undamped resonance; phases are then those that the growing motion
        approaches.  Where the contact sticks, displacements are measured from their static offset.

    Raises
    ------
    InputError
        An argument or a setting has the wrong type or is out of range.

    Examples
    --------
    >>> import frictionmap as fm
    >>> ds = fm.curves(fm.System(), r=[0.85], beta=[0.2], quantities=["first_harmonic", "energy"])
    >>> round(ds.first_harmonic_phase.item(), 6), round(ds.work_friction.item(), 6)
    (0.257396, 2.805945)
    """
    system, r, beta, mu, units, config = system_and_axes(system, r, beta, mu, units)
    wanted = curve_settings(harmonics, quantities)
    if config is not None:
        solver = solver or config.solver
        wanted = config.curves if harmonics is None and quantities is None else wanted
    solver = merged(solver, settings)
    scales = scales_of(units, system)
    axes = checked_axes(r, beta, mu, system.n * (wanted.harmonics + 1), scales)
    system.costs(axes["r"])
    grid = {name: axes[name] for name in ("r", "beta", "mu")}
    axes["dof"] = np.array(system.dofs.numbers)
    if wanted.harmonics:
        axes |= {"harmonic": np.arange(wanted.harmonics + 1), "part": PARTS}
    ds = engine_of(system).curves(axes, solver, wanted, threads, progress)
    ds = ds.assign_coords(mass_coordinates(system)) if system.by_modes else ds
    ds = stamp(ds, "curves", "Response curves", system, grid, solver, asdict(wanted), units=units)
    ds.attrs |= reduction_check(system, grid, solver, threads)
    return with_units(ds, scales)
