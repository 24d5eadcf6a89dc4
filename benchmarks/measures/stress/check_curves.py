"""Checks of response functions and boundaries at single frequencies, against 40 digits."""

import math
from collections.abc import Callable, Iterable, Iterator
from functools import partial

import frictionmap as fm

from ...references import closed_forms
from ...references.closed_forms import Number, mp
from .bodies import FEW, Body
from .group import Group, watched


def _curve_values(
    body: closed_forms.Structure, r: Number, mu: float, tau: Number = None
) -> tuple[dict, Number]:
    found = closed_forms.functions(body, r, tau)
    values = {
        "V": abs(found.v), "U": found.u, "G": found.g, "H": found.h, "S": found.s,
        "beta_lim": closed_forms.beta_lim(body, r, mu, found),
    }  # fmt: skip
    return values, found.tau


def check_curves(
    group: Group, body: Body, points: Iterable[tuple[int | None, float]], mu: float = 1.0
) -> None:
    """Check V, U, G, H, S, beta_lim and beta_stick at points (k, r)."""
    own = body.own
    for k, r in points:
        what = f"{body.name}, r = {r!r}"
        ds = watched(group, what, partial(fm.boundaries, body.system, [r], mu), 1)
        if ds is None:
            continue
        group.cells += 1
        exact, tau = _curve_values(own, r, mu)
        got = {name: float(ds[name].values.ravel()[0]) for name in ("U", "G", "H", "S", "beta_lim")}
        got["V"] = math.hypot(float(ds.V.item()), float(ds.V_imag.item()))
        for name, value in got.items():
            group.compare(
                f"{name}: {what}", k, value, exact[name], _curve_condition(body, own, r, mu, tau, name)
            )
        if own.base_motion == 0 or len(own.w) == 1:
            group.compare(
                f"beta_stick: {what}", k, float(ds.beta_stick.item()), stick_boundary(own, r, mu),
                partial(_conditions, body, partial(stick_boundary, mu=mu), own, r),
            )  # fmt: skip


def stick_boundary(body: closed_forms.Structure, r: Number, mu: float) -> Number:
    try:
        return closed_forms.held_force(body, r) / mp.mpf(mu)
    except ZeroDivisionError:  # the held structure resonates, to the bit
        return mp.inf


def _curve_condition(
    body: Body, own: closed_forms.Structure, r: float, mu: float, tau: Number, name: str
) -> Callable[[], Iterable]:
    return lambda: _conditions(body, lambda one, x: _curve_values(one, x, mu, tau)[0][name], own, r)


def _conditions(
    body: Body,
    function: Callable[[closed_forms.Structure, Number], Number],
    own: closed_forms.Structure,
    r: float,
) -> Iterator:
    """Condition numbers with respect to r, to zeta, and with few masses to every ratio."""
    yield closed_forms.condition(lambda x: function(own, x), r)
    if body.zeta:
        yield closed_forms.condition(
            lambda zeta: function(body.precise(body.masses, body.springs, zeta), r), body.zeta
        )
    n = len(body.masses)
    if 1 < n <= FEW:
        yield closed_forms.condition(
            lambda *x: function(body.precise((1.0, *x[: n - 1]), (1.0, *x[n - 1 :]), body.zeta), r),
            *body.masses[1:],
            *body.springs[1:],
        )
