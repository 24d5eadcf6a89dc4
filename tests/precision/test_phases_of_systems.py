"""Contacts that open, gaps and backlash through the public functions: an independent event-exact program, the
balance of work, and limiting cases that other systems cover.
"""

import numpy as np
import pytest

import frictionmap as fm

B1 = {
    "matrices": {"M": np.eye(2), "K": np.array([[1.0, 0.2], [0.2, 1.2]]), "C": np.diag([0.04, 0.06])},
    "frequency_scale": 1.0, "load": [1.0, 0.5 + 0.6j],
}  # fmt: skip
NORMAL = {"mass": 2, "stiffness": 1.0, "friction": 0.4, "preload": 0.5}

#: r, highest and lowest displacements, slips, separations, share of the period open, share without slip.
ELASTIC = (
    (0.8, (2.3309904118758054, 0.5803005630005217), (-2.7138218453577636, -0.47259769299183374), 2, 0, 0.0,
     0.09483435101518682),
    (1.2, (2.1174842109092933, 3.8101868800560146), (-1.2570789962742661, -4.835805257481928), 1, 1,
     0.5333617876152689, 0.14787477542632047),
    (1.5, (1.0906744354820745, 1.9939018383029714), (-1.4960715612356539, -2.3419627059714587), 1, 1,
     0.4707128166993673, 0.11546192251655356),
)  # fmt: skip


def extremes(ds):
    """Highest and lowest displacements of the masses."""
    half = 0.5 * ds["peak_to_peak"].values
    return ds["midpoint"].values + half, ds["midpoint"].values - half


@pytest.mark.parametrize("case", ELASTIC)
def test_a_damper_that_opens(case):
    r, highest, lowest, slips, liftoffs, opened, stuck = case
    system = fm.System(**B1, contacts=[{"stiffness": 3.0, "normal": NORMAL}])
    ds = fm.response(system, r, 0.2)
    assert ds["status"].item() == fm.regimes.RESOLVED
    np.testing.assert_allclose(extremes(ds)[0], highest, rtol=1e-10)
    np.testing.assert_allclose(extremes(ds)[1], lowest, rtol=1e-10)
    assert ds["slips_per_cycle"].item() == slips
    assert ds["separations_per_cycle"].item() == liftoffs
    assert ds["open_fraction"].item() == pytest.approx(opened, abs=1e-7)  # stored with 24 bits
    assert ds["elastic_fraction"].item() == pytest.approx(stuck, abs=1e-7)


def test_rigid_contact_gap_backlash_and_wedge():
    rigid = fm.response(fm.System(**B1, contacts=[{"normal": NORMAL}]), 1.5, 0.2)
    np.testing.assert_allclose(extremes(rigid)[0], (0.8975825682113759, 1.8636286167823697), rtol=1e-10)
    assert rigid["turns_per_cycle"].item() == 1.0
    assert rigid["open_fraction"].item() == pytest.approx(0.4685141349067165, abs=1e-7)
    gap = fm.response(fm.System(damping_ratios=0.05, springs=[{"gap": 0.5, "stiffness": 4.0}]), 1.3, 0.0)
    np.testing.assert_allclose(np.ravel(extremes(gap)), (3.6145435569785445, -7.0487722996193325), rtol=1e-10)
    assert gap["spring_crossings"].item() == 2.0
    play = fm.System(damping_ratios=0.05, springs=[{"backlash": 0.5, "stiffness": 4.0}])
    assert extremes(fm.response(play, 0.6, 0.0))[0].item() == pytest.approx(0.8808091746636038, rel=1e-10)
    wedge = {"normal": {"mass": 1, "stiffness": 0.3, "friction": 0.3, "preload": 1.0}}
    found = fm.response(fm.System(damping_ratios=0.01, contacts=[wedge]), 0.7, 0.3)
    np.testing.assert_allclose(
        np.ravel(extremes(found)), (1.1486021133160609, -1.3713551447365806), rtol=1e-10
    )


