"""The keys of a configuration: meaning, default and valid values, as JSON Schema.

`config` refuses keys that are not listed here, `template` writes them with their meanings, and `json_schema`
builds the schema that editors use.  Values are checked by `System`, `Solver`, `curve_settings` and
`checks.axis`, which own the ranges and names quoted here.
"""

from typing import Any, get_args

from .. import checks
from ..datasets.questions import records
from ..model.contact import BANKS, CONTACTS, MOST_CONTACTS, MOST_ELEMENTS
from ..model.friction_law import MOST_POINTS, SHAPES
from ..model.general import BASE_CONTROLS
from ..model.periodic_load import MOST_HARMONICS
from ..model.settings import (
    BORDERS,
    GENERAL_OUTPUTS,
    OUTPUTS,
    RANGES,
    Quantity,
    Skip,
    Solver,
    Start,
    Steady,
    curve_settings,
)
from ..model.spring_element import MOST_KNOTS, MOST_SPRINGS
from ..model.system import DAMPING_REFERENCES, EXCITATIONS, System
from ..units.axes import KINDS
from ..units.dimensions import DIMENSIONS, RATIOS, kinds_of
from ..units.quantities import EXAMPLES
from ..units.scales import OF_MODEL, UNIT_KINDS, WEIGHT, WORDS
from ..units.structures import STRUCTURES
from ..units.table import units_of
from .key import DOF, Key, Schema, axis, either, number, several, table, whole, with_unit, word

#: Smallest and largest valid value of each axis of the grid.
AXES: dict[str, dict[str, float]] = {
    "r": {"least": 0.0, "most": checks.LARGEST_RATIO},
    "beta": {"least": 0.0},
    "mu": {"least": 1.0},
    "wall_speed": {"above": 0.0},
}

_TEXT: Schema = {"type": "string"}
_NAME: Schema = {"type": "string", "minLength": 1}
_RATIOS = several(number(above=0.0), prefixItems=[{"type": "number", "const": 1}])
_SPRINGS = either(
    _RATIOS,
    several(number(above=0.0), prefixItems=[{"type": "number", "const": 0}, {"type": "number", "const": 1}]),
)
_ZETA = number(least=0.0, most=checks.LARGEST_DAMPING)
_MATRIX = several(several(number()))
_MATRICES = either(
    table(
        {"M": _MATRIX, "K": _MATRIX, "C": _MATRIX, "dofs": several(whole(least=1))},
        ("M", "K"),
    ),
    table({"M": _NAME, "K": _NAME, "C": _NAME}, ("M", "K")),
)
_SECTORS = table(
    {
        "count": whole(least=3, most=64),
        "mass": _MATRIX,
        "stiffness": _MATRIX,
        "coupling": either(
            _MATRIX,
            several(
                table(
                    {"masses": several(whole(least=1), 2, maxItems=2), "stiffness": number(above=0.0)},
                    ("masses", "stiffness"),
                )
            ),
        ),
        "engine_order": whole(least=0),
        "spread": table(
            {"standard_deviation": number(above=0.0, most=0.2), "seed": whole(least=0)},
            ("standard_deviation",),
        ),
        "mass_factors": several(number(above=0.0)),
        "stiffness_factors": several(number(above=0.0)),
    },
    ("count", "mass", "stiffness"),
)
_RANGE = "a number, a list, { start, stop, step } or { start, stop, num }, ends included, or { values }"

_ONE_MASS, _SOLVER, _CURVES = System(), Solver(), curve_settings()


def _setting(name: str, meaning: str, valid: Schema) -> Key:
    return Key(name, meaning, valid, getattr(_SOLVER, name))


def _system_key(name: str, meaning: str, valid: Schema, **more: Any) -> Key:
    default = getattr(_ONE_MASS, name)
    return Key(name, meaning, valid, list(default) if isinstance(default, tuple) else default, **more)


def _grid_key(name: str, meaning: str, **more: Any) -> Key:
    return Key(name, meaning, axis("", **AXES[name]), words=_RANGE, **more)


#: What words in the place of a number mean.
_WORDS = {OF_MODEL: "for matrices in SI units", WEIGHT: "that of the first mass, m_1 g"}


