"""Cyclic structures: a ring of sectors, each given once, under a load that travels round them.

    M = I x M_0,   K = I x K_0 + P x K_1 + P^T x K_1^T,   p_j = p_0 e^{2 pi i n k j/N}

P turns by one sector; k is the engine order and n the order of a harmonic.  A contact of a sector is repeated
in all of them.
"""

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from .. import checks
from ..errors import InputError
from .contact import Contact
from .periodic_load import ENTRY_KEYS, check_entry, order, phasor
from .system import System

#: Keys of a ring, and those of a spring between a sector and the next.
KEYS = (
    "count",
    "mass",
    "stiffness",
    "coupling",
    "engine_order",
    "spread",
    "mass_factors",
    "stiffness_factors",
)
SPRING_KEYS = ("masses", "stiffness")
SPREAD_KEYS = ("standard_deviation", "seed")

#: With two sectors, the one before and the one behind are the same.
_FEWEST, _MOST = 3, 64

#: What a mass of the next sector is called in the contact of a sector.
_NEXT = "next."

#: Keys that define another structure or a load that does not travel.
_OTHERS = (
    "matrices", "mass_ratios", "stiffness_ratios", "masses", "springs", "dampers", "reduce", "load_file",
    "waveform",
)  # fmt: skip


def ring(**keys: Any) -> System:
    """The system of a cyclic structure that is given by one sector.

    Parameters
    ----------
    sectors : mapping
        ``count`` N, 3 to 64; ``mass`` and ``stiffness``, M_0 and K_0, shape (n, n), in consistent units;
        ``coupling``: a list of springs ``{"masses": [a, b], "stiffness": k}`` from mass a of each sector to
        mass b of the next, or the block K_1 (n, n) of K between a sector (rows) and the next (columns), whose
        share in the diagonal is part of ``stiffness``; ``engine_order`` k, default 1.  Mistuned rings:
        ``mass_factors``, ``stiffness_factors``, one number a sector, or ``spread``, a mapping of
        ``standard_deviation`` and ``seed``: the relative spread of the frequencies of single sectors.
    contacts : sequence of Contact or mapping
        The contacts of one sector.  Their masses are those of a sector, counted from 1; "next.1" is mass 1 of
        the next sector.
    load_mass, load, load_harmonics : optional
        The load on one sector, as in `System`; on sector j (from 0) its phasors of order n have the factor
        e^{2 pi i n k j/N}.
    **keys
        Further keys of `System`.  Masses are called "sector.mass", such as "3.1".

    Returns
    -------
    System

    Raises
    ------
    InputError
        A key is missing, unknown, or does not fit to sectors.

    Examples
    --------
    Six blades on springs of their own, coupled by softer ones, that rub on each other:

    >>> import frictionmap as fm
    >>> blades = fm.ring(
    ...     sectors={
    ...         "count": 6,
    ...         "mass": [[1.0]],
    ...         "stiffness": [[1.0]],
    ...         "coupling": [{"masses": [1, 1], "stiffness": 0.1}],
    ...     },
    ...     contacts=[fm.Contact("between-masses", [1, "next.1"])],
    ...     damping_ratios=0.01,
    ... )
    >>> blades.n, len(blades.contacts)
    (6, 6)
    """
    return System(**in_full(keys))


def in_full(given: Mapping[str, Any]) -> dict[str, Any]:
    """The keys of `System` for keys of a ring: matrices, contacts and load of all sectors."""
    keys = dict(given)
    sectors = _checked_table(keys.pop("sectors", None), "sectors", KEYS)
    for name in _OTHERS:
        if keys.get(name) is not None:
            raise InputError("cannot use", name, "with sectors: they define the structure; omit one")
    if keys.get("excitation") == "base":
        raise InputError("excitation", "must be force with sectors, whose load travels round; got 'base'")
    count = checks.whole(_needed(sectors, "count"), "sectors.count", least=_FEWEST, most=_MOST)
    mass, stiffness = (_square(_needed(sectors, name), f"sectors.{name}") for name in ("mass", "stiffness"))
    n = len(mass)
    if len(stiffness) != n:
        raise InputError(
            "sectors.stiffness", f"must have the shape of mass, ({n}, {n}); got {stiffness.shape}"
        )
    factors = _factors(sectors, count)
    matrices: dict[str, Any] = {"M": np.kron(np.diag(factors[0]), mass)}
    matrices["K"] = np.kron(np.diag(factors[1]), stiffness)
    matrices["K"] += _coupled(sectors.get("coupling", ()), count, n)
    matrices["dofs"] = [f"{j}.{i}" for j in range(1, count + 1) for i in range(1, n + 1)]
    turn = checks.whole(sectors.get("engine_order", 1), "sectors.engine_order", least=0)
    keys |= _travelling(keys, n, [2.0 * math.pi * (turn * j % count) / count for j in range(count)])
    keys["matrices"] = matrices
    keys["contacts"] = _repeated(keys.get("contacts"), count, n)
    return keys