def moved(vector):
    """Kind and masses of a contact or spring that a vector stands for; None of other vectors."""
    rows = np.flatnonzero(vector)
    values = np.array(vector)[rows].tolist()
    if values == [1.0]:
        return {"kind": "fixed-wall", "masses": [int(rows[0]) + 1]}
    return {"kind": "between-masses", "masses": (rows + 1).tolist()} if values == [-1.0, 1.0] else None


def system_of(row):
    """The system of a row; None where a vector is no kind of contact."""
    contacts, springs = [], []
    for one in row["contacts"]:
        where = moved(one["c"])
        if where is None:
            return None
        if one["kind"] == "spring":
            knots = np.array(one["knots"])
            springs.append(
                {
                    "masses": where["masses"], "displacement": knots[:, 0].tolist(),
                    "force": knots[:, 1].tolist(), "stiffness_below": one["slopes"][0],
                    "stiffness_above": one["slopes"][1],
                }
            )  # fmt: skip
            continue
        keys = {"stiffness": one.get("kt"), "wall_speed": one.get("wall_speed", 0.0), **where}
        keys["mu"] = None if one.get("kt") else one["mu"]
        if "d" in one:
            own = {"vector": one["d"], "stiffness": one["kn"], "friction": one["phi"], "preload": one["N0"]}
            contacts.append({**keys, "normal": own})
        else:
            contacts.append({**keys, "force": one["beta"]})
    matrices = {name: np.array(row[name]) for name in "MK"}
    if np.any(row["C"]):
        matrices["C"] = np.array(row["C"])
    loads = {int(n): np.array([complex(*z) for z in load]) for n, load in row["loads"].items()}
    more = {"contacts": contacts} if contacts else {}
    more |= {"springs": springs} if springs else {}
    return fm.System(
        matrices=matrices, frequency_scale=1.0, load_harmonics=loads, load_offset=row.get("offset"), **more
    )


def test_rows_of_an_independent_program(reference_table):
    content = reference_table("laws.json")
    rows = [row for row in [*content["B"], *content["examples"]] if row["law"] == "B"]
    used = 0
    for row in rows:
        if row["load"] != "periodic" or (system := system_of(row)) is None:
            continue
        used += 1
        ds = fm.response(system, row["r"], 0.0)
        assert ds["period"].item() == row["period"]
        size = max(np.abs(row["x_max"]).max(), np.abs(row["x_min"]).max())
        for found, expected in zip(extremes(ds), (row["x_max"], row["x_min"]), strict=True):
            assert np.abs(found - expected).max() < 1e-10 * size
        given = ds["work_input"] + np.sum(ds.get("work_wall", 0.0))
        taken = ds["work_damping"] + np.sum(ds["work_friction"])
        assert abs(given - taken) < 1e-11 * max(1.0, abs(given))
    assert used >= 20


def two(**keys):
    return fm.System(mass_ratios=[1, 0.8], stiffness_ratios=[1, 0.7], damping_ratios=0.03, **keys)


def test_equal_slopes_are_a_linear_spring():
    """A spring between the masses whose knots change nothing, and the same in K."""
    knots = {
        "displacement": [-0.3, 0.4],
        "force": [-0.15, 0.2],
        "stiffness_below": 0.5,
        "stiffness_above": 0.5,
    }
    k = np.array([[1.7, -0.7], [-0.7, 0.7]]) + 0.5 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    c = two().modes.damping
    linear = fm.System(matrices={"M": np.diag([1.0, 0.8]), "K": k, "C": c}, frequency_scale=1.0)
    broken = two(springs=[{"masses": [1, 2], **knots}])
    for r in (0.5, 1.3):
        one, other = (fm.curves(system, [r], [0.0])["amplitude"].values for system in (broken, linear))
        np.testing.assert_allclose(one, other, rtol=1e-11)


