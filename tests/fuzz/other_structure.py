"""Changes of the structure of a file: names, dimensions, types, attributes."""

import math
import random

import numpy as np

from .contents import Content, Mutation, Variable, pick


def _drop(content: Content, rng: random.Random) -> str:
    name = pick(content, rng)
    del content.variables[name]
    return f"{name} left out"


def _keep_one(content: Content, rng: random.Random) -> str:
    name = pick(content, rng)
    content.variables = {name: content.variables[name]}
    return f"only {name} left"


def _rename(content: Content, rng: random.Random) -> str:
    name = pick(content, rng)
    new = rng.choice([f"{name}_", "x", "Regime", "r", "beta", "mu", "tau", "dof", "regime", "z", "status"])
    content.variables = {new if key == name else key: v for key, v in content.variables.items()}
    return f"{name} called {new}"


def _swap_names(content: Content, rng: random.Random) -> str:
    one, other = pick(content, rng), pick(content, rng)
    found = content.variables
    found[one], found[other] = found[other], found[one]
    return f"{one} and {other} swapped"


def _rename_dim(content: Content, rng: random.Random) -> str:
    dims = sorted({dim for v in content.variables.values() for dim in v.dims})
    old, new = rng.choice(dims), rng.choice(["x", "r", "beta", "mu", "tau", "dof", "event", "mode"])
    for name, v in content.variables.items():
        taken = tuple(new if dim == old else dim for dim in v.dims)
        content.variables[name] = Variable(taken, v.data, v.attrs)
    return f"dimension {old} called {new}"


def _rename_own_dim(content: Content, rng: random.Random) -> str:
    name = pick(content, rng, 1)
    v = content.variables[name]
    place = rng.randrange(len(v.dims))
    v.dims = (*v.dims[:place], rng.choice(["x", "r", "beta", "mu", "tau"]), *v.dims[place + 1 :])
    return f"{name} on {v.dims}"


def _transpose(content: Content, rng: random.Random) -> str:
    name = (
        pick(content, rng, 2)
        if any(len(v.dims) > 1 for v in content.variables.values())
        else pick(content, rng)
    )
    v = content.variables[name]
    order = list(range(len(v.dims)))
    rng.shuffle(order)
    v.dims, v.data = tuple(v.dims[k] for k in order), v.data.transpose(order)
    return f"{name} transposed to {v.dims}"


def _extra_dim(content: Content, rng: random.Random) -> str:
    name = pick(content, rng)
    v = content.variables[name]
    v.dims, v.data = ("extra", *v.dims), np.stack([v.data] * rng.choice([1, 2]))
    return f"{name} with a dimension more"


def _fewer_dims(content: Content, rng: random.Random) -> str:
    name = pick(content, rng, 1)
    v = content.variables[name]
    v.dims, v.data = v.dims[1:], v.data[0]
    return f"{name} without {v.dims}"


def _shorter(content: Content, rng: random.Random) -> str:
    name = pick(content, rng, 1)
    v = content.variables[name]
    v.data = v.data[: rng.randrange(len(v.data))]
    return f"{name} cut to {v.data.shape}"


def _shorter_dim(content: Content, rng: random.Random) -> str:
    dim = rng.choice(sorted({dim for v in content.variables.values() for dim in v.dims}))
    left = rng.choice([0, 1, 2])
    for v in content.variables.values():
        if dim in v.dims:
            v.data = v.data.take(range(min(left, v.data.shape[v.dims.index(dim)])), axis=v.dims.index(dim))
    return f"{left} of {dim}"


def _retype(content: Content, rng: random.Random) -> str:
    name = pick(content, rng)
    kind = rng.choice(["i1", "u1", "i4", "i8", "u8", "f4", "f8", "S1", "U", ">f8", ">i2"])
    v = content.variables[name]
    with np.errstate(all="ignore"):
        v.data = (
            np.vectorize(str, otypes=[object])(v.data) if kind == "U" else np.asarray(v.data).astype(kind)
        )
    return f"{name} as {kind}"


def _drop_attribute(content: Content, rng: random.Random) -> str:
    name = rng.choice([None, *content.variables])
    attrs = content.attrs if name is None else content.variables[name].attrs
    if not attrs:
        return "unchanged"
    key = rng.choice(sorted(attrs))
    del attrs[key]
    return f"{name or 'file'} without {key}"


_ODD_ATTRIBUTES = (
    "", "x" * 3000, "a\nb", "\x1b[31m", "€", 1, -1.5, math.nan, np.arange(3), np.array([1.5, math.inf]),
    np.int8(3), "nan",
    "flag", np.array([], "i4"),
)  # fmt: skip


def _odd_attribute(content: Content, rng: random.Random) -> str:
    name = rng.choice([None, *content.variables])
    attrs = content.attrs if name is None else content.variables[name].attrs
    usual = ("title", "source", "config", "system", "history", "Conventions") if name is None else (
        "units", "long_name", "flag_values", "flag_meanings", "flag_masks", "_FillValue", "scale_factor",
        "add_offset",
        "missing_value", "calendar", "valid_range", "coordinates", "dtype",
    )  # fmt: skip
    key, value = rng.choice([*usual, *attrs]), rng.choice(_ODD_ATTRIBUTES)
    attrs[key] = value
    return f"{name or 'file'}: {key} = {str(value)[:30]!r}"


def _time_units(content: Content, rng: random.Random) -> str:
    name = pick(content, rng)
    units = rng.choice(["days since 2000-01-01", "seconds since never", "days", "hours since 1-1-1"])
    content.variables[name].attrs["units"] = units
    return f"{name} in {units}"


def _foreign_variable(content: Content, rng: random.Random) -> str:
    name = rng.choice(
        ["regime", "status", "extra", "amplitude", "multiplier", "beta_lim", "z", "phase", "also_reachable"]
    )
    data = rng.choice([np.zeros(3), np.array(1.0), np.array("text", object), np.zeros((2, 2), "i4")])
    content.variables[name] = Variable(tuple(f"n{k}" for k in range(data.ndim)), data)
    return f"a foreign {name} of shape {data.shape}"


STRUCTURE: tuple[Mutation, ...] = (
    _drop, _keep_one, _rename, _swap_names, _rename_dim, _rename_own_dim, _transpose, _extra_dim,
    _fewer_dims, _shorter,
    _shorter_dim, _retype, _drop_attribute, _odd_attribute, _time_units, _foreign_variable,
)  # fmt: skip
