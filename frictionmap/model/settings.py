"""Settings of the steady-state solver, and of response curves."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, TypedDict, get_args

from .. import checks
from ..errors import InputError
from .html import as_table
from .shown import Shown

#: Outputs of a map, in the order of the file; described in `labels.CELL_VARIABLES`, `CURVE_OUTPUTS` in
#: `labels.CURVES`.
Output = Literal[
    "regime",
    "stops_per_cycle",
    "contact_amplitude",
    "stuck_fraction",
    "period",
    "origin",
    "cycles",
    "status",
    "multiplier",
    "asymmetry",
    "stops_per_cycle_error",
    "stuck_fraction_error",
    "lyapunov_exponent",
    "lyapunov_exponent_error",
    "also_reachable",
    "sliding_limit",
    "amplitude",
    "sliding_distance",
    "work_friction",
    "work_input",
    "work_damping",
    "equivalent_damping",
    "contact_first_harmonic_amplitude",
    "contact_first_harmonic_phase",
    "beta_lim_modal",
]
OUTPUTS: tuple[str, ...] = get_args(Output)

#: Outputs that have one value per frequency, not one per cell.
CURVE_OUTPUTS = ("beta_lim_modal",)

#: Further outputs of systems with several contacts, springs in contacts, belts or periodic loads.
GeneralOutput = Literal[
    "contact_regime",
    "turns_per_cycle",
    "slips_per_cycle",
    "slip_reversals_per_cycle",
    "elastic_fraction",
    "least_slip",
    "contact_peak_to_peak",
    "contact_midpoint",
    "peak_to_peak",
    "midpoint",
    "work_wall",
    "drift",
    "acceleration_amplitude",
    "base_force",
    "mean_velocity",
    "release_order",
    "segment_crossings",
    "segment_fraction",
    "open_fraction",
    "separations_per_cycle",
    "normal_force_min",
    "normal_force_max",
    "spring_crossings",
    "spring_force_max",
    "unique",
]
GENERAL_OUTPUTS: tuple[str, ...] = get_args(GeneralOutput)

#: Outputs by what they are about, for messages; all others are diagnostics, for experts.
_GROUPS = {
    "regime": (
        *("regime", "contact_regime", "stops_per_cycle", "turns_per_cycle", "stuck_fraction"),
        *("slips_per_cycle", "slip_reversals_per_cycle", "elastic_fraction", "open_fraction"),
        *("separations_per_cycle", "segment_crossings", "segment_fraction", "spring_crossings"),
        *("also_reachable", "sliding_limit", "beta_lim_modal"),
    ),
    "motion": (
        *("contact_amplitude", "amplitude", "contact_peak_to_peak", "contact_midpoint", "peak_to_peak"),
        *("midpoint", "contact_first_harmonic_amplitude", "contact_first_harmonic_phase", "drift"),
        *("acceleration_amplitude", "mean_velocity", "period", "asymmetry", "least_slip"),
    ),
    "forces and energy": (
        *("sliding_distance", "work_friction", "work_input", "work_damping", "work_wall"),
        *("equivalent_damping", "base_force", "normal_force_min", "normal_force_max", "spring_force_max"),
    ),
}


def describe_outputs(names: Iterable[str]) -> str:
    """List outputs in groups."""
    left = list(dict.fromkeys(names))
    parts = []
    for group, members in _GROUPS.items():
        found = [name for name in members if name in left]
        left = [name for name in left if name not in found]
        parts += [f"{group}: {', '.join(found)}"] if found else []
    return "; ".join([*parts, *([f"diagnostics: {', '.join(left)}"] if left else [])])


def unknown_output(name: object, valid: Iterable[str]) -> InputError:
    """The error for an output that does not exist."""
    known = list(valid)
    hint = checks.nearest(name, known) if isinstance(name, str) else ""
    return InputError(
        "outputs", f"must be some of ({describe_outputs(known)}); got {checks.one_line(name)}{hint}"
    )


#: Of these, the ones that systems with one rigid contact under one harmonic load have as well: the solver of
#: general systems records them.
RECORDED: tuple[GeneralOutput, ...] = ("drift", "acceleration_amplitude", "base_force")

#: Variables of the borders between numbers of stops.
BORDERS = ("border_r", "border_beta", "border_kind", "border_mu", "stops_below", "stops_above")

#: Quantities of response curves, in the order of the file.
Quantity = Literal[
    "amplitude", "phase", "first_harmonic", "energy", "harmonics", "transmitted_force", "distortion", "drift",
    "acceleration_amplitude", "base_force",
]  # fmt: skip

#: Default quantities, and default highest harmonic; rounding error grows with the number of harmonics.
QUANTITIES: tuple[Quantity, ...] = ("amplitude", "phase", "first_harmonic", "energy", "harmonics")
HARMONICS = 7

#: Valid range of each numerical setting.
RANGES: dict[str, dict[str, Any]] = {
    "cycles": {"least": 1, "most": 10**9},
    "tolerance": {"least": 1e-15, "most": 1e-3},
    "steps": {"least": 2, "most": 1000},
    "harmonics": {"least": 0, "most": 1000},
}

Start = Literal["rest", "moving"]
Skip = Literal["exact", "none"]
Steady = Literal["solved", "marched"]


@dataclass(frozen=True, repr=False)
class Solver(Shown):
    """Settings of the steady-state solver, and the outputs to keep.

    Parameters
    ----------
    start : {"rest", "moving"}
        Initial state: z = z' = 0 at tau = 0, or a large sliding motion.
    cycles : int
        Maximum number of excitation periods.
    tolerance : float
        Largest change of the state over one recurrence, relative to the amplitude.
    steps : int
        Scan steps per period of the fastest part of the motion, 2 to 1000.  Events are found and computed
        exactly for every value; it affects the speed only.
    skip : {"exact", "none"}
        Integrate only the cells that theory does not decide, or every cell with friction.
    steady : {"solved", "marched"}
        Solve for the periodic orbit, or follow the motion until it repeats.
    outputs : sequence of str
        Cell variables to compute and keep.

    Raises
    ------
    InputError
        A setting is out of range.

    Examples
    --------
    >>> import frictionmap as fm
    >>> solver = fm.Solver(start="moving", outputs=["regime", "amplitude"])
    >>> sorted(fm.sweep(fm.System(), [0.3], [0.5], solver=solver).data_vars)
    ['amplitude', 'beta_lim', 'beta_stick', 'regime']
    """

    start: Start = "rest"
    cycles: int = 2000
    tolerance: float = 1e-12
    steps: int = 24
    skip: Skip = "exact"
    steady: Steady = "solved"
    outputs: Sequence[Output | GeneralOutput] = ("regime", "stops_per_cycle", "contact_amplitude")

    def __post_init__(self) -> None:
        checks.choice(self.start, "start", get_args(Start))
        numbers: dict[str, Callable[..., float]] = {
            "cycles": checks.whole,
            "tolerance": checks.number,
            "steps": checks.whole,
        }
        for name, check in numbers.items():  # kept as plain numbers, which a configuration can hold
            object.__setattr__(self, name, check(getattr(self, name), name, **RANGES[name]))
        checks.choice(self.skip, "skip", get_args(Skip))
        checks.choice(self.steady, "steady", get_args(Steady))
        if isinstance(self.outputs, str) or not isinstance(self.outputs, Sequence):
            raise InputError("outputs", f"must be a list of names; got {checks.one_line(self.outputs)}")
        for name in self.outputs:
            if name not in (*OUTPUTS, *GENERAL_OUTPUTS):
                raise unknown_output(name, (*OUTPUTS, *GENERAL_OUTPUTS))
        if not self.outputs:
            valid = describe_outputs((*OUTPUTS, *GENERAL_OUTPUTS))
            raise InputError("outputs", f"must name at least one of ({valid}); got none")
        object.__setattr__(self, "outputs", tuple(dict.fromkeys(self.outputs)))

    @property
    def of_cells(self) -> "Solver":
        """The settings with outputs of cells only, `status` if there are no others."""
        outputs = tuple(name for name in self.outputs if name not in CURVE_OUTPUTS)
        return self if outputs == self.outputs else replace(self, outputs=outputs or ("status",))

    def _repr_html_(self) -> str:
        rows = {field.name: getattr(self, field.name) for field in fields(self)}
        return as_table("Solver", rows | {"outputs": ", ".join(self.outputs)})


class SolverSettings(TypedDict, total=False):
    """The settings of `Solver` as keywords of `sweep`, for type checkers."""

    start: Start
    cycles: int
    tolerance: float
    steps: int
    skip: Skip
    steady: Steady
    outputs: Sequence[Output | GeneralOutput]


#: Made once: its checks take a fiftieth of a call with four cells.
_DEFAULT = Solver()


def merged(solver: Solver | None, settings: Mapping[str, object]) -> Solver:
    """Return the given solver, or the default one, with single settings replaced."""
    if solver is not None:
        checks.instance(solver, "solver", Solver)
    names = [field.name for field in fields(Solver)]
    for name in settings:
        if name not in names:
            hint = checks.nearest(name, names)
            raise InputError(f"unknown setting {name!r}{hint}; valid: {', '.join(names)}")
    found = solver or _DEFAULT
    return replace(found, **settings) if settings else found  # type: ignore[arg-type]


@dataclass(frozen=True)
class CurveSettings:
    """Quantities of response curves, and the highest harmonic; 0: no harmonics."""

    harmonics: int
    quantities: tuple[Quantity, ...]


def curve_settings(
    harmonics: int | None = None, quantities: Sequence[Quantity] | None = None
) -> CurveSettings:
    """Check and complete the settings of response curves.

    Parameters
    ----------
    harmonics : int, optional
        Highest harmonic to keep, up to 1000; 0: none.  Default 7 where `quantities` contains "harmonics",
        else none.
    quantities : sequence of str, optional
        Default: the first five.  A positive `harmonics` adds "harmonics", 0 removes it.

    Raises
    ------
    InputError
        A quantity is unknown, or none is given, or the number is not an integer in range.
    """
    given = QUANTITIES if quantities is None else quantities
    valid: tuple[Quantity, ...] = get_args(Quantity)
    if isinstance(given, str) or not isinstance(given, Sequence):
        raise InputError("quantities", f"must be a list of names; got {checks.one_line(given)}")
    for name in given:
        checks.choice(name, "quantities", valid)
    if not given:
        raise InputError("quantities", f"must name at least one of {', '.join(valid)}; got none")
    if harmonics is None:
        harmonics = HARMONICS if "harmonics" in given else 0
    harmonics = checks.whole(harmonics, "harmonics", **RANGES["harmonics"])
    kept = {*given, "harmonics"} if harmonics else {*given} - {"harmonics"}
    return CurveSettings(harmonics, tuple(name for name in valid if name in kept))