def _unit(name: str, meaning: str) -> Key:
    """A number with its unit."""
    kind = UNIT_KINDS[name]
    words = f"a number and one of {', '.join(units_of(kind))}"
    valid = with_unit(kind)
    if name in WORDS:
        words, valid = f'{words}, or "{WORDS[name]}": {_WORDS[WORDS[name]]}', either(valid, word(WORDS[name]))
    return Key(name, meaning, valid, example=f'"{EXAMPLES[kind]}"', words=words)


def _or_unit(valid: Schema, key: str) -> Schema:
    """A number that may have the unit of a key of [system]."""
    return either(valid, *(with_unit(kind) for kind in kinds_of(key)))


_NORMAL = several(
    table(
        {
            "n": whole(least=1, most=MOST_HARMONICS), "amplitude": number(), "phase_deg": number(),
            "re": number(), "im": number(),
        },
        ("n",),
    )
)  # fmt: skip
_LAW_SPEED = _or_unit(number(least=0.0), "contacts[].law.speed")
_LAW = either(
    table(
        {
            "speed": several(_LAW_SPEED, maxItems=MOST_POINTS),
            "factor": several(number(least=0.0), maxItems=MOST_POINTS),
            "slope": number(least=0.0),
        },
        ("speed", "factor"),
    ),
    table(
        {
            "formula": word(*SHAPES),
            "kinetic": number(least=0.0),
            "speed": _LAW_SPEED,
            "viscous": number(least=0.0),
            "error": number(above=0.0),
        },
        ("formula", "kinetic", "speed"),
    ),
)
_MOVING_NORMAL = table(
    {
        "mass": DOF,
        "masses": several(DOF, 2, maxItems=2),
        "vector": several(number()),
        "stiffness": _or_unit(number(above=0.0), "contacts[].normal.stiffness"),
        "friction": number(least=0.0),
        "side": {"enum": [1, -1]},
        "preload": _or_unit(number(), "contacts[].normal.preload"),
    },
    ("stiffness", "friction"),
)
_ELEMENT = table(
    {
        "masses": either(DOF, several(DOF, maxItems=2)),
        "gap": _or_unit(number(least=0.0), "springs[].gap"),
        "backlash": _or_unit(number(above=0.0), "springs[].backlash"),
        "stiffness": _or_unit(number(above=0.0), "springs[].stiffness"),
        "side": {"enum": [1, -1]},
        "displacement": several(_or_unit(number(), "springs[].displacement"), maxItems=MOST_KNOTS),
        "force": several(_or_unit(number(), "springs[].force"), maxItems=MOST_KNOTS),
        "stiffness_below": _or_unit(number(least=0.0), "springs[].stiffness_below"),
        "stiffness_above": _or_unit(number(least=0.0), "springs[].stiffness_above"),
        "name": _NAME,
    }
)
_HARMONIC = {
    **{name: _or_unit(number(), f"load_harmonics[].{name}") for name in ("amplitude", "re", "im")},
    "n": whole(least=1, most=MOST_HARMONICS),
    "mass": DOF,
    "phase_deg": number(),
}


def _elements(key: str, **ends: float) -> Schema:
    """A number of a contact, or a list of them, > 0, for a bank of elements."""
    several_of = several(_or_unit(number(above=0.0), key), maxItems=MOST_ELEMENTS)
    return either(_or_unit(number(**ends), key), several_of)


def _chain(name: str, meaning: str) -> Key:
    """Masses or springs of a chain with their units."""
    kind = DIMENSIONS[name]
    example = f'["{EXAMPLES[kind]}"]'
    words = f"numbers > 0, each with one of {', '.join(units_of(kind))}"
    return Key(name, f"instead of {RATIOS[name]}: {meaning}", several(with_unit(kind)), None, example, words)


def _springs() -> Key:
    """Springs of a chain with their units, or piecewise linear springs."""
    of_chain = _chain("springs", "springs of a chain; the first one connects mass 1 to the ground")
    return of_chain._replace(
        meaning=f"{of_chain.meaning}; or [[system.springs]], piecewise linear springs: one behind a gap, one "
        "with backlash to either side, or forces at displacements",
        valid=either(of_chain.valid, several(_ELEMENT, maxItems=MOST_SPRINGS)),
        words=f"{of_chain.words}; or a list of {{ masses, gap or backlash, stiffness }} or of {{ masses, "
        "displacement, force, stiffness_below, stiffness_above }",
    )


