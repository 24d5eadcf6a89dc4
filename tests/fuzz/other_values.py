"""Changes of the numbers in a file."""

import math
import random

import numpy as np

from .contents import Content, Mutation, pick

_NUMBERS = (math.nan, math.inf, -math.inf, 1e308, -1e308, 5e-324, -0.0, 0.0, -1.0, 1e9, 0.5, 127.0, 1e-9)


def _put(content: Content, rng: random.Random, name: str, some: bool) -> str:
    v = content.variables[name]
    if v.data.dtype.kind not in "iuf" or v.data.size == 0:
        return "unchanged"
    value: float | int = rng.choice(_NUMBERS)
    if v.data.dtype.kind != "f":
        bounds = np.iinfo(v.data.dtype)
        value = rng.choice([bounds.min, bounds.max, 3, 5, 7, bounds.max // 2])
    data = np.array(v.data)
    with np.errstate(all="ignore"):
        if some:
            for _ in range(rng.choice([1, 2, 3])):
                data.reshape(-1)[rng.randrange(data.size)] = value
        else:
            data[...] = value
    v.data = data
    return f"{name}: {'some' if some else 'all'} {value}"


def _some(content: Content, rng: random.Random) -> str:
    return _put(content, rng, pick(content, rng), some=True)


def _all(content: Content, rng: random.Random) -> str:
    return _put(content, rng, pick(content, rng), some=False)


def _axis_value(content: Content, rng: random.Random) -> str:
    axes = [name for name, v in content.variables.items() if v.dims == (name,)]
    return _put(content, rng, rng.choice(axes), some=rng.random() < 0.8)


def _reverse(content: Content, rng: random.Random) -> str:
    name = pick(content, rng, 1)
    v = content.variables[name]
    v.data = v.data[::-1]
    return f"{name} reversed"


def _shuffle(content: Content, rng: random.Random) -> str:
    name = pick(content, rng, 1)
    v = content.variables[name]
    flat = v.data.reshape(-1).tolist()
    rng.shuffle(flat)
    v.data = np.array(flat, v.data.dtype).reshape(v.data.shape)
    return f"{name} shuffled"


def _scale(content: Content, rng: random.Random) -> str:
    name, by = pick(content, rng), rng.choice([-1.0, 1e6, 1e-6, 0.0, 1e300])
    v = content.variables[name]
    if v.data.dtype.kind != "f":
        return "unchanged"
    with np.errstate(all="ignore"):
        v.data = (v.data * by).astype(v.data.dtype)
    return f"{name} times {by:g}"


VALUES: tuple[Mutation, ...] = (_some, _all, _axis_value, _reverse, _shuffle, _scale)
