"""Friction without stops: beta_lim and further intervals, against closed forms and against maps."""

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.general.boundaries import find_boundaries

#: Systems of one contact: masses, springs, zeta, mass with the load, contact, r.  The first of each kind has
#: damping so low that motions without stops settle in thousands of periods.
SLOW = [
    ([1.0, 1.442, 0.655], [1.0, 1.165, 0.931], 0.001, 2, ("fixed-wall", (3,)), 1.7301),
    ([1.0], [1.0], 0.0, 1, ("fixed-wall", (1,)), 0.964),
    ([1.0], [1.0], 1e-5, 1, ("fixed-wall", (1,)), 1.0),
    ([1.0, 1.442, 0.655], [1.0, 1.165, 0.931], 1e-5, 1, ("between-masses", (1, 3)), 0.7301),
]

#: Loads of several harmonics, contacts, r: intervals between intervals with stops, found by a map.
BETWEEN = [
    (
        {"damping_ratios": 0.025, "load_harmonics": {1: 1.0, 4: 0.174 - 0.355j, 5: 0.036 + 0.248j}},
        "joined-base-wall",
        0.834,
    ),
    (
        {
            "damping_ratios": 0.046,
            "mass_ratios": [1.0, 1.25],
            "stiffness_ratios": [1.0, 1.41],
            "load_mass": 2,
            "load_harmonics": {1: 1.0, 4: -0.184 - 0.226j, 5: -0.058 + 0.28j},
        },
        (fm.Contact("between-masses", (1, 2)), fm.Contact("fixed-wall", 2, ratio=0.1025)),
        0.465,
    ),
    (
        {
            "damping_ratios": 0.013,
            "mass_ratios": [1.0, 1.418, 1.062],
            "stiffness_ratios": [1.0, 0.8186, 0.7789],
            "load_harmonics": {1: 1.0, 2: -0.3486 - 0.3584j, 5: 0.2085 + 0.0363j},
        },
        (fm.Contact("between-masses", (1, 3)), fm.Contact("between-masses", (2, 3), ratio=0.84)),
        0.2121,
    ),
]


def without_stops(system, r, beta):
    """Whether no contact stops or rests in the steady state, (n_beta,), from a map."""
    ds = fm.sweep(system, [r], beta)
    stops, regime = (ds[name].values.reshape(beta.size, -1) for name in ("stops_per_cycle", "regime"))
    return (stops == 0.0).all(axis=1) & (regime >= 2).all(axis=1)


def check_map(system, r, top):
    """The intervals without stops are those of a map up to `top`; their number."""
    limits = find_boundaries(system, np.array([r]), np.ones(1))
    begins, ends = limits.begins[0, 0], limits.ends[0, 0]
    beta = np.linspace(0.0, top, 301)[1:]
    inside = ((beta[:, np.newaxis] > begins) & (beta[:, np.newaxis] < ends)).any(axis=1)
    assert (inside == without_stops(system, r, beta)).all()
    for edge in (*begins[begins > 0.0], *ends[np.isfinite(ends)]):
        beside = without_stops(system, r, edge * np.array([1.0 - 1e-6, 1.0 + 1e-6]))
        assert beside[0] != beside[1]
    return int(np.isfinite(begins).sum())


@pytest.mark.parametrize(("masses", "springs", "zeta", "load", "contact", "r"), SLOW)
@pytest.mark.parametrize("mu", [1.0, 1.4])
def test_low_damping_has_the_closed_form(masses, springs, zeta, load, contact, r, mu):
    chain = {"mass_ratios": masses, "stiffness_ratios": springs, "damping_ratios": zeta, "load_mass": load}
    one = fm.System(*contact, **chain)
    general = fm.System(contacts=[fm.Contact(*contact)], **chain)
    wanted = fm.boundaries(one, [r], [mu]).beta_lim.item()
    assert fm.boundaries(general, [r], [mu]).beta_lim.item() == pytest.approx(wanted, rel=1e-12)


def test_low_damping_and_a_contact_without_friction():
    """A second contact whose friction is next to nothing takes the search instead of the closed form."""
    masses, springs, zeta, load, contact, r = SLOW[0]
    chain = {"mass_ratios": masses, "stiffness_ratios": springs, "damping_ratios": zeta, "load_mass": load}
    wanted = fm.boundaries(fm.System(*contact, **chain), [r]).beta_lim.item()
    contacts = [fm.Contact(*contact), fm.Contact("fixed-wall", 1, ratio=1e-9)]
    found = fm.boundaries(fm.System(contacts=contacts, **chain), [r])
    assert found.beta_lim.item() == pytest.approx(wanted, rel=1e-6)
    assert found.limiting_contact.item() == 1


def test_walls_that_move_with_the_base_stop_contacts_at_any_frequency():
    """The force that holds the mass on its wall grows with r^2, and so does beta_lim."""
    contacts = [fm.Contact("joined-base-wall", 1), fm.Contact("between-masses", (1, 2), force=0.01)]
    chain = {"mass_ratios": [1.0, 1.0], "stiffness_ratios": [1.0, 1.0], "damping_ratios": 0.05}
    system = fm.System(excitation="base", contacts=contacts, **chain)
    r = np.array([10.0, 20.0, 40.0])
    limits = fm.boundaries(system, r).beta_lim.values[0]
    for one, limit in zip(r, limits, strict=True):
        beside = without_stops(system, one, limit * np.array([1.0 - 1e-6, 1.0 + 1e-6]))
        assert beside.tolist() == [True, False]
    one = fm.System("joined-base-wall", (1,), **chain)
    assert limits == pytest.approx(fm.boundaries(one, r).beta_lim.values[0], rel=0.01)


@pytest.mark.parametrize(("given", "contacts", "r"), BETWEEN)
def test_intervals_between_stops_are_found(given, contacts, r):
    if isinstance(contacts, str):
        system = fm.System(contacts, excitation="base", **given)
    else:
        system = fm.System(contacts=contacts, **given)
    limits = find_boundaries(system, np.array([r]), np.ones(1))
    assert check_map(system, r, 1.3 * np.nanmax(limits.ends)) > 1