#: Friction of motions in time.
_FRICTION = either(number(least=0.0), with_unit("force"), with_unit("acceleration"))
_FRICTIONS = either(_FRICTION, several(_FRICTION))
_STATIC = either(number(least=1.0), several(number(least=1.0)))


def _spread(kind: str) -> Schema:
    """Numbers with or without a unit: one, a list, or a range with its spacing."""
    value = either(number(least=0.0), with_unit(kind))
    ends = {"start": value, "stop": value, "num": whole(least=2), "spacing": word("linear", "log")}
    return either(value, several(value), table(ends, ("start", "stop", "num")))


_SPREAD_TIME, _SPREAD_FRICTION = _spread("time"), _spread("acceleration")


def _size(kind: str) -> Schema:
    """A number > 0 with or without a unit."""
    return either(number(above=0.0), with_unit(kind))


def _structure(name: str, own: dict[str, Schema]) -> Schema:
    """A table [system.beam] or [system.plate]; `own`: the keys that are not one number > 0."""
    _, measures = STRUCTURES[name]
    return table({**{key: _size(kind) for key, kind in measures.items()}, **own}, ("points",))


_COORDINATE = either(number(least=0.0), with_unit("length"))
_NAMED = {"type": "object", "minProperties": 1}
_FLEXIBLE = {"modes": whole(least=1), "with_residual": {"type": "boolean"}}
_BEAM = _structure(
    "beam",
    {
        **_FLEXIBLE,
        "ends": _NAME,
        "points": {**_NAMED, "additionalProperties": _COORDINATE},
        "end_springs": several(either(number(least=0.0), with_unit("stiffness")), 2, maxItems=2),
        "end_masses": several(either(number(least=0.0), with_unit("mass")), 2, maxItems=2),
    },
)
_PLATE = _structure(
    "plate",
    {
        **_FLEXIBLE,
        "edges": several(word("clamped", "supported", "pinned", "simply-supported", "free"), 4, maxItems=4),
        "size": several(_size("length"), 2, maxItems=2),
        "nu": number(least=0.0, most=0.5),
        "points": {**_NAMED, "additionalProperties": several(_COORDINATE, 2, maxItems=2)},
    },
)
_MODES = either(
    _NAME,
    table({"file": _NAME, "points": several(_NAME), "normalised": word("mass")}, ("file",)),
    table(
        {
            "frequencies": several(either(number(least=0.0), with_unit("frequency"))),
            "damping_ratios": either(_ZETA, several(_ZETA)), "points": several(_NAME), "shapes": _MATRIX,
            "residual": _MATRIX, "compliance": _MATRIX, "modal_masses": several(number(above=0.0)),
            "normalised": word("mass"), "participation": several(number()), "influence": several(number()),
            "base_residual": several(number()),
        },
        ("frequencies", "shapes"),
    ),
)  # fmt: skip

#: Keys of [system] for structures given by modes.
STRUCTURE_KEYS = (
    Key(
        "modes",
        "instead of the ratios: modes of a structure at named points, to which contacts and loads refer",
        _MODES,
        example='{ frequencies = ["31.2 Hz"], points = ["tip"], shapes = [[1.9]], normalised = "mass" }',
        words="{ frequencies, damping_ratios, points, shapes, residual or compliance, and modal_masses or "
        'normalised = "mass"; for records of a base participation, influence, base_residual }; or a file '
        "(.npz, .mat, .csv, .uff), also as { file, points, normalised }",
    ),
    Key(
        "beam",
        "instead of the ratios: a uniform beam in bending; as a table [system.beam]",
        _BEAM,
        example='{ ends = "clamped-free", length = "300 mm", bending_stiffness = "21 N m^2", '
        'mass_per_length = "0.78 kg/m", points = { tip = "300 mm" } }',
        words="{ ends, length, bending_stiffness or E, mass_per_length or density, width and height or "
        "diameter, points = { name = x }, modes, end_springs, end_masses, with_residual }",
    ),
    Key(
        "plate",
        "instead of the ratios: a uniform rectangular plate in bending; as a table [system.plate]",
        _PLATE,
        example='{ edges = ["clamped", "free", "free", "free"], size = ["300 mm", "200 mm"], thickness = '
        '"2 mm", E = "210 GPa", density = "7850 kg/m^3", points = { corner = ["300 mm", "200 mm"] } }',
        words="{ edges, size, thickness, E or bending_stiffness, density or mass_per_area, nu, "
        "points = { name = [x, y] }, modes, with_residual }",
    ),
)

