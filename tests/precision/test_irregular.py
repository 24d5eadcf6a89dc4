"""Long periods and irregular motion at mu > 1, against another program that marched up to 50,000 cycles."""

import numpy as np
import pytest

import frictionmap as fm
from frictionmap import regimes

OUTPUTS = (
    "regime", "status", "period", "stops_per_cycle", "stuck_fraction", "contact_amplitude", "cycles",
    "stops_per_cycle_error", "stuck_fraction_error",
)  # fmt: skip

#: Five equal masses, contact of the third with the wall, load on the first, zeta 0.02, mu 1.3, from rest:
#: r, beta, period, stops in it, share stuck, amplitude.
LONG_PERIODS = [
    (1.582274247491639, 1.003344481605351, 9, 6, 0.8545059194, 0.0348928196),
    (0.6317725752508363, 0.2140468227424749, 13, 16, 0.7338758764, 0.1617672643),
    (0.3941471571906355, 0.3478260869565217, 55, 152, 0.4909536141, 0.4473261092),
    (0.8939799331103681, 1.79933110367893, 62, 59, 0.7860773200, 0.5568342655),
]

#: Of the same: r, beta, stops per cycle, share stuck, each with its standard error, largest amplitude.
CHAOTIC = [
    (0.4433110367892977, 0.3612040133779264, 1.7828, 0.0012, 0.73173, 0.00020, 0.172488),
    (0.5498327759197326, 0.4414715719063545, 0.48480, 0.00014, 0.91350, 0.00002, 0.178733),
    (0.07458193979933112, 0.294314381270903, 2.0, 0.0, 0.70018, 0.00001, 0.617355),
]

#: Of the same, at mu = 1.3: r and beta where the motion comes near a stable orbit that it does not go to.
PASSED_BY = [
    (0.3753132832080201, 0.3397243107769424), (0.6858395989974938, 0.062456140350877196),
    (0.693233082706767, 0.07744360902255638), (1.743107769423559, 2.9550375939849625),
    (1.7505012531328323, 2.7602005012531325),
]  # fmt: skip


#: Solvers: that of one contact, and the one of several contacts, to which a list of one contact leads.
FORMS = pytest.mark.parametrize("form", ["contact", "contacts"])


def with_contact(form, kind, masses, **further):
    """A system with one contact, for one of both solvers."""
    if form == "contact":
        return fm.System(kind, masses, **further)
    return fm.System(contacts=[fm.Contact(kind, masses)], **further)


def five_masses(form="contact"):
    ones = [1.0] * 5
    return with_contact(
        form, "fixed-wall", [3], load_mass=1, mass_ratios=ones, stiffness_ratios=ones, damping_ratios=0.02
    )


def cell(system, r, beta, mu, **settings):
    """The one cell of a map, as numbers."""
    ds = fm.sweep(system, [r], [beta], [mu], outputs=OUTPUTS, **settings)
    return {name: ds[name].item() for name in OUTPUTS}


@FORMS
@pytest.mark.parametrize(("r", "beta", "period", "stops", "stuck", "amplitude"), LONG_PERIODS)
def test_long_periods(form, r, beta, period, stops, stuck, amplitude):
    """The period is the smallest, not a multiple, and the orbit is solved to rounding."""
    found = cell(five_masses(form), r, beta, 1.3)
    assert (found["status"], found["regime"]) == (regimes.RESOLVED, regimes.STICK_SLIP)
    assert found["period"] == period
    assert found["stops_per_cycle"] == pytest.approx(stops / period, rel=1e-6)
    assert found["stuck_fraction"] == pytest.approx(stuck, abs=1e-7)
    assert found["contact_amplitude"] == pytest.approx(amplitude, rel=2e-9)


def errors_off(found, stops, stops_error, stuck, stuck_error):
    """By how many standard errors the means differ from those of many thousand cycles; all else holds."""
    assert (found["status"], found["regime"]) == (regimes.IRREGULAR, regimes.STICK_SLIP)
    assert found["period"] == 0
    assert found["cycles"] <= 1100
    assert 0.0 < found["stops_per_cycle_error"] < 0.1
    assert 0.0 < found["stuck_fraction_error"] < 0.1
    return (
        abs(found["stops_per_cycle"] - stops) / np.hypot(found["stops_per_cycle_error"], stops_error),
        abs(found["stuck_fraction"] - stuck) / np.hypot(found["stuck_fraction_error"], stuck_error),
    )


