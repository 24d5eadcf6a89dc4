"""Banks of elements as one contact: against their elements one by one, and closed forms."""

from dataclasses import replace

import numpy as np
import pytest

import frictionmap as fm
from frictionmap.general.problem import problem_of
from frictionmap.general.starts import initial_states

RANGES = ("contact_peak_to_peak", "contact_amplitude", "contact_midpoint")
COUNTS = ("slips_per_cycle", "slip_reversals_per_cycle", "elastic_fraction")
OUTPUTS = ("regime", *RANGES, *COUNTS, "amplitude", "peak_to_peak", "work_friction")

CHAIN = {"mass_ratios": [1.0, 0.8], "stiffness_ratios": [1.0, 1.2], "damping_ratios": 0.02}
TWO_POINTS = {
    "modes": fm.Modes([1.0, 3.0], [0.03, 0.02], [[1.0, -0.5], [0.6, 0.9]], ["tip", "load"]),
    "load_mass": "load",
}
MANY = {1: 1.0, 2: 0.4 - 0.5j, 5: 0.3 + 0.4j, 9: 0.7}  # turns within turns


def bank(k, u, **own):
    """A contact whose elements of stiffness k slip at elongations u times beta."""
    return fm.Contact(stiffness=list(k), ratio=list(np.multiply(k, u)), **own)


