"""Systems with several contacts, springs, belts and periodic loads in configurations, files and refusals."""

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap.command_line.cli import main

TWO_CONTACTS = """\
title = "two contacts"
[system]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 1.0]
damping_ratios = 0.01
[[system.contacts]]
kind = "fixed-wall"
masses = [1]
[[system.contacts]]
name = "joint"
kind = "between-masses"
masses = [1, 2]
force = 0.2
[grid]
r = { values = [0.5, 0.9] }
beta = { values = [0.1, 0.5, 2.0] }
"""

BELT = """\
[system]
damping_ratios = 0.02
wall_velocity = 0.3
load_harmonics = [{ n = 1, mass = 1, amplitude = 1.0 }, { n = 2, mass = 1, amplitude = 0.35, phase_deg = 20 }]
[grid]
r = { values = [0.5, 3.0] }
beta = { values = [0.2, 0.6] }
"""


def written(folder, text, *command):
    """Run a command on a configuration in a folder; return the dataset that it writes."""
    (folder / "c.toml").write_text(text)
    out = folder / f"{len(list(folder.iterdir()))}.nc"
    assert main([command[0], str(folder / "c.toml"), "-o", str(out), "--quiet", *command[1:]]) == 0
    return xr.load_dataset(out)


def test_a_map_of_two_contacts(tmp_path):
    asked = '["regime", "stops_per_cycle", "turns_per_cycle", "contact_amplitude", "peak_to_peak"]'
    ds = written(tmp_path, TWO_CONTACTS, "map", "--set", f"solver.outputs={asked}")
    assert ds.stops_per_cycle.dims == ("mu", "r", "beta", "contact")
    assert ds.regime.dims == ("mu", "r", "beta")
    assert ds.peak_to_peak.dims == ("mu", "r", "beta", "dof")
    assert ds.contact.values.tolist() == [1, 2]
    assert ds.contact_name.values.tolist() == ["fixed-wall 1", "joint"]
    cell = ds.sel(mu=1.0, r=0.5, beta=0.5)
    assert cell.stops_per_cycle.values.tolist() == [2.0, 2.0]
    assert cell.turns_per_cycle.values.tolist() == [0.0, 2.0]
    assert cell.contact_amplitude.values == pytest.approx([1.586051307411, 0.802820764235], abs=1e-11)
    assert (ds.contact_regime == 0).sel(beta=2.0).values.all()
    assert ds.attrs["system"].count("friction between") == 2


def test_the_stored_configuration_makes_the_same_map(tmp_path):
    for text in (TWO_CONTACTS, BELT):
        (tmp_path / "c.toml").write_text(text)
        config = fm.load_config(tmp_path / "c.toml")
        ds = fm.sweep(config.system, config.r, config.beta, config.mu)
        (tmp_path / "again.toml").write_text(ds.attrs["config"])
        again = fm.load_config(tmp_path / "again.toml")
        other = fm.sweep(again.system, again.r, again.beta, again.mu)
        for name in ds.data_vars:
            assert ds[name].equals(other[name]), name


def test_a_belt_has_a_regime_of_its_own(tmp_path, capsys):
    ds = written(tmp_path, BELT, "map")
    assert ds.regime.attrs["flag_meanings"].split()[-1] == "one_way_sliding"
    assert ds.regime.attrs["flag_values"].tolist() == [-1, 0, 1, 2, 3]
    assert (ds.regime.sel(r=3.0) == fm.regimes.ONE_WAY_SLIDING).all()
    assert np.isinf(ds.beta_stick).all()
    assert main(["info", str(tmp_path / "1.nc")]) == 0
    assert "2 one way sliding" in capsys.readouterr().out


def test_a_motion_that_slides_one_way(tmp_path, capsys):
    ds = written(tmp_path, BELT, "response", "--r", "3.0", "--beta", "0.2")
    assert int(ds.regime) == fm.regimes.ONE_WAY_SLIDING
    (path,) = tmp_path.glob("*.nc")
    capsys.readouterr()
    assert main(["info", str(path)]) == 0
    assert "one_way_sliding" in capsys.readouterr().out.replace(" ", "_")


def test_a_motion_of_two_contacts(tmp_path):
    ds = written(tmp_path, TWO_CONTACTS, "response", "--r", "0.5", "--beta", "0.5")
    assert ds.z.dims == ds.friction.dims == ds.direction.dims == ("contact", "tau")
    assert ds.x.dims == ("dof", "tau")
    assert sorted(set(ds.event_contact.values.tolist())) == [1, 2]
    balance = ds.work_input - ds.work_damping - ds.work_friction.sum()
    assert abs(float(balance)) < 1e-11 * float(ds.work_input)
    stuck = ds.direction.values == 0
    assert np.abs(np.diff(ds.z.values)[stuck[:, :-1] & stuck[:, 1:]]).max() < 1e-12