@FORMS
@pytest.mark.parametrize(("r", "beta", "stops", "stops_error", "stuck", "stuck_error", "largest"), CHAOTIC)
def test_chaotic_cells(form, r, beta, stops, stops_error, stuck, stuck_error, largest):
    """Not waited for: stops, share stuck and amplitude are those of the cycles seen."""
    found = cell(five_masses(form), r, beta, 1.3)
    assert max(errors_off(found, stops, stops_error, stuck, stuck_error)) <= 3.0
    assert 0.75 * largest <= found["contact_amplitude"] <= largest * (1.0 + 1e-5)


@FORMS
def test_more_cycles_look_longer(form):
    """An irregular motion is followed for a quarter of `cycles`, or for 512 cycles if that is more."""
    r, beta, stops, *_ = CHAOTIC[0]
    few, many = (cell(five_masses(form), r, beta, 1.3, cycles=cycles) for cycles in (300, 8000))
    assert few["status"] == many["status"] == regimes.IRREGULAR
    assert few["cycles"] <= 301
    assert 2000 <= many["cycles"] <= 4001
    assert abs(many["stops_per_cycle"] - stops) < 0.02


@FORMS
def test_damped_cells_are_resolved_or_irregular(form):
    """Random structures, mu and starts: below beta_stick no damped cell is left without a regime."""
    rng = np.random.default_rng(8)
    for _ in range(12):
        n = int(rng.integers(1, 7))
        system = with_contact(
            form, "fixed-wall", [int(rng.integers(1, n + 1))], load_mass=int(rng.integers(1, n + 1)),
            mass_ratios=[1.0, *rng.uniform(0.3, 3.0, n - 1)],
            stiffness_ratios=[1.0, *rng.uniform(0.3, 3.0, n - 1)],
            damping_ratios=float(rng.choice([0.005, 0.02, 0.1])),
        )  # fmt: skip
        r = np.sort(rng.uniform(0.05, 2.5, 12))
        beta = np.sort(rng.uniform(0.02, 2.0, 12))
        mu = float(rng.choice([1.05, 1.3, 2.0, 3.0]))
        start = str(rng.choice(["rest", "moving"]))
        ds = fm.sweep(system, r, beta, [mu], outputs=OUTPUTS, start=start)
        assert set(np.unique(ds.status)) <= {regimes.RESOLVED, regimes.IRREGULAR}
        assert regimes.UNRESOLVED not in ds.regime
        stuck_or_not = ds.regime != regimes.PERMANENT_STICKING
        assert bool(np.isfinite(ds.stops_per_cycle.where(stuck_or_not, 0.0)).all())


@pytest.fixture(scope="session")
def reference(reference_table):
    return reference_table("irregular.json")


@FORMS
def test_reference_long_periods(form, reference):
    """Every period; the number of stops in it; share stuck and amplitude to the digits of the reference."""
    for row in reference["long_periods"]:
        found = cell(five_masses(form), row["r"], row["beta"], row["mu"], start=row["start"], cycles=8000)
        assert found["period"] == row["period"], row
        assert found["stops_per_cycle"] == pytest.approx(row["stops_per_cycle"], rel=1e-6), row
        assert found["stuck_fraction"] == pytest.approx(row["stuck_share"], abs=1e-6), row
        assert found["contact_amplitude"] == pytest.approx(row["contact_amplitude"], rel=1e-6), row


@FORMS
def test_reference_irregular_cells(form, reference):
    """Status; stops and share stuck within three errors, with few exceptions; amplitude of these cycles."""
    off = []
    for row in reference["irregular_map"]:
        found = cell(five_masses(form), row["r"], row["beta"], row["mu"], start=row["start"])
        if found["status"] == regimes.RESOLVED:  # Newton's method ends a long transient
            assert (row["cls"], row["period"]) == ("periodic", found["period"])
            continue
        errors = (row["stops_per_cycle_se"], row["stuck_share_se"])
        off += errors_off(found, row["stops_per_cycle"], errors[0], row["stuck_share"], errors[1])
        assert 0.5 * row["largest_amplitude"] <= found["contact_amplitude"] <= 1.05 * row["largest_amplitude"]
    assert len(off) > 60
    assert np.mean(np.array(off) <= 3.0) >= 0.95
    assert max(off) < 5.0