def test_a_stop_that_is_never_reached_changes_nothing():
    """Far gaps beside an ordinary contact with friction: maps of the engine for constant stiffness."""
    r, beta, outputs = (
        [0.6, 1.4],
        [0.1, 0.4],
        ["regime", "stops_per_cycle", "contact_amplitude", "work_friction"],
    )
    far = fm.sweep(two(springs=[{"gap": 1e3, "stiffness": 1.0}]), r, beta, [1.0, 1.2], outputs=outputs)
    near = fm.sweep(two(), r, beta, [1.0, 1.2], outputs=outputs)
    np.testing.assert_array_equal(far["regime"], near["regime"])
    np.testing.assert_array_equal(far["stops_per_cycle"], near["stops_per_cycle"])
    np.testing.assert_allclose(far["contact_amplitude"], near["contact_amplitude"], rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(far["work_friction"], near["work_friction"], rtol=1e-9, atol=1e-12)


def test_a_normal_force_on_a_mass_of_its_own_is_constant_friction():
    """d on a mass that nothing moves; response, curves and harmonics of the general engine."""
    k = np.array([[1.0, -0.5, 0.0], [-0.5, 1.5, 0.0], [0.0, 0.0, 1.0]])
    keys = {"matrices": {"M": np.eye(3), "K": k, "C": 0.05 * k}, "frequency_scale": 1.0}
    normal = {"mass": 3, "stiffness": 2.0, "friction": 0.4}
    for stiffness in (None, 3.0):
        one, other = (
            fm.curves(
                fm.System(**keys, contacts=[{"stiffness": stiffness, **more}]), [0.5, 1.3], [0.3],
                quantities=["amplitude", "phase", "first_harmonic", "energy", "harmonics"],
            )
            for more in ({}, {"normal": normal})
        )  # fmt: skip
        for name in set(one.data_vars) & set(other.data_vars):
            found, expected = other[name].values, one[name].values
            np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-11, err_msg=str(name))


def test_signs_and_units_of_length():
    """side, and all displacements turned round: d, the gap and the load."""
    contact = {"stiffness": 2.0, "normal": {"mass": 2, "stiffness": 1.0, "friction": 0.4, "preload": 0.5}}
    mirrored = {**contact, "normal": {**contact["normal"], "side": -1}}
    gap = {"masses": [1, 2], "gap": 0.4, "stiffness": 1.5}
    one = fm.response(two(contacts=[contact], springs=[gap], load=[1.0, 0.5j]), 1.2, 0.2)
    turned = two(contacts=[mirrored], springs=[{**gap, "side": -1}], load=[-1.0, -0.5j])
    other = fm.response(turned, 1.2, 0.2)
    np.testing.assert_allclose(one["x"].values, -other["x"].values, atol=1e-11)
    np.testing.assert_allclose(one["normal_force"].values, other["normal_force"].values, atol=1e-11)
    np.testing.assert_allclose(one["spring_force"].values, -other["spring_force"].values, atol=1e-11)


def test_base_motion_is_a_load_and_its_work_is_balanced():
    """The springs of the chain end at the base; the gap is to the ground."""
    keys = {
        "contacts": [{"masses": [2], "force": 0.1}],
        "springs": [{"masses": [2], "gap": 0.5, "stiffness": 2.0}],
    }
    based = fm.response(two(excitation="base", damping_reference="base", **keys), 0.7, 0.0)
    load = 1.0 + 1j * 0.7 * two().modes.damping.sum(axis=1)[0]
    second = 1j * 0.7 * two().modes.damping.sum(axis=1)[1]
    forced = fm.response(two(load=[load, second], **keys), 0.7, 0.0)
    np.testing.assert_allclose(based["x"].values, forced["x"].values, atol=1e-11)
    taken = based["work_damping"] + based["work_friction"].sum()
    assert based["work_input"].item() == pytest.approx(taken.item(), rel=1e-12)