def test_curves_and_boundaries_of_two_contacts(tmp_path):
    ds = written(tmp_path, TWO_CONTACTS, "curves")
    assert ds.contact_harmonic.dims == ("mu", "r", "beta", "contact", "harmonic", "part")
    ds = written(tmp_path, TWO_CONTACTS, "boundaries")
    assert ds.beta_stick_contact.dims == ("mu", "r", "contact")


def test_an_elastic_contact(tmp_path):
    text = BELT.replace("wall_velocity = 0.3", "contact_stiffness = 3.0")
    ds = written(tmp_path, text, "map")
    assert {"slips_per_cycle", "beta_noslip"} <= set(ds.data_vars)
    assert not {"stops_per_cycle", "beta_lim", "beta_stick"} & set(ds.data_vars)


BANKS = [
    ({"stiffness": [3.0, 0.7, 1.1], "ratio": [0.2, 0.5, 0.3]}, [{"ratio": b} for b in (0.2, 0.5, 0.3)]),
    ({"stiffness": [3.0, 0.7, 1.1], "ratio": 0.8}, [{"ratio": 0.8 / 3}] * 3),
    ({"stiffness": np.array([3.0, 0.7, 1.1])}, [{"ratio": 1 / 3}] * 3),
    ({"stiffness": (3.0, 0.7, 1.1), "force": [0.1, 0.2, 0.3]}, [{"force": b} for b in (0.1, 0.2, 0.3)]),
]


@pytest.mark.parametrize(("given", "written_out"), BANKS)
def test_a_bank_is_its_elements_to_the_bit(given, written_out):
    """With a rigid contact beside it; the elements count as contacts, and have names."""
    wall = fm.Contact("fixed-wall", 2, ratio=0.4)
    chain = {"mass_ratios": [1.0, 0.8], "stiffness_ratios": [1.0, 0.6], "damping_ratios": 0.02}
    bank = fm.Contact(masses=1, name="joint", **given)
    elements = [
        fm.Contact(masses=1, name=f"joint, element {k}", stiffness=kt, **own)
        for k, (kt, own) in enumerate(zip((3.0, 0.7, 1.1), written_out, strict=True), 1)
    ]
    asked = ["regime", "slips_per_cycle", "contact_amplitude", "amplitude", "elastic_fraction"]
    one, other = (
        fm.sweep(fm.System(contacts=contacts, **chain), [0.5, 0.9], [0.3, 1.0], outputs=asked)
        for contacts in ([bank, wall], [*elements, wall])
    )
    assert one.contact_name.values.tolist()[1] == "joint, element 2"
    assert one.drop_attrs().equals(other.drop_attrs())
    assert hash(bank) == hash(fm.Contact(masses=1, name="joint", **given))


def test_a_bank_in_the_form_of_one_contact(tmp_path):
    """beta is shared equally; the file says what makes it again."""
    text = BELT.replace("wall_velocity = 0.3", "contact_stiffness = [3.0, 0.7]")
    ds = written(tmp_path, text, "map")
    entry = "[[system.contacts]]\nmasses = [1]\nratio = 0.5\nstiffness = "
    head, grid = BELT.replace("wall_velocity = 0.3\n", "").split("[grid]")
    both = written(tmp_path, f"{head}{entry}3.0\n{entry}0.7\n[grid]{grid}", "map")
    bank = written(tmp_path, f"{head}{entry.replace('0.5', '[0.5, 0.5]')}[3.0, 0.7]\n[grid]{grid}", "map")
    assert ds.slips_per_cycle.equals(both.drop_vars("contact_name").assign_coords(ds.coords).slips_per_cycle)
    for one in (ds, bank):
        (tmp_path / "again.toml").write_text(one.attrs["config"])
        again = fm.load_config(tmp_path / "again.toml")
        same = fm.sweep(again.system, again.r, again.beta, again.mu)
        assert same.equals(one[list(same.data_vars)])
        assert ds.contact_name.values.tolist() == ["fixed-wall 1, element 1", "fixed-wall 1, element 2"]


def test_friction_of_one_contact_as_a_further_axis(tmp_path):
    text = TWO_CONTACTS + '[axes]\n"contacts[2].force" = [0.1, 0.2]\n'
    ds = written(tmp_path, text, "map")
    assert ds.stops_per_cycle.dims[0] == "contacts_2_force"
    one = written(tmp_path, TWO_CONTACTS, "map")
    assert (
        ds.contact_amplitude.sel(contacts_2_force=0.2)
        .drop_vars("contacts_2_force")
        .equals(one.contact_amplitude)
    )