#: Keys of [system] for several contacts, springs in contacts, belts and periodic loads.
GENERAL_KEYS = (
    Key(
        "load_harmonics",
        "instead of load_mass: harmonics of the load over P, sum of amplitude cos(n tau + phase); entries "
        "without mass are harmonics of the base motion",
        several(table(_HARMONIC, ("n",))),
        example="[{ n = 1, mass = 1, amplitude = 1.0 }, { n = 2, mass = 1, amplitude = 0.3 }]",
        words="a list of { n, mass, amplitude, phase_deg }, or re and im instead of amplitude and phase_deg",
    ),
    Key(
        "load_file",
        "instead of load_harmonics: a file that lists them",
        _NAME,
        example='"orders.csv"',
        words="path of a CSV file with the columns n, mass, amplitude, phase_deg",
    ),
    Key(
        "waveform",
        "shape of the load on load_mass, a wave between -P and P",
        _NAME,
        example='"square"',
        words='"square", "sawtooth", "triangle" or the path of a CSV file of one period: time, force',
    ),
    Key("harmonics", "harmonics of the waveform", whole(least=1, most=MOST_HARMONICS), example="20"),
    Key(
        "load_offset",
        "constant force on each mass over P; it moves positions only",
        several(_or_unit(number(), "load_offset")),
        example="[0.4]",
    ),
    Key(
        "contact_stiffness",
        "stiffness of a spring in series with the contact, over k_1; without it: rigid",
        _elements("contact_stiffness", above=0.0),
        example="3.0",
        words="a number > 0, or a list of them: a bank of elements that share the friction equally",
    ),
    Key(
        "wall_velocity",
        "velocity of the wall (a belt) over omega P/k_1",
        _or_unit(number(), "wall_velocity"),
        example="0.2",
        words="a number, or a velocity with its unit, which is a wall_speed",
    ),
    Key(
        "wall_speed",
        "instead: speed of the wall that is the same at all r, over omega_1 P/k_1",
        _or_unit(number(), "wall_speed"),
        example='"0.2 m/s"',
        words="a number, or a velocity with its unit",
    ),
    Key(
        "normal_load",
        "harmonics of the normal load: friction beta nu, nu = 1 + sum of amplitude cos(n tau + phase) >= 0",
        _NORMAL,
        example="[{ n = 1, amplitude = 0.3, phase_deg = 90.0 }]",
        words="a list of { n, amplitude, phase_deg }",
    ),
    Key(
        "contacts",
        "several contacts, instead of contact, contact_masses, contact_stiffness, wall_velocity, normal_load",
        several(
            table(
                {
                    "kind": word(*CONTACTS),
                    "masses": several(DOF, maxItems=2),
                    "ratio": _elements("contacts[].ratio", least=0.0),
                    "force": _elements("contacts[].force", least=0.0),
                    "mu": number(least=1.0),
                    "name": _NAME,
                    "stiffness": _elements("contacts[].stiffness", above=0.0),
                    "bank": word(*BANKS),
                    "wall_velocity": _or_unit(number(), "contacts[].wall_velocity"),
                    "wall_speed": _or_unit(number(), "contacts[].wall_speed"),
                    "normal_load": _NORMAL,
                    "law": _LAW,
                    "law_file": _NAME,
                    "normal": _MOVING_NORMAL,
                },
            ),
            maxItems=MOST_CONTACTS,
        ),
        example='[{ kind = "fixed-wall", masses = [1] }, { kind = "between-masses", masses = [1, 2] }]',
        words="a list of { kind, masses, ratio or force, mu, name, stiffness, bank, wall_velocity or "
        "wall_speed, normal_load, law or law_file, normal }; "
        "lists of stiffness and ratio or force make a bank of elements",
    ),
)