@pytest.mark.parametrize(("stiffness", "mu"), [(3.0, 1.0), (None, 1.2)])
def test_walls_that_move_with_the_base_are_fixed_ones_under_loads(stiffness, mu):
    """Relative to the base r^2 M 1 cos(tau) is the load, where nothing else is fixed to the ground."""
    r, beta, masses = 0.7, 0.06, np.array([1.0, 0.5])
    normal = {"masses": [1, 2], "stiffness": 1.0, "friction": 0.4}
    chain = {
        "mass_ratios": masses.tolist(), "stiffness_ratios": [1.0, 0.8], "damping_ratios": 0.05,
        "springs": [{"masses": [1, 2], "gap": 0.3, "stiffness": 2.0}],
    }  # fmt: skip
    keys = {"masses": [1], "stiffness": stiffness, "normal": normal}
    moving = fm.System(
        **chain, excitation="base", damping_reference="base", contacts=[{**keys, "kind": "joined-base-wall"}]
    )
    still = fm.System(**chain, load=(r**2 * masses).tolist(), contacts=[{**keys, "kind": "fixed-wall"}])
    one, other = (fm.response(system, r, beta, mu) for system in (moving, still))
    assert 0.0 < float(other.open_fraction) < 1.0
    np.testing.assert_allclose(one.x.values - np.cos(one.tau.values), other.x.values, atol=1e-10)
    for name in ("z", "friction", "open", "normal_force", "event_tau", "event_z", "event_direction",
                 "contact_amplitude", "work_friction", "contact_harmonic", "spring_force"):  # fmt: skip
        np.testing.assert_allclose(one[name].values, other[name].values, atol=1e-10, err_msg=name)
    taken = float(one.work_friction + one.work_damping)
    assert float(one.work_input) == pytest.approx(taken, rel=1e-12)
    del chain["springs"]
    systems = (
        fm.System(**chain, excitation="base", damping_reference="base",
                  contacts=[{**keys, "kind": "joined-base-wall"}]),
        fm.System(**chain, load=(r**2 * masses).tolist(), contacts=[{**keys, "kind": "fixed-wall"}]),
    )  # fmt: skip
    name = "beta_noslip" if stiffness else "beta_stick"
    limits = [fm.boundaries(system, [r], mu=[mu])[name].values for system in systems]
    np.testing.assert_allclose(limits[0], limits[1], rtol=1e-12)


def test_stiff_impacts_are_named():
    """From 10 omega_1 on, and only where the contact opens."""
    for stiffness, opens, expected in ((1000.0, True, True), (1.0, True, False), (1000.0, False, False)):
        normal = {"mass": 2, "stiffness": stiffness, "friction": 0.4, "preload": 0.5 if opens else 500.0}
        system = fm.System(**B1, contacts=[{"stiffness": 3.0, "normal": normal}])
        ds = fm.sweep(system, [1.2], [0.2], cycles=200)
        assert ("makes impacts without loss" in ds.attrs.get("comment", "")) == expected
    axes = {"contacts[1].normal.preload": [0.5, 500.0]}
    normal = {"mass": 2, "stiffness": 1000.0, "friction": 0.4, "preload": 0.5}
    study = fm.sweep(
        fm.System(**B1, contacts=[{"stiffness": 3.0, "normal": normal}]), [1.2], [0.2], cycles=200, axes=axes
    )
    assert "makes impacts without loss" in study.attrs["comment"]


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (
            {"contacts": [{"law": {"speed": [0.0, 1.0], "factor": [1.0, 0.5]}}]},
            "contacts[1].law beside contacts",
        ),
        ({"contacts": [{"normal_load": {1: 0.2}}]}, "contacts[1].normal_load beside contacts"),
    ],
)
def test_contacts_of_other_systems_are_refused_with_a_gap(keys, message):
    with pytest.raises(fm.InputError) as error:
        fm.sweep(two(springs=[{"gap": 0.5, "stiffness": 1.0}], **keys), [0.5], [0.2])
    assert message in str(error.value)


@pytest.mark.parametrize("r", [0.0, 1e-6])
def test_frequencies_without_a_motion_in_time_are_refused(r):
    with pytest.raises(fm.InputError, match=r"^r must be >"):
        fm.sweep(two(springs=[{"gap": 0.5, "stiffness": 1.0}]), [r, 1.0], [0.2])


def test_outputs_of_other_systems_are_refused():
    with pytest.raises(fm.InputError, match="cannot compute acceleration_amplitude with contacts that open"):
        fm.sweep(
            two(springs=[{"gap": 1.0, "stiffness": 1.0}]), [1.0], [0.2], outputs=["acceleration_amplitude"]
        )