def test_every_map_has_a_status(tmp_path):
    """Also where it was not asked for and every cell is resolved, in studies and in files."""
    system = fm.System(contact_stiffness=2.0, damping_ratios=0.05)
    for further in ({}, {"axes": {"damping_ratios": [0.05, 0.1]}}):
        ds = fm.sweep(system, [0.7], [0.2], outputs=["regime"], **further)
        assert not ds.status.any()
    ds = fm.sweep(fm.System(damping_ratios=0.05), [0.7], [0.2], axes={"contact_stiffness": [1.0, 2.0]})
    assert not ds.status.any()
    ds = written(tmp_path, TWO_CONTACTS, "map", "--set", 'solver.outputs=["regime"]')
    assert ds.status.dims == ("mu", "r", "beta")


def test_threads_and_grids_change_no_bit():
    system = fm.System(
        contacts=[fm.Contact("fixed-wall", 1)], damping_ratios=0.02, load_harmonics={1: 1, 3: 0.3}
    )
    r, beta = np.linspace(0.3, 1.5, 6), np.linspace(0.0, 1.2, 7)
    one = fm.sweep(system, r, beta, threads=1)
    assert one.equals(fm.sweep(system, r, beta, threads=2))
    assert one.isel(r=[2]).equals(fm.sweep(system, r[[2]], beta))


def test_loads_in_three_forms(tmp_path):
    """A table, a list and a mapping of the same load."""
    (tmp_path / "orders.csv").write_text("n,mass,amplitude,phase_deg\n1,1,1,0\n2,1,0.35,90\n")
    (tmp_path / "c.toml").write_text(
        '[system]\ndamping_ratios = 0.02\nload_file = "orders.csv"\n[grid]\nr = 0.7\nbeta = 0.3\n'
    )
    entries = [
        {"n": 1, "mass": 1, "amplitude": 1.0},
        {"n": 2, "mass": 1, "amplitude": 0.35, "phase_deg": 90.0},
    ]
    systems = [
        fm.load_config(tmp_path / "c.toml").system,
        fm.System(damping_ratios=0.02, load_harmonics=entries),
        fm.System(damping_ratios=0.02, load_harmonics={1: 1.0, 2: 0.35j}),
        fm.System(damping_ratios=0.02, load_harmonics=fm.PeriodicLoad({1: 1.0, 2: 0.35j})),
    ]
    first, *others = (fm.sweep(system, [0.7], [0.3]).contact_amplitude.item() for system in systems)
    assert others == [first] * 3


@pytest.mark.parametrize("name", ["square", "sawtooth", "triangle"])
def test_waveforms_are_the_series_of_their_samples(name):
    """To the error of samples across a jump, which falls like one over their number."""
    count = 20_000
    tau = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    wave = {
        "square": np.where(np.cos(tau) > 0.0, 1.0, -1.0),
        "triangle": 1.0 - 2.0 * np.minimum(tau, 2.0 * np.pi - tau) / np.pi,
        "sawtooth": np.where(tau < np.pi, tau, tau - 2.0 * np.pi) / np.pi,
    }[name]
    sampled = fm.PeriodicLoad.from_samples(tau, wave, harmonics=9)
    forces = fm.System(waveform=name, harmonics=9).general.forces
    shift = 0.5 * 2.0 * np.pi / count  # samples begin half a step after tau = 0
    for n, vector in forces.items():
        assert sampled.harmonics[n] * np.exp(-1j * n * shift) == pytest.approx(vector[0], abs=2e-4)


def test_what_is_cut_off_of_samples():
    t = np.linspace(0.0, 1.0, 64, endpoint=False)
    load = fm.PeriodicLoad.from_samples(
        t, 0.3 + np.cos(2 * np.pi * t) + 0.2 * np.sin(10 * np.pi * t), harmonics=3
    )
    assert load.harmonics[1] == pytest.approx(1.0)
    assert load.mean == pytest.approx(0.3)
    assert load.cut_off == pytest.approx(0.2 / np.sqrt(2.0))