def _checked_table(given: object, name: str, valid: Sequence[str]) -> Mapping[str, Any]:
    if not isinstance(given, Mapping):
        raise InputError(name, f"must be a table of {', '.join(valid)}; got {checks.one_line(given)}")
    for key in given:
        if key not in valid:
            hint = checks.nearest(str(key), valid)
            raise InputError(f"unknown key {f'{name}.{key}'!r}{hint}; valid: {', '.join(valid)}")
    return given


def _needed(sectors: Mapping[str, Any], name: str) -> Any:
    if name not in sectors:
        raise InputError(f"sectors.{name}", "must be given; got none")
    return sectors[name]


def _square(given: Any, name: str) -> np.ndarray:
    found = checks.array(given, name)
    if found.dtype.kind not in "iuf" or found.ndim != 2 or found.shape[0] != found.shape[1]:
        raise InputError(name, f"must be a square matrix of numbers; got {checks.one_line(given)}")
    return found.astype(float)


def _factors(sectors: Mapping[str, Any], count: int) -> np.ndarray:
    """Factors (2, N) of the masses and of the stiffnesses of the sectors."""
    found = np.ones((2, count))
    for row, name in zip(found, ("mass_factors", "stiffness_factors"), strict=True):
        given = sectors.get(name)
        if given is None:
            continue
        if not isinstance(given, Sequence) or len(given) != count:
            raise InputError(
                f"sectors.{name}", f"must have one number per sector ({count}); got {checks.one_line(given)}"
            )
        row[:] = [checks.number(one, f"sectors.{name}[{k}]", above=0.0) for k, one in enumerate(given)]
    if "spread" in sectors:
        spread = _checked_table(sectors["spread"], "sectors.spread", SPREAD_KEYS)
        width = checks.number(
            spread.get("standard_deviation"), "sectors.spread.standard_deviation", above=0.0, most=0.2
        )
        seed = checks.whole(spread.get("seed", 1), "sectors.spread.seed", least=0)
        found[1] *= (1.0 + width * np.random.default_rng(seed).standard_normal(count)) ** 2
    return found


def _coupled(given: Any, count: int, n: int) -> np.ndarray:
    """Stiffness of all springs between neighbours, or of the blocks between them."""
    whole = np.zeros((count, n, count, n))
    following = [(j + 1) % count for j in range(count)]
    name = "sectors.coupling"
    if not isinstance(given, (Sequence, np.ndarray)) or isinstance(given, str):
        raise InputError(name, f"must be a list of {{ masses, stiffness }}; got {checks.one_line(given)}")
    if not all(isinstance(one, Mapping) for one in given):
        block = _square(given, name)
        if len(block) != n:
            raise InputError(name, f"must have the shape of mass, ({n}, {n}); got {block.shape}")
        for j, other in enumerate(following):
            whole[j, :, other] += block
            whole[other, :, j] += block.T
        return whole.reshape(count * n, count * n)
    for k, one in enumerate(given, 1):
        spring = _checked_table(one, f"{name}[{k}]", SPRING_KEYS)
        masses = spring.get("masses", ())
        if not isinstance(masses, Sequence) or len(masses) != 2:
            raise InputError(f"{name}[{k}].masses", f"must be [A, B], B in the next sector; got {masses!r}")
        a, b = (checks.whole(one, f"{name}[{k}].masses", least=1, most=n) - 1 for one in masses)
        stiffness = checks.number(spring.get("stiffness"), f"{name}[{k}].stiffness", above=0.0)
        for j, other in enumerate(following):
            whole[j, a, j, a] += stiffness
            whole[other, b, other, b] += stiffness
            whole[j, a, other, b] -= stiffness
            whole[other, b, j, a] -= stiffness
    return whole.reshape(count * n, count * n)