def drawn(seed, n):
    """Stiffness and elongations of n elements."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0.1, 1.0, n) * 2.0 / n, rng.uniform(0.05, 2.0, n)


def both(contacts, r, beta, outputs=OUTPUTS, **system):
    """Maps of a system with banks as one contact, and with their elements as contacts."""
    return [
        fm.sweep(
            fm.System(
                contacts=[
                    replace(one, bank=kind if isinstance(one.stiffness, tuple) else None) for one in contacts
                ],
                **system,
            ),
            r,
            beta,
            outputs=(*outputs, "status", "cycles"),
        )
        for kind in ("contact", "elements")
    ]


def of_banks(contacts, ds, name):
    """Values of the elements that slip first, or for the work of all elements, (..., banks)."""
    values = ds[name].values if "contact" in ds.dims else ds[name].values[..., np.newaxis]
    found, at = [], 0
    for one in contacts:
        own = values[..., at : at + len(one.elements)]
        first = np.argmin([element.ratio / element.stiffness for element in one.elements])
        found.append(own.sum(axis=-1) if name == "work_friction" else own[..., first])
        at += len(one.elements)
    return np.stack(found, axis=-1)


K, U = drawn(1, 12)
CASES = {
    "one harmonic": ([bank(K, U)], {"damping_ratios": 0.03}),
    "minor loops": ([bank(K, U)], {"damping_ratios": 0.03, "load_harmonics": MANY}),
    "equal thresholds": ([bank(K, np.round(2.0 * U) / 2.0 + 0.25)], {"damping_ratios": 0.03}),
    "all at once": ([bank(K, np.full(12, 0.6))], {"damping_ratios": 0.03, "load_harmonics": MANY}),
    "one stiff element": ([bank([1e4, *K], [1e-5, *U])], {"damping_ratios": 0.03}),
    "one that never slips": ([bank(K, [*U[:-1], 1e3])], {"damping_ratios": 0.03, "load_harmonics": MANY}),
    "two banks and an element": (
        [bank(K, U, masses=2), bank(K[:4], U[:4]), fm.Contact("between-masses", (1, 2), stiffness=1.3)],
        CHAIN | {"load_harmonics": MANY},
    ),
    "a wall that moves with the base": (
        [bank(K, U, kind="joined-base-wall")],
        {"damping_ratios": 0.03, "excitation": "base"},
    ),
    "constant loads": ([bank(K, U, masses=2)], CHAIN | {"load_offset": [0.3, -0.2]}),
    "a structure given by modes": ([bank(K, U, masses=["tip"])], TWO_POINTS),
    "a base of constant acceleration": (
        [bank(K, U)],
        {"damping_ratios": 0.03, "excitation": "base", "base_control": "acceleration"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_bank_is_its_elements(name):
    contacts, system = CASES[name]
    one, each = both(contacts, [0.6, 0.95, 1.3], [0.1, 0.5, 2.0], **system)
    assert (one.status == 0).all()
    assert one.regime.equals(each.regime)
    size = each.contact_amplitude.max().item()
    for output in ("amplitude", "peak_to_peak"):
        assert one[output].values == pytest.approx(each[output].values, abs=1e-11 * size), output
    count = len(contacts)
    for output in (*RANGES, "work_friction", *COUNTS):
        values = one[output].values if count > 1 else one[output].values[..., np.newaxis]
        # the other engine knows the time of a slip to 1e-8
        close = 1e-7 if output == "elastic_fraction" else 1e-11 * size
        assert values == pytest.approx(of_banks(contacts, each, output), abs=close), output


@pytest.mark.parametrize("load", [{}, {"load_harmonics": MANY}], ids=["odd orders", "all orders"])
def test_cells_that_begin_at_their_neighbours_are_the_elements(load):
    """Ranges and works along rows of friction, from where all elements slip to where most of them rest."""
    contacts, names = [bank(K, U)], ("peak_to_peak", "contact_peak_to_peak", "work_friction", *COUNTS)
    beta = np.linspace(0.05, 2.5, 15)
    one, each = both(contacts, [0.7, 1.2], beta, outputs=names, damping_ratios=0.03, **load)
    assert (one.status == 0).all()
    size = each.peak_to_peak.max().item()
    for name in names:
        close = 1e-7 if name == "elastic_fraction" else 1e-11 * size
        values, expected = one[name].values, each[name].values
        if name != "peak_to_peak":
            values, expected = values[..., np.newaxis], of_banks(contacts, each, name)
        assert values == pytest.approx(expected, abs=close), name


@pytest.mark.parametrize("load", [{}, {"load_harmonics": MANY}], ids=["odd orders", "all orders"])
def test_cells_that_begin_at_their_neighbours_take_fewer_periods_than_alone(load):
    system = fm.System(contacts=[bank(K, U, bank="contact")], damping_ratios=0.03, **load)
    beta = np.linspace(0.05, 2.5, 40)
    row = fm.sweep(system, [0.7, 1.2], beta, outputs=("cycles",)).cycles
    alone = [fm.sweep(system, [0.7, 1.2], [one], outputs=("cycles",)).cycles for one in beta]
    assert row.mean() < 0.8 * np.mean(alone)


def test_rows_of_banks_have_the_same_bits_for_any_number_of_threads():
    system = fm.System(contacts=[bank(K, U, bank="contact")], damping_ratios=0.03)
    r, beta = np.linspace(0.6, 1.4, 5), np.linspace(0.1, 2.0, 8)
    one, two = (fm.sweep(system, r, beta, outputs=OUTPUTS, threads=threads) for threads in (1, 2))
    for name in OUTPUTS:
        np.testing.assert_array_equal(one[name].values, two[name].values)


BAND = [1.0, 1.5]
ASKED = {
    "least-peak": (
        lambda system: fm.design.least_peak(system, [1.2, 1.3], beta=[0.65, 0.75]),
        ("beta", "peak"),
    ),
    "at-most": (lambda system: fm.design.at_most(system, BAND, 4.0), ("interval_begin", "interval_end")),
    "stuck": (lambda system: fm.design.stuck(system, BAND), ("beta", "at_r")),
    "margin": (lambda system: fm.design.margin(system, 0.8, 3.0), ("beta_stick", "margin_beta_stick")),
}


@pytest.mark.parametrize("question", ASKED)
def test_designs_of_a_bank_are_those_of_its_elements(question):
    ask, names = ASKED[question]
    given = fm.Contact(stiffness=[0.4, 0.6], ratio=[0.3, 0.7])
    one, each = (
        ask(fm.System(contacts=[replace(given, bank=kind)], damping_ratios=0.2))
        for kind in ("contact", "elements")
    )
    for name in names:
        np.testing.assert_allclose(one[name].values, each[name].values, rtol=1e-7)


def test_a_bank_of_more_elements_than_contacts_are_offered():
    """Each element in two halves: 128 of them are 64."""
    k, u = drawn(2, 64)
    halves = bank(np.repeat(k / 2.0, 2), np.repeat(u, 2))
    whole = bank(k, u, bank="contact")
    system = {"damping_ratios": 0.03, "load_harmonics": MANY}
    two, one = (
        fm.sweep(fm.System(contacts=[given], **system), [0.8], [0.4], outputs=OUTPUTS)
        for given in (halves, whole)
    )
    assert "contact" not in two.dims
    for name in OUTPUTS:
        assert two[name].values == pytest.approx(one[name].values, abs=1e-12), name


def test_the_force_is_that_of_all_elements():
    """Each element follows f = clip(f + k dz, -beta, beta), exact where z is monotonic between samples."""
    k, u = drawn(3, 150)
    ds = fm.response(fm.System(contacts=[bank(k, u)], damping_ratios=0.03), 0.8, 0.2, points=4000)
    z, force = ds.z.values, np.zeros(k.size)
    for _ in range(2):  # the first one forgets the state at its beginning: all elements slip
        total = [force.sum()]
        for step in np.diff(z):
            force = np.clip(force + k * step, -0.2 * k * u, 0.2 * k * u)
            total.append(force.sum())
    # between samples next to a turn z goes on by up to z'' dtau^2/8
    assert np.array(total) == pytest.approx(ds.friction.values, abs=k.sum() * 5.0 * (2.0 * np.pi / 4000) ** 2)
    assert ds.work_input.item() == pytest.approx((ds.work_damping + ds.work_friction).item(), rel=1e-12)
    loop = np.trapezoid(ds.friction.values, z)
    assert loop == pytest.approx(ds.work_friction.item(), rel=1e-5)
    assert ds.event_direction.values.tolist() in ([1, 0, -1, 0], [0, -1, 0, 1], [-1, 0, 1, 0], [0, 1, 0, -1])


def test_no_element_slips_at_the_boundary():
    """A linear structure with all springs: each is stretched by z up to its own limit."""
    k, u = drawn(4, 100)
    system = fm.System(contacts=[bank(k, u)], damping_ratios=0.03)
    r = 0.8
    limit = fm.boundaries(system, [r]).beta_noslip.item()
    z = 1.0 / abs(1.0 + k.sum() - r * r + 2j * 0.03 * r)
    assert limit == pytest.approx(z / u.min(), rel=1e-13)
    ds = fm.sweep(system, [r], [0.999 * limit, 1.001 * limit], outputs=("regime", "contact_peak_to_peak"))
    assert ds.regime.values.ravel().tolist() == [fm.regimes.STICK_SLIP, fm.regimes.PERMANENT_STICKING]
    assert ds.contact_peak_to_peak.values.ravel()[1] == pytest.approx(2.0 * z, rel=1e-12)


def test_curves_of_a_bank():
    """Harmonics and works of the response, which are integrals of the same motion."""
    k, u = drawn(5, 80)
    system = fm.System(contacts=[bank(k, u)], damping_ratios=0.03)
    curves = fm.curves(system, [0.7, 0.9], [0.3]).isel(mu=0, r=1, beta=0)
    one = fm.response(system, 0.9, 0.3)
    for name in ("work_friction", "work_damping", "contact_first_harmonic_amplitude", "sliding_distance"):
        assert curves[name].item() == pytest.approx(one[name].item(), rel=1e-12), name
    ratio = complex(*one.friction_harmonic.values[1]) / complex(*one.contact_harmonic.values[1])
    assert curves.equivalent_stiffness.item() == pytest.approx(ratio.real, rel=1e-12)


@pytest.mark.parametrize(
    "system", [CHAIN | {"load_offset": [0.3, -0.2]}, TWO_POINTS], ids=["offset", "modes"]
)
def test_a_response_of_a_bank_is_that_of_its_elements(system):
    k, u = drawn(6, 5)
    place = "tip" if "modes" in system else 1
    one, each = (
        fm.response(
            fm.System(contacts=[bank(k, u, masses=[place], bank=kind)], **system), 0.9, 0.3, points=60
        )
        for kind in ("contact", "elements")
    )
    for name in ("x", "v", "displacement_harmonic", "work_input", "work_damping", "amplitude"):
        assert one[name].values == pytest.approx(each[name].values, abs=1e-10), name
    assert one.z.values == pytest.approx(each.z.values[0], abs=1e-10)
    assert one.friction.values == pytest.approx(each.friction.values.sum(axis=0), abs=1e-10)
    assert set(one.coords) >= set(each.coords) - {"contact", "contact_name"}


def test_parallel_contacts_at_a_joined_wall_begin_where_one_does():
    """A mass at a wall that moves with the base begins at its place, however many contacts join them."""
    starts = []
    for count in (1, 3):
        contacts = [fm.Contact("joined-base-wall", 1, stiffness=1.0, ratio=1.0 / count)] * count
        problem, modal = problem_of(
            system := fm.System(contacts=contacts, excitation="base"), np.array([0.7])
        )
        starts.append(modal.phi @ initial_states(system, problem, modal, "rest")[0, 0])
    assert starts[1] == pytest.approx(starts[0])


def test_a_gap_on_a_base_of_constant_acceleration():
    """Displacements of the base are Y/r^2: where the gap does not close, those of the mass grow alike."""
    r, found = 0.6, []
    for control in ("displacement", "acceleration"):
        gap = {"springs": [{"gap": 1e3, "stiffness": 1.0}], "contacts": [fm.Contact(force=1e-9)]}
        system = fm.System(excitation="base", damping_ratios=0.05, base_control=control, **gap)
        found.append(fm.sweep(system, [r], [1.0], outputs=["amplitude"]).amplitude.item())
    assert found[1] == pytest.approx(found[0] / r**2, rel=1e-6)


HALVES = bank([1.0, 1.0], [0.5, 1.0], bank="contact")
REFUSED = [
    ([HALVES, fm.Contact("between-masses", (1, 2))], {}, "cannot use contacts[2] beside a bank as one"),
    ([replace(HALVES, wall_velocity=0.1)], {}, "cannot use contacts[1].wall_velocity with a bank"),
    ([replace(HALVES, normal_load={2: 0.5})], {}, "cannot use contacts[1].normal_load with a bank"),
    ([HALVES], {"springs": [{"gap": 0.1, "stiffness": 1.0}]}, "cannot use springs with a bank"),
]  # fmt: skip


def test_a_residual_is_refused_with_a_bank():
    """It is a spring in series with all elements: their places would depend on each other."""
    given = TWO_POINTS["modes"]
    modes = fm.Modes(given.w, given.zeta, given.shapes, ["tip", "load"], 0.01 * np.eye(2))
    with pytest.raises(fm.InputError, match=r"contacts\[\].bank.*residual flexibility"):
        fm.System(modes=modes, load_mass="load", contacts=[replace(HALVES, masses=("tip",))])


@pytest.mark.parametrize(("contacts", "more", "message"), REFUSED)
def test_what_is_refused_with_a_bank(contacts, more, message):
    with pytest.raises(fm.InputError) as error:
        fm.sweep(fm.System(contacts=contacts, **CHAIN, **more), [0.5], [0.1])
    assert message in str(error.value)


@pytest.mark.parametrize(("contacts", "more", "message"), REFUSED[:2] + REFUSED[3:])
def test_what_motions_under_records_refuse_with_a_bank(contacts, more, message):
    record = fm.Record([0.0, 1.0, 0.0], dt=0.5)
    with pytest.raises(fm.InputError) as error:
        fm.history(fm.System(contacts=contacts, **CHAIN, **more), record, 0.1)
    assert message in str(error.value)
    varying = replace(HALVES, normal_record=record)
    with pytest.raises(fm.InputError, match=r"cannot use contacts\[1\].normal_record with a bank"):
        fm.history(fm.System(contacts=[varying], **CHAIN), record, 0.1)


def test_other_questions_about_a_bank_are_refused():
    system = fm.System(contacts=[HALVES], **CHAIN)
    free = fm.System(contacts=[HALVES], mass_ratios=[1.0, 1.0], stiffness_ratios=[0.0, 1.0])
    with pytest.raises(fm.InputError, match=r'a bank of 2 elements as one contact.*bank = "elements"'):
        fm.sweep(free, [0.5], [0.1])
    with pytest.raises(fm.InputError, match="cannot find friction without stops with contact_stiffness"):
        fm.design.no_stop(system, [0.5, 0.9])


def test_a_bank_in_a_configuration(tmp_path):
    """The file of a map says what makes it again, the key among it."""
    text = (
        "[system]\ndamping_ratios = 0.03\n[[system.contacts]]\nstiffness = [1.0, 0.5]\nratio = [0.4, 0.6]\n"
        'bank = "contact"\n[grid]\nr = 0.8\nbeta = [0.3, 0.6]\n'
    )
    (tmp_path / "bank.toml").write_text(text)
    given = fm.load_config(tmp_path / "bank.toml")
    assert given.system.contacts[0].bank == "contact"
    ds = fm.sweep(given)
    (tmp_path / "again.toml").write_text(ds.attrs["config"])
    again = fm.sweep(fm.load_config(tmp_path / "again.toml"))
    assert again.slips_per_cycle.equals(ds.slips_per_cycle)