@FORMS
def test_reference_random_walls(form, reference):
    """Random chains from rest, in the reference's units k = m = 1: the orbit, or an irregular motion."""
    count = 0
    for row in reference["irregular_random"]:
        # where the first mass is not the unit, the frequency's unit is not stated
        if row["contact"][0] != "wall" or row["start"] != "rest" or row["gamma"][0] != 1.0:
            continue
        springs = np.array(row["kappa"])
        system = with_contact(
            form, "fixed-wall", [row["contact"][1]], load_mass=row["load"], mass_ratios=row["gamma"],
            stiffness_ratios=springs / springs[0], damping_ratios=row["zeta"],
        )  # fmt: skip
        found = cell(system, row["r"] / np.sqrt(springs[0]), row["beta"], row["mu"])
        count += 1
        assert found["status"] in (regimes.RESOLVED, regimes.IRREGULAR)
        if found["status"] == regimes.RESOLVED and row["cls"] == "periodic":
            assert found["period"] == row["period"], row
            assert found["stops_per_cycle"] == pytest.approx(row["stops_per_cycle"], rel=1e-6), row
            error = 1e-6 + 3.0 * row["stuck_se"]
            assert found["stuck_fraction"] == pytest.approx(row["stuck_share"], abs=error), row
            # the largest over the transient, too
            assert found["contact_amplitude"] / springs[0] <= row["largest_amplitude"] * (1.0 + 1e-9), row
    assert count > 15


#: Of the cells above: exponent per cycle, its standard error (0: a period).
EXPONENTS = [
    (*LONG_PERIODS[0][:2], -0.0647, 0.0),
    (*LONG_PERIODS[1][:2], -0.0682, 0.0),
    (*LONG_PERIODS[2][:2], -0.0967, 0.0),
    (*LONG_PERIODS[3][:2], -0.0507, 0.0),
    (*CHAOTIC[0][:2], 0.0173, 0.0010),
    (*CHAOTIC[1][:2], 0.01144, 0.00027),
    (*CHAOTIC[2][:2], 0.1746, 0.0017),
]


@pytest.mark.parametrize(("r", "beta", "exponent", "error"), EXPONENTS)
def test_lyapunov_exponents(r, beta, exponent, error):
    """Of periods from the multiplier, of chaotic motions from a disturbance followed along."""
    names = ("lyapunov_exponent", "lyapunov_exponent_error")
    ds = fm.sweep(five_masses(), [r], [beta], [1.3], outputs=names, cycles=40000)
    found, own = (ds[name].item() for name in names)
    assert "multiplier" not in ds
    if error == 0.0:
        assert own == 0.0
        assert found == pytest.approx(exponent, abs=1e-3)  # the reference's mean has some of the transient
        known = fm.sweep(five_masses(), [r], [beta], [1.3], outputs=("multiplier", "period"))
        assert found == np.log(known.multiplier.item()) / known.period.item()
    else:
        assert 0.0 < own < 0.012
        assert abs(found - exponent) <= 3.0 * np.hypot(own, error)


def test_a_disturbance_grows_as_two_motions_part():
    """Two motions with beta 1e-12 apart part at about the rate of the exponent."""
    r, beta, *_ = CHAOTIC[2]
    system = five_masses()
    ends = [
        fm.response(system, r, beta * (1.0 + change), 1.3, points=4, cycles=cycles)
        for change in (0.0, 1e-12)
        for cycles in (40, 90)
    ]
    early, late = (np.abs(ends[k].z.values - ends[k + 2].z.values).max() for k in (0, 1))
    assert np.log(late / early) / 50.0 == pytest.approx(0.1746, rel=0.6)


@FORMS
@pytest.mark.parametrize(("r", "beta"), PASSED_BY)
def test_an_orbit_that_the_motion_passes_by_is_not_its_steady_state(r, beta, form):
    """Against the motion followed to its end, without Newton's method."""
    found = fm.sweep(five_masses(form), [r], [beta], [1.3], outputs=OUTPUTS).squeeze()
    end = fm.sweep(
        five_masses(), [r], [beta], [1.3], outputs=OUTPUTS, steady="marched", cycles=20_000
    ).squeeze()  # fmt: skip
    assert end.status == found.status == regimes.RESOLVED
    assert (found.regime, found.period) == (end.regime, end.period)
    assert found.stops_per_cycle.item() == pytest.approx(end.stops_per_cycle.item(), rel=1e-6)  # as float32
    assert found.contact_amplitude.item() == pytest.approx(end.contact_amplitude.item(), rel=1e-9)
