"""Rings of sectors: each sector is given once, contacts and loads are those of one sector."""

import cmath
import math

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.files.config import config_of
from frictionmap.model.sectors import in_full

_COUNT = 5
_SECTOR = {
    "count": _COUNT,
    "mass": [[1.0, 0.0], [0.0, 2.0]],
    "stiffness": [[1.0, -1.0], [-1.0, 1.5]],
    "coupling": [{"masses": [2, 2], "stiffness": 1.5}],
    "engine_order": 2,
}
_DAMPERS = [{"kind": "between-masses", "masses": [1, "next.1"], "stiffness": 2.0}]


def _ring(contacts=_DAMPERS, **changed):
    sectors = {**_SECTOR, **changed}
    return fm.ring(sectors=sectors, contacts=contacts, load_mass=1, damping_ratios=0.02)


def _by_hand(stiffness_factors=(1.0,) * _COUNT):
    """K of the ring, spring by spring; blades are masses 1, 3, .., disks 2, 4, .."""
    k = np.zeros((2 * _COUNT, 2 * _COUNT))
    for j, factor in enumerate(stiffness_factors):
        blade, disk, other = 2 * j, 2 * j + 1, (2 * j + 3) % (2 * _COUNT)
        for a, b, spring in ((blade, disk, factor), (disk, None, 0.5 * factor), (disk, other, 1.5)):
            k[a, a] += spring
            if b is not None:
                k[b, b] += spring
                k[a, b] -= spring
                k[b, a] -= spring
    return k


def test_matrices_are_those_of_the_springs_one_by_one():
    assert np.array_equal(_ring().matrices.arrays["K"], _by_hand())
    assert np.array_equal(np.diag(_ring().matrices.arrays["M"]), [1.0, 2.0] * _COUNT)
    factors = [1.0, 1.1, 0.9, 1.2, 0.8]
    assert np.allclose(_ring(stiffness_factors=factors).matrices.arrays["K"], _by_hand(factors), atol=1e-15)


def test_a_coupling_block_is_the_same_as_its_springs():
    block = _ring(stiffness=[[1.0, -1.0], [-1.0, 4.5]], coupling=[[0.0, 0.0], [0.0, -1.5]])
    assert np.array_equal(block.matrices.arrays["K"], _by_hand())


def test_the_spread_is_that_of_the_frequencies_of_single_sectors():
    spread = {"standard_deviation": 0.01, "seed": 3}
    wide = in_full({"sectors": {**_SECTOR, "count": 64, "spread": spread}, "contacts": _DAMPERS})
    blades = wide["matrices"]["K"][::2, ::2].diagonal()  # 1 for a tuned ring
    deviations = np.sqrt(blades) - 1.0
    assert 0.007 < deviations.std() < 0.013  # 64 of them: 3 standard errors
    assert abs(deviations.mean()) < 0.004


def test_the_load_travels_with_the_engine_order_and_the_order_of_the_harmonic():
    load = np.array(_ring().load)
    assert np.allclose(load[::2], [cmath.exp(4j * math.pi * j / _COUNT) for j in range(_COUNT)], atol=1e-15)
    assert not load[1::2].any()
    harmonics = [{"n": 1, "mass": 1, "amplitude": 1.0}, {"n": 3, "mass": 2, "amplitude": 0.5}]
    system = fm.ring(sectors=_SECTOR, contacts=_DAMPERS, load_harmonics=harmonics)
    third = system.contact_system.forces[3][1::2]
    assert np.allclose(
        third, [0.5 * cmath.exp(12j * math.pi * j / _COUNT) for j in range(_COUNT)], atol=1e-15
    )


def test_all_sectors_of_a_tuned_ring_move_alike():
    """Proved for mu = 1: turned by a sector, the motion is the same, later."""
    found = fm.sweep(_ring(), r=[1.6, 2.0], beta=[0.05, 0.3], mu=[1.0])
    amplitude = found.contact_amplitude.values
    assert (amplitude.min(axis=-1) > 0.05).any()
    assert np.ptp(amplitude, axis=-1).max() < 1e-11 * amplitude.max()
    assert (found.slips_per_cycle.values == 2).all(axis=-1).any()


def test_contacts_of_a_sector_are_repeated_with_their_names():
    contacts = [{**_DAMPERS[0], "name": "damper"}, {"kind": "fixed-wall", "masses": 1, "force": 0.1}]
    system = _ring(contacts=contacts, count=3)
    labels = [one.label for one in system.contacts]
    assert labels[:3] == ["damper 1", "damper 2", "damper 3"]
    assert [one.masses for one in system.contacts] == [(1, 3), (3, 5), (1, 5), (1,), (3,), (5,)]