def _design_keys() -> tuple[Key, ...]:
    """The question, and the keys of all questions."""
    known = records()
    names = tuple(record.name for record in known)
    keys = {key.name: key for record in known for key in (*record.needed, *record.optional)}
    return (Key("question", "what to find", word(*names), names[0]), *keys.values())


def _quantity_of_time(kind: str) -> Schema:
    """A number of a record, in seconds or hertz without a unit."""
    return either(number(), with_unit(kind))


#: A value of a record, with or without a unit.
_SIZE = either(number(), *(with_unit(kind) for kind in ("force", "acceleration", "velocity", "length")))


def _record_sources() -> tuple[Key, ...]:
    """Keys of [record] that say where records come from."""
    time, frequency = _quantity_of_time("time"), _quantity_of_time("frequency")
    pulse = {
        "kind": word("rectangle", "triangle", "half-sine", "ricker"), "amplitude": _SIZE, "duration": time,
        "rise": number(least=0.0, most=1.0),
    }  # fmt: skip
    swept = {
        "from": frequency, "to": frequency, "duration": time, "law": word("linear", "log"),
        "amplitude": _SIZE,
    }  # fmt: skip
    made = {
        "kind": word("white", "kanai-tajimi", "clough-penzien", "davenport", "table"), "duration": time,
        "dt": time, "seed": whole(least=0), "count": whole(least=1), "level": number(above=0.0), "rms": _SIZE,
        "peak": _SIZE, "envelope": either(word("trapezoid", "jennings"), {"type": "object"}),
        "frequency": either(frequency, several(frequency, 2)), "damping": number(above=0.0),
        "filter_frequency": frequency, "filter_damping": number(above=0.0),
        "wind_speed": either(number(), with_unit("velocity")), "density": several(number(least=0.0), 2),
    }  # fmt: skip
    return (
        Key("file", "a record over time", _NAME, example='"elcentro.at2"', words="the path of a file"),
        Key(
            "files",
            "several records",
            either(_NAME, several(_NAME)),
            example='"suite/*.AT2"',
            words="a pattern, or a list of paths",
        ),
        Key(
            "pulse",
            "instead of files: a pulse",
            table(pulse, ("kind", "duration")),
            example='{ kind = "half-sine", amplitude = 1.0, duration = 3.0 }',
            words="{ kind, amplitude, duration, rise }; kind is rectangle, triangle, half-sine or ricker",
        ),
        Key(
            "sweep",
            "instead of files: a sine of changing frequency",
            table(swept, ("from", "to", "duration")),
            example="{ from = 0.5, to = 1.5, duration = 500.0 }",
            words="{ from, to, duration, law, amplitude }; law is linear or log",
        ),
        Key(
            "generate",
            "instead of files: random records",
            table(made, ("kind", "duration", "dt")),
            example='{ kind = "white", duration = 100.0, dt = 0.05, rms = 1.0, seed = 1, count = 20 }',
            words="{ kind, duration, dt, seed, count, level or rms or peak, envelope, keys of the kind }",
        ),
    )


def _record_keys() -> tuple[Key, ...]:
    """Keys of [record]: a source, and what is said of it."""
    return (
        *_record_sources(),
        Key(
            "quantity",
            "of the base, or a force; default: by column or format, else acceleration",
            word("force", "acceleration", "velocity", "displacement"),
            example='"acceleration"',
        ),
        Key("unit", "unit of the values; times are then in seconds", _NAME, example='"g"', words="a unit"),
        Key(
            "interpolation",
            "between samples; default: linear, of displacements cubic",
            word("linear", "cubic", "hold"),
            example='"linear"',
        ),
        Key("dt", "time step of a file without times", number(above=0.0), example="0.01"),
        Key(
            "baseline",
            "what is taken off the samples; default: the mean of K-NET files",
            word("none", "mean", "linear"),
            example='"mean"',
        ),
        Key("decimal", "decimal sign of a file of text", word(".", ","), example='","'),
        Key(
            "columns",
            "columns of a table by time and the quantities",
            {"type": "object"},
            example='{ acceleration = "a_g" }',
            words="as data.columns",
        ),
        Key("mass", "the mass that a force acts on; default: load_mass", DOF, example="2"),
        Key(
            "vector",
            "instead of mass: shares of a force on all masses",
            several(number()),
            example="[1.0, 0.5]",
        ),
        Key(
            "peak",
            "largest absolute value that every record is scaled to",
            _SIZE,
            example='"0.4 g"',
            words='a number, or with a unit, such as "0.4 g"',
        ),
        Key(
            "scale",
            "factors of the records",
            either(number(), several(number())),
            1.0,
        ),
        Key(
            "after",
            "how long the motion is followed after the record",
            either(word("rest"), number(least=0.0)),
            "rest",
            words='"rest", or a time',
        ),
    )