def _travelling(keys: Mapping[str, Any], n: int, angles: Sequence[float]) -> dict[str, Any]:
    """The load on all sectors, for the load on one of them and the phase of each, at order 1."""
    one = _sector_load(keys, n)
    harmonics = {
        each: np.concatenate([vector * cmath.exp(1j * each * angle) for angle in angles])
        for each, vector in one.items()
    }
    found: dict[str, Any] = {"load_mass": None, "load": None, "load_harmonics": None}
    if keys.get("load_offset") is not None:
        found["load_offset"] = list(keys["load_offset"]) * len(angles)
    if list(harmonics) == [1]:
        return {**found, "load": harmonics[1]}
    return {**found, "load_harmonics": harmonics}


def _sector_load(keys: Mapping[str, Any], n: int) -> dict[int, np.ndarray]:
    """Phasors of the load on the masses of a sector, by order."""
    load, given = keys.get("load"), keys.get("load_harmonics")
    if load is not None:
        vector = checks.array(load, "load").astype(complex)
        if vector.shape != (n,):
            raise InputError("load", f"must have one number per mass of a sector ({n}); got {vector.size}")
        return {1: vector}
    if given is None:
        given_mass = keys.get("load_mass")
        mass = checks.whole(1 if given_mass is None else given_mass, "load_mass", least=1, most=n)
        return {1: np.eye(n)[mass - 1]}
    if not isinstance(given, Sequence):
        raise InputError(
            "load_harmonics",
            f"must be a list of {{ n, mass, amplitude, phase_deg }} with sectors; "
            f"got {checks.one_line(given)}",
        )
    found: dict[int, np.ndarray] = {}
    for k, one in enumerate(given):
        name = f"load_harmonics[{k}]"
        entry = check_entry(one, name, ENTRY_KEYS)
        mass = checks.whole(entry.get("mass", 1), f"{name}.mass", least=1, most=n)
        vector = found.setdefault(order(entry["n"], f"{name}.n"), np.zeros(n, complex))
        vector[mass - 1] += phasor(entry, name)
    return found


def _repeated(given: object, count: int, n: int) -> list[dict[str, Any]]:
    """The contacts of all sectors; those of one kind one after the other."""
    if not isinstance(given, Sequence) or isinstance(given, str) or not given:
        raise InputError("contacts", f"must list the contacts of a sector; got {checks.one_line(given)}")
    found = []
    for k, one in enumerate(given, 1):
        keys = _keys_of(one, k)
        if keys.get("normal") is not None:
            raise InputError(
                "cannot use",
                f"contacts[{k}].normal",
                "with sectors: it is not repeated in them; omit it",
            )
        masses = keys.get("masses", (1,))
        masses = [masses] if isinstance(masses, (int, str)) else list(masses)
        for j in range(count):
            numbers = [_mass(mass, j, count, n, f"contacts[{k}].masses") for mass in masses]
            name = None if keys.get("name") is None else f"{keys['name']} {j + 1}"
            found.append({**keys, "masses": sorted(numbers), "name": name})
    return found


def _keys_of(one: object, k: int) -> dict[str, Any]:
    if isinstance(one, Contact):
        one = {key.name: getattr(one, key.name) for key in fields(Contact) if key.init}
    if not isinstance(one, Mapping):
        raise InputError(f"contacts[{k}]", f"must be a Contact; got {checks.one_line(one)}")
    return dict(one)


def _mass(given: object, j: int, count: int, n: int, name: str) -> int:
    """Number of a mass of sector j, or of the next one, in the whole ring."""
    sector, text = j, given
    if isinstance(given, str) and given.startswith(_NEXT):
        sector, text = (j + 1) % count, given.removeprefix(_NEXT)
        text = int(text) if text.isdecimal() else given
    return sector * n + checks.whole(text, name, least=1, most=n)