_CONFIG = """
[system]
load_mass = 1
sectors = { count = 5, mass = [[1.0, 0.0], [0.0, 2.0]], stiffness = [[1.0, -1.0], [-1.0, 1.5]],
  coupling = [{ masses = [2, 2], stiffness = 1.5 }], engine_order = 2 }
[[system.contacts]]
kind = "between-masses"
masses = [1, "next.1"]
stiffness = 2.0
[grid]
r = 1.0
beta = 0.1
"""


def test_a_configuration_has_them():
    system = config_of(_CONFIG.replace(",\n", ","), {"damping_ratios": 0.02}).system
    assert system == _ring()


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"count": 2}, "sectors.count must be >= 3"),
        ({"stiffness": [[1.0]]}, "sectors.stiffness must have the shape of mass, (2, 2); got (1, 1)"),
        ({"coupling": [{"masses": [1, 3], "stiffness": 1.0}]}, "sectors.coupling[1].masses must be <= 2"),
        ({"coupling": [{"masses": [1], "stiffness": 1.0}]}, "must be [A, B], B in the next sector; got [1]"),
        ({"stiffness_factors": [1.0]}, "must have one number per sector (5); got [1.0]"),
        ({"spread": {"deviation": 0.1}}, "unknown key 'sectors.spread.deviation'"),
        ({"order": 1}, "unknown key 'sectors.order'"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(changed, words):
    with pytest.raises(fm.InputError) as caught:
        _ring(**changed)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"mass_ratios": [1.0]}, "cannot use mass_ratios with sectors"),
        ({"excitation": "base"}, "excitation must be force with sectors"),
        ({"contacts": None}, "contacts must list the contacts of a sector"),
        ({"contacts": [{"masses": ["next.3"], "kind": "fixed-wall"}]}, "contacts[1].masses must be <= 2"),
        (
            {"contacts": [fm.Contact(normal={"mass": 2, "stiffness": 1.0, "friction": 0.4})]},
            "cannot use contacts[1].normal with sectors",
        ),
        ({"load_mass": 0}, "load_mass must be >= 1; got 0"),
        ({"load": [1.0]}, "load must have one number per mass of a sector (2); got 1"),
    ],
)
def test_keys_that_do_not_go_with_sectors_are_refused(keys, words):
    with pytest.raises(fm.InputError) as caught:
        fm.ring(**{"sectors": _SECTOR, "contacts": _DAMPERS, **keys})
    assert words in str(caught.value)


@pytest.mark.parametrize("order", [1, 2])
def test_all_sectors_of_a_ring_of_rigid_contacts_move_alike_in_every_cell_of_a_map(order):
    """They close a loop; cells that began from their neighbours came out otherwise."""
    rigid = [{"kind": "between-masses", "masses": [1, "next.1"]}]
    found = fm.sweep(
        _ring(rigid, engine_order=order), r=[1.2, 1.8], beta=[0.1, 0.2, 0.3], mu=[1.0],
        outputs=["contact_peak_to_peak"],
    )  # fmt: skip
    ranges = found.contact_peak_to_peak.values
    assert (found.status.values == 0).all()
    assert (ranges.min(axis=-1) > 0.0).any()
    assert np.ptp(ranges, axis=-1).max() < 1e-10 * ranges.max()


@pytest.mark.parametrize("ground", [False, True])
def test_cells_that_begin_from_their_neighbours_are_those_that_begin_from_rest(ground):
    """Sliding contacts of a loop had the friction of the neighbour's cell in them."""
    rigid = [{"kind": "between-masses", "masses": [1, "next.1"]}]
    rigid += [{"kind": "fixed-wall", "masses": 2, "ratio": 0.3}] if ground else []
    system = _ring(rigid, count=3)
    beta = np.array([0.1, 0.15, 0.2, 0.3, 0.35])

    def ranges(beta):
        found = fm.sweep(system, r=[1.8], beta=beta, mu=[1.0], outputs=["contact_peak_to_peak"])
        return found.contact_peak_to_peak.values[0, 0]

    for cell, one in zip(ranges(beta), beta, strict=True):
        alone = ranges([one])[0]
        assert alone.min() > 0.0
        assert np.abs(cell - alone).max() < 1e-11 * alone.max()
