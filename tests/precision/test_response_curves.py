"""Response curves against cells in 40-digit arithmetic: extremes, phases, harmonics, works."""

import math

import numpy as np
import pytest
from curve_cells import CELLS, SYSTEMS
from structures import KINDS

import frictionmap as fm

QUANTITIES = ["amplitude", "phase", "first_harmonic", "energy", "harmonics", "transmitted_force"]
REGIMES = {"permanent_sticking": 0, "stick_slip": 1, "continuous": 2}

#: Relative error of amplitudes and works; below r = 0.1 events are counted in hundreds.
TOLERANCE, AT_LOW_R = 1e-11, 1e-9


def system_of(entry, zeta):
    kind, *masses = entry["contact"]
    based = {"excitation": "base", "damping_reference": "base"} if entry["base_damping"] else {}
    return fm.System(
        contact=KINDS[kind], contact_masses=masses, mass_ratios=entry["gamma"],
        stiffness_ratios=entry["kappa"],
        damping_ratios=zeta, load_mass=None if based else entry["load"], **based,
    )  # fmt: skip


def cell_of(entry, row):
    ds = fm.curves(
        system_of(entry, row["zeta"]), row["r"], row["beta"], row["mu"], quantities=QUANTITIES,
        start=row["start"], threads=1,
    )  # fmt: skip
    return ds.isel(mu=0, r=0, beta=0)


def complex_of(parts):
    values = np.asarray(parts)
    return values[..., 0] + 1j * values[..., 1]


def turns_apart(one, other):
    return abs(math.remainder(one - other, 2.0 * math.pi))


def assert_phases(found, row):
    for k, (lag, plateau) in enumerate(zip(row["lag"], row["plateau"], strict=True)):
        one = found.isel(dof=k)
        if lag is None:
            assert math.isnan(one.phase_lag)
        else:
            assert turns_apart(float(one.phase_lag), lag) < 1e-10
        if plateau is None:
            assert math.isnan(one.phase_begin)
        else:
            assert float(one.phase_begin) == pytest.approx(plateau[0], abs=1e-10)
            assert float(one.phase_end) == pytest.approx(plateau[1], abs=1e-10)


@pytest.mark.parametrize("row", CELLS, ids=[f"{row['system']} r={row['r']}" for row in CELLS])
def test_cells_in_forty_digits(row):
    found = cell_of(SYSTEMS[row["system"]], row)
    near = {"rel": TOLERANCE if row["r"] >= 0.1 else AT_LOW_R}
    assert found.amplitude.values == pytest.approx(row["amplitude"], **near)
    assert found.contact_amplitude.item() == pytest.approx(row["contact_amplitude"], **near)
    assert found.first_harmonic_amplitude.values == pytest.approx(row["fft_amplitude"], **near)
    assert found.sliding_distance.item() == pytest.approx(row["sliding_distance"], **near)
    assert found.work_input.item() == pytest.approx(row["work_input"], **near)
    assert found.work_damping.item() == pytest.approx(row["work_viscous"], abs=1e-11 * row["work_input"])
    assert_phases(found, row)
    for lag, exact in zip(found.first_harmonic_phase.values, row["fft_lag"], strict=True):
        assert turns_apart(lag, exact) < 1e-10
    third = complex_of(found.displacement_harmonic.values)[0, 3]
    assert abs(third - complex(*row["third"])) < 1e-11 * max(row["amplitude"])


def assert_harmonics(found, row):
    """The mirror image of an asymmetric motion, whose even harmonics have the other sign, is as good."""
    size = max(row["amplitude"])
    friction = complex_of(found.friction_harmonic.values)
    exact = complex_of(row["harmonics_f"])
    even = np.where(np.arange(8) % 2 == 0, -1.0, 1.0)
    mirrored = row.get("asymmetric", False) and abs(friction[2] - exact[2]) > abs(friction[2] + exact[2])
    twin = even if mirrored else np.ones(8)
    assert np.abs(twin * friction - exact).max() < 1e-11
    masses = twin * complex_of(found.displacement_harmonic.values)
    assert np.abs(masses - complex_of(row["harmonics_x"])).max() < 1e-11 * size
    contact = twin * complex_of(found.contact_harmonic.values)
    assert np.abs(contact - complex_of(row["harmonics_z"])).max() < 1e-11 * size


@pytest.mark.slow
def test_every_cell_of_the_reference(curve_rows):
    systems, rows = curve_rows
    for row in rows:
        found = cell_of(systems[row["system"]], row)
        near = {"rel": TOLERANCE if row["r"] >= 0.1 else AT_LOW_R, "abs": 1e-300}
        assert found.regime.item() == REGIMES[row["regime"]]
        assert found.period.item() == row["period"]
        assert found.amplitude.values == pytest.approx(row["amplitude"], **near)
        assert found.contact_amplitude.item() == pytest.approx(row["contact_amplitude"], **near)
        assert found.sliding_distance.item() == pytest.approx(row["sliding_distance"], **near)
        assert found.work_friction.item() == pytest.approx(row["work_friction"], **near)
        assert_harmonics(found, row)
        if row["regime"] == "permanent_sticking":
            assert turns_apart(found.phase_lag.values[0], row["lag"][0]) < 1e-10
            continue
        assert_phases(found, row)
        for lag, exact in zip(found.first_harmonic_phase.values, row["fft_lag"], strict=True):
            assert turns_apart(lag, exact) < 1e-10
        assert turns_apart(found.contact_first_harmonic_phase.item(), row["contact_fft_lag"]) < 1e-10
        assert found.work_input.item() == pytest.approx(row["work_input"], **near)
        assert found.work_damping.item() == pytest.approx(row["work_viscous"], abs=1e-11 * row["work_input"])
        assert found.equivalent_damping.item() == pytest.approx(row["equivalent_damping"], **near)
        if row["transmitted_first_harmonic"] is not None:
            exact = abs(complex(*row["transmitted_first_harmonic"]))
            assert found.transmitted_first_harmonic.item() == pytest.approx(exact, rel=1e-11)