WALL, JOINT = {"kind": "fixed-wall", "masses": [1]}, {"kind": "between-masses", "masses": [1, 2]}
THREE = {"mass_ratios": [1, 1, 1], "stiffness_ratios": [1, 1, 1]}
LOOP = [{"kind": "between-masses", "masses": list(pair)} for pair in ((1, 2), (2, 3), (1, 3))]
REFUSED = [
    ({"contacts": []}, "contacts must be a list of contacts; got []"),
    ({"contacts": [WALL] * 65}, "contacts must be at most 64; got 65"),
    ({"contacts": [{**WALL, "kind": "wall"}]}, "contacts[1].kind must be one of fixed-wall"),
    ({"contacts": [{**WALL, "ratio": 1, "force": 1}]}, "cannot use contacts[1].ratio with force"),
    ({"contacts": [{**WALL, "mu": 0.5}]}, "contacts[1].mu must be >= 1; got 0.5"),
    ({"contacts": [{**WALL, "ratio": -1}]}, "contacts[1].ratio must be >= 0; got -1"),
    ({"contacts": [{**WALL, "stiffness": 0}]}, "contacts[1].stiffness must be > 0; got 0"),
    ({"contacts": [{**WALL, "stiffness": 1, "mu": 2}]}, "contacts[1].mu must be 1 for a contact"),
    ({"contacts": [{**WALL, "masses": [2]}]}, "contacts[1].masses[0] must be <= 1; got 2"),
    ({"contacts": [{**WALL, "force": 0.0}]}, "contacts must have a ratio or a force > 0; got none"),
    ({"contacts": [{**WALL, "width": 1}]}, "unknown key 'contacts[1].width'"),
    ({"contacts": [WALL], "contact_stiffness": 1.0}, "cannot use contact_stiffness with contacts"),
    ({"contacts": [WALL], "contact": "joined-base-wall"}, "cannot use contact with contacts"),
    ({"contact_stiffness": -1.0}, "stiffness must be > 0; got -1"),
    ({"contact_stiffness": [1.0, 0.0]}, "contact_stiffness[1] must be > 0; got 0"),
    ({"contact_stiffness": []}, "contact_stiffness must have at least one value; got none"),
    ({"contact_stiffness": [1.0] * 201}, "stiffness must have at most 200 elements; got 201"),
    ({"contacts": [{**WALL, "ratio": [1, 2]}]}, "contacts[1].ratio must be one number unless stiffness is"),
    (
        {"contacts": [{**WALL, "stiffness": [1, 2], "ratio": [1]}]},
        "contacts[1].ratio must have as many values as stiffness (2); got 1",
    ),
    ({"contacts": [{**WALL, "bank": "contact"}]}, "cannot use contacts[1].bank without a list of stiffness"),
    ({"contacts": [{**WALL, "stiffness": [1, -2]}]}, "contacts[1].stiffness[1] must be > 0; got -2"),
    (
        {"contacts": [{**WALL, "stiffness": [1, 2], "force": [1, 0]}]},
        "contacts[1].force[1] must be > 0; got 0",
    ),
    (
        {"contacts": [{**WALL, "stiffness": [1.0] * k, "bank": "elements"} for k in (5, 60)]},
        "contacts must have at most 64 elements in all; got 65",
    ),
    ({"normal_load": {1: 1.5}}, "normal_load must leave 1 + normal_load(tau) >= 0"),
    ({"wall_velocity": 0.1, "contact": "joined-base-wall"}, "wall_velocity must be 0 for joined-base-wall"),
    ({"load_harmonics": []}, "load_harmonics must have a harmonic that is not zero; got none"),
    ({"load_harmonics": {0: 1.0}}, "load_harmonics: order must be >= 1; got 0"),
    ({"load_harmonics": {201: 1.0}}, "load_harmonics: order must be <= 200; got 201"),
    ({"load_harmonics": [{"n": 1.5, "mass": 1, "amplitude": 1}]}, "load_harmonics[0].n must be"),
    ({"load_harmonics": [{"n": 1, "amplitude": 1}], "excitation": "force"}, "load_harmonics[0] must name"),
    ({"load_harmonics": {1: [1.0, 0.0]}}, "load_harmonics[1] must have one finite number per mass (1)"),
    ({"load_harmonics": {1: 1.0}, "waveform": "square"}, "cannot use load_harmonics with waveform"),
    ({"waveform": "sine"}, "waveform must be one of square, sawtooth, triangle, or a CSV file"),
    ({"harmonics": 5}, "cannot use harmonics without waveform"),
    ({"load_offset": [1.0, 2.0]}, "load_offset must have one finite number per mass (1)"),
]  # fmt: skip


@pytest.mark.parametrize(("keys", "message"), REFUSED)
def test_refusals(keys, message):
    with pytest.raises(fm.InputError) as error:
        fm.System(**keys)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