#: Keys by table; "" is no table.
KEYS: dict[str, tuple[Key, ...]] = {
    "": (Key("title", "title of plots and files", _TEXT, example='"A title"'),),
    "system": (
        _system_key("contact", "kind of contact", word(*CONTACTS)),
        _system_key(
            "contact_masses",
            "the mass in contact, or for between-masses the two masses A < B; counted from 1",
            several(DOF, maxItems=2),
            words='a list of one or two whole numbers >= 1, or of labels of a file, "NODE.DOF"',
        ),
        _system_key(
            "load_mass",
            "the mass on which the harmonic load acts, counted from 1",
            DOF,
            words='a whole number >= 1, or a label of a file, "NODE.DOF"',
        ),
        Key(
            "load",
            "instead of load_mass: the load on every mass, divided by P",
            several(either(_or_unit(number(), "load"), several(_or_unit(number(), "load"), 2, maxItems=2))),
            example="[1.0]",
            words="for every mass a number or [real part, imaginary part]",
        ),
        _system_key(
            "mass_ratios",
            "gamma_i = m_i/m_1 of a chain; the first is 1",
            _RATIOS,
            words="numbers > 0",
        ),
        _system_key(
            "stiffness_ratios",
            "kappa_i = k_i/k_1 of a chain; the first is 1; spring 1 connects mass 1 to the ground; 0: there "
            "is none, and the second is 1",
            _SPRINGS,
            words="numbers > 0; the first may be 0",
        ),
        _chain("masses", "masses of a chain; the first one is units.mass"),
        _springs(),
        Key(
            "dampers",
            "instead of damping_ratios: dashpots of a chain over sqrt(k_1 m_1), each beside its spring",
            several(_or_unit(number(least=0.0), "dampers")),
            example="[0.02]",
        ),
        Key(
            "damping_ratios",
            "damping ratio zeta of all modes, or a list with one value per mode",
            either(_ZETA, several(_ZETA)),
            0.0,
            words=f"numbers from 0 to {checks.LARGEST_DAMPING:g}",
        ),
        Key(
            "matrices",
            "instead of the ratios: matrices M, K and, instead of damping_ratios, C of any structure",
            either(_NAME, _MATRICES),
            example='"frame.npz"',
            words='path of a file with all of them, or { M = "m.mtx", K = "k.mtx" }, or { M = [[...]], ... }',
        ),
        Key(
            "sectors",
            "instead of the ratios: a ring of sectors, each given once, under a load that travels round",
            _SECTORS,
            example="{ count = 24, mass = [[1.0]], stiffness = [[1.0]], "
            "coupling = [{ masses = [1, 1], stiffness = 0.5 }], engine_order = 2 }",
            words="{ count, mass, stiffness, coupling, engine_order, spread, mass_factors, "
            "stiffness_factors }; "
            'contacts and loads are those of a sector, and "next.1" is mass 1 of the next',
        ),
        Key(
            "reduce",
            "with matrices: reduce them to contacts, loads, the degrees of freedom to keep and some modes",
            table(
                {
                    "keep": several(DOF, 0),
                    "modes": whole(least=0),
                    "allow": number(above=0.0, most=1.0),
                },
                ("modes",),
            ),
            example="{ keep = [17, 112], modes = 16 }",
            words="{ keep, modes, allow }; allow is the largest relative error (default 0.001)",
        ),
        Key(
            "rayleigh",
            "with matrices, instead of damping_ratios: [a, b] of C = a M + b K",
            several(
                number(least=0.0),
                2,
                maxItems=2,
                prefixItems=[_or_unit(number(least=0.0), f"rayleigh[{k}]") for k in (1, 2)],
            ),
            example="[0.1, 1e-5]",
            words="two numbers >= 0",
        ),
        Key(
            "decouple",
            "if C couples the modes: use its diagonal if linear responses change by no more than this",
            number(above=0.0, most=1.0),
            example="0.02",
        ),
        Key(
            "frequency_scale",
            "with matrices: frequency at r = 1, in units of sqrt(K/M); default: first natural frequency",
            _or_unit(number(above=0.0), "frequency_scale"),
            example="12.3",
        ),
        Key(
            "stiffness_scale",
            "with matrices: displacements are in units of P/stiffness_scale; given in the units of K",
            _or_unit(number(above=0.0), "stiffness_scale"),
            1.0,
        ),
        _system_key(
            "excitation",
            "excitation by a force or by the base; a joined base-wall always has base excitation",
            word(*EXCITATIONS),
        ),
        _system_key(
            "damping_reference",
            "damping acts on velocities relative to the ground, or relative to a moving base",
            word(*DAMPING_REFERENCES),
        ),
        _system_key(
            "base_control",
            "what the moving base holds constant over frequency; its amplitude is Y/r^2 for acceleration",
            word(*BASE_CONTROLS),
        ),
        *STRUCTURE_KEYS,
        *GENERAL_KEYS,
    ),
    "grid": (
        Key(
            "r",
            "frequency ratio: excitation frequency over sqrt(k_1/m_1), or over frequency_scale",
            axis(KINDS["r"], **AXES["r"]),
            example="1.0",
            words=_RANGE,
        ),
        Key(
            "beta",
            "friction ratio: kinetic friction force over load amplitude",
            axis(KINDS["beta"], **AXES["beta"]),
            example="1.0",
            words=_RANGE,
        ),
        Key(
            "friction_coefficient",
            "instead of beta: friction force over units.normal_force",
            axis("", **AXES["beta"]),
            example="{ start = 0.0, stop = 0.5, step = 0.05 }",
            words=_RANGE,
        ),
        _grid_key("mu", "static-to-kinetic friction ratio, >= 1", default=[1.0]),
        Key(
            "wall_speed",
            "instead of r, without a load: speed of the belt over omega_1 P/k_1",
            axis("velocity", **AXES["wall_speed"]),
            example="{ start = 0.05, stop = 1.5, num = 100 }",
            words=_RANGE,
        ),
    ),
    "solver": (
        _setting(
            "start",
            "initial state: at rest or in a large sliding motion",
            word(*get_args(Start)),
        ),
        _setting("cycles", "maximum number of excitation periods", whole(**RANGES["cycles"])),
        _setting(
            "tolerance",
            "for experts: tolerance on the change of the state over one period",
            number(**RANGES["tolerance"]),
        ),
        _setting("steps", "for experts: scan steps per period; affects speed only", whole(**RANGES["steps"])),
        _setting(
            "skip",
            'for experts: skip cells that a proof decides ("exact"), or integrate every cell with friction '
            '("none")',
            word(*get_args(Skip)),
        ),
        _setting(
            "steady",
            "for experts: solve for the periodic orbit, or integrate until the motion repeats",
            word(*get_args(Steady)),
        ),
        Key(
            "outputs",
            "output variables of every cell; border_r: also the borders between numbers of stops",
            several(word(*OUTPUTS, *GENERAL_OUTPUTS, *BORDERS)),
            list(_SOLVER.outputs),
        ),
    ),
    "curves": (
        Key(
            "quantities",
            "output variables of response curves",
            several(word(*get_args(Quantity))),
            list(_CURVES.quantities),
        ),
        Key("harmonics", "highest harmonic; 0: none", whole(**RANGES["harmonics"]), _CURVES.harmonics),
    ),
    "design": _design_keys(),
    "record": _record_keys(),
    "history": (
        Key(
            "beta",
            "friction ratios; with [units] also forces, or accelerations of friction over m_1",
            _FRICTIONS,
            example="[0.2]",
            words='a number >= 0, or with a unit of force or acceleration, such as "0.05 g"; or a list',
        ),
        Key(
            "friction",
            "another name of beta",
            _FRICTIONS,
            example='["0.05 g"]',
            words="as beta",
        ),
        Key(
            "mu",
            "ratios of static to kinetic friction",
            _STATIC,
            1.0,
        ),
        Key(
            "start",
            "the state at the beginning",
            either(_NAME, table({name: several(number()) for name in ("x", "v", "q", "q_rate")})),
            "rest",
            words='"rest", { x, v } with a number per mass, { q, q_rate } with one per given mode, or the '
            "file of a motion",
        ),
        Key(
            "samples",
            "which samples of histories are kept",
            either(word("all", "none"), whole(least=1)),
            "all",
            words='"all", "none", or a number of samples from one to the next',
        ),
        Key(
            "statistics",
            "mean, variance and peak over the time of the record, with errors by batch means",
            table(
                {
                    "start": either(number(least=0.0), with_unit("time")),
                    "window": either(number(above=0.0), with_unit("time")),
                    "batches": whole(least=4),
                }
            ),
            example="{ start = 50.0 }",
            words="{ start, window, batches }: time left out, length of windows of the peak, batches (20)",
        ),
    ),
    "spectrum": (
        Key(
            "contact_stiffness",
            "stiffness of a spring in series with the contact, over that of the mass's spring",
            number(above=0.0),
            example="5.0",
        ),
        Key(
            "period",
            "natural periods, in the unit of time of the records",
            _SPREAD_TIME,
            example="[1.0]",
            words="a number, a list or { start, stop, num, spacing }; spacing is linear or log",
        ),
        Key(
            "friction",
            "friction over the mass",
            _SPREAD_FRICTION,
            example='["0.05 g"]',
            words="as period; with a unit of acceleration if the records have a unit",
        ),
        Key("beta", "another name of friction", _SPREAD_FRICTION, example="[0.05]", words="as friction"),
        Key(
            "mu",
            "ratios of static to kinetic friction",
            _STATIC,
            1.0,
        ),
        Key("damping", "damping ratio", number(least=0.0), 0.0),
        Key(
            "quantities",
            "output variables",
            several(
                word(
                    "amplitude",
                    "acceleration_amplitude",
                    "residual",
                    "sliding_distance",
                    "stops",
                    "turns",
                    "asleep_time",
                )
            ),
            example='["amplitude", "residual"]',
        ),
    ),
    "units": (
        _unit("natural_frequency", "frequency at r = 1: sqrt(k_1/m_1)/(2 pi), or frequency_scale/(2 pi)"),
        _unit("load", "friction force at beta = 1: the load amplitude P, or k_1 Y for base excitation"),
        _unit("base_amplitude", "instead of the load: base displacement amplitude Y"),
        _unit(
            "base_acceleration",
            "instead of the load: base acceleration at acceleration_frequency",
        ),
        _unit("acceleration_frequency", "frequency of base_acceleration"),
        _unit("stiffness", "k_1, or stiffness_scale: displacements are in units of P/k_1"),
        _unit("mass", "m_1 of a chain, in place of the stiffness or of the natural frequency"),
        _unit("normal_force", "normal force in the contact, for grid.friction_coefficient"),
    ),
}

#: Descriptions of the tables.
TABLES = {
    "system": "The structure, its contact and its load.",
    "grid": "The grid of the map: r, beta, and one map per mu.",
    "solver": "How steady states are found, and the output variables.",
    "curves": "For `frictionmap curves` only, which takes a short list of beta.",
    "design": "For `frictionmap design` only: which friction to choose.",
    "record": "For `frictionmap history`: loads or motions of the base over time.",
    "history": "For `frictionmap history`: friction, start, and what is kept.",
    "spectrum": "For `frictionmap spectrum`: one mass under the records, over its natural period.",
    "units": "Optional: reference values that convert ratios to Hz and N; [grid] may then use these units.",
    "axes": "Further axes: values of [system] that vary, one per axis, or several together from a CSV file.",
}


def names(section: str) -> tuple[str, ...]:
    """List the names of the keys of a table."""
    return tuple(key.name for key in KEYS[section])