NOT_OFFERED = [
    (lambda s: fm.sweep(s, [1.0], [0.1], outputs=["sliding_limit"]), "cannot compute sliding_limit"),
    (lambda s: fm.curves(s, [1.0], [0.1], quantities=["distortion"]), "cannot compute distortion"),
    (lambda s: fm.continuous_motion(s, 1.0, 0.1), "cannot compute the continuous motion"),
    (lambda s: fm.features.peak_thresholds(s), "cannot compute peak thresholds"),
    (lambda s: fm.identify.friction_ratio(1.0, 20.0, system=s), "cannot identify friction"),
    (lambda s: fm.sweep(s, [1e-6], [0.1]), "r must be 0, or >="),
]


@pytest.mark.parametrize(
    ("further", "named"),
    [([(4, 5)], "1, 2, 3"), ([(4, 5), (5, 6), (4, 6)], "1, 2, 3, 4, 5, 6")],
    ids=["a loop and a contact", "two loops"],
)
def test_motions_in_time_refuse_loops_and_name_all_of_their_contacts_and_no_others(further, named):
    pairs = [(1, 2), (2, 3), (1, 3), *further]
    contacts = [fm.Contact("between-masses", pair) for pair in pairs]
    system = fm.System(contacts=contacts, mass_ratios=[1] * 6, stiffness_ratios=[1] * 6)
    with pytest.raises(fm.InputError, match=f"cannot use contacts {named} together: they close a loop"):
        fm.history(system, fm.Record([0.0, 1.0, 0.0], 0.1, quantity="force"), 0.1)


def test_even_harmonics_leave_the_boundary_of_a_loop_unknown():
    ds = fm.sweep(fm.System(contacts=LOOP, load_harmonics={1: 1.0, 2: 0.2}, **THREE), [0.5], [0.1])
    assert np.isnan(ds.beta_stick.item())
    assert ds.status.item() == fm.regimes.RESOLVED


@pytest.mark.parametrize(
    ("further", "message"),
    [
        ([fm.Contact("fixed-wall", 1, stiffness=1.0)], "must all be rigid"),
        ([fm.Contact("fixed-wall", 1, wall_velocity=0.1)], "without belts"),
        ([fm.Contact("fixed-wall", 1, normal_load={2: 0.1})], "varying normal loads"),
    ],
)
def test_what_else_a_system_with_a_loop_may_not_have(further, message):
    system = fm.System(contacts=[*LOOP, *further], **THREE)
    for call in (lambda: fm.sweep(system, [0.5], [0.1]), lambda: fm.boundaries(system, [0.5])):
        with pytest.raises(fm.InputError, match=message):
            call()


def test_motions_of_a_loop_need_equal_friction():
    with pytest.raises(fm.InputError, match=r"mu must be 1 for motions of contacts .*; got 1.2"):
        fm.sweep(fm.System(contacts=LOOP, **THREE), [0.5], [0.1], [1.2])


@pytest.mark.parametrize(("call", "message"), NOT_OFFERED)
def test_what_is_not_offered_is_refused_by_name(call, message):
    with pytest.raises(fm.InputError) as error:
        call(fm.System(load_harmonics={1: 1.0, 2: 0.3}))
    assert message in str(error.value)


def test_new_outputs_of_a_plain_system_are_refused_by_name():
    with pytest.raises(fm.InputError, match="cannot compute turns_per_cycle for one rigid contact"):
        fm.sweep(fm.System(), [1.0], [0.1], outputs=["turns_per_cycle"])


def test_the_order_of_release_in_a_file(tmp_path, capsys):
    """Where it matters, mu > 1, several contacts; for one contact it is refused by name."""
    asked = 'solver.outputs=["regime", "release_order", "stops_per_cycle_error"]'
    text = TWO_CONTACTS.replace("force = 0.2", "ratio = 0.6")
    cells = ["--set", "grid.r={values=[0.28, 0.5]}", "--set", "grid.beta={values=[0.05, 0.3]}"]
    ds = written(tmp_path, text, "map", "--set", asked, "--set", "grid.mu=[1.0, 1.5]", *cells)
    assert ds.release_order.dims == ("mu", "r", "beta")
    assert ds.release_order.dtype == np.int8
    assert (ds.release_order.sel(mu=1.0) == 0).all()
    assert set(np.unique(ds.release_order.sel(mu=1.5))) == {0, 1}
    assert ds.stops_per_cycle_error.dims == ("mu", "r", "beta", "contact")
    assert main(["info", str(tmp_path / "1.nc")]) == 0
    assert "release_order" in capsys.readouterr().out
    with pytest.raises(fm.InputError, match="cannot compute release_order for one rigid contact"):
        fm.sweep(fm.System(), [0.5], [0.5], outputs=["release_order"])
