"""The configurations of the worked examples load, agree with the schema, and show what the guides say."""

import tomllib

import jsonschema
import numpy as np
import pytest
from conftest import ROOT

import frictionmap as fm
from frictionmap.files.json_schema import map_schema

CONFIGS = sorted(path for name in ("contacts", "loads") for path in (ROOT / "configs" / name).glob("*.toml"))
SCHEMA = jsonschema.Draft202012Validator(map_schema())
STUCK = fm.regimes.PERMANENT_STICKING


def config(name):
    return fm.load_config(ROOT / "configs" / "contacts" / f"{name}.toml")


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_every_configuration_of_general_systems_loads(path):
    loaded = fm.load_config(path)
    assert loaded.system.general is not None
    assert loaded.title != path.stem
    assert loaded.r.size * loaded.beta.size > 1
    tree = tomllib.loads(path.read_text(encoding="utf-8"))
    assert not list(SCHEMA.iter_errors(tree))


def test_the_lower_storey_slips_first():
    """Braces that stick carry the inertia of the floors above them."""
    frame = config("two-storey-frame")
    equal = frame.variations.at([1])
    r = frame.r[::10]
    found = fm.boundaries(equal, r).beta_stick_contact[0]
    np.testing.assert_allclose(found, np.stack((2.0 * r**2, r**2), axis=-1), rtol=1e-12)
    half = fm.boundaries(frame.variations.at([0]), r).beta_stick_contact[0]
    np.testing.assert_allclose(half[:, 0], half[:, 1], rtol=1e-12)


def test_dampers_between_blades_that_move_in_phase_do_nothing():
    blades = config("three-blades").system
    together = fm.System(
        matrices=blades.matrices, damping_ratios=0.002, load=[1.0, 1.0, 1.0], contacts=blades.contacts
    )
    single = fm.System(damping_ratios=0.002, contact_stiffness=0.3)
    r, beta = [1.0, 1.05, 1.1, 1.2], [0.5, 1.3, 3.0]
    ds = fm.sweep(together, r, beta, outputs=["contact_regime", "amplitude"])
    one = fm.sweep(single, r, beta, outputs=["amplitude"])
    assert (ds.contact_regime[..., 3:] == STUCK).all()
    np.testing.assert_allclose(ds.amplitude, np.repeat(one.amplitude, 3, axis=-1), rtol=1e-9)


def test_blades_under_engine_order_1_move_alike():
    blades = config("three-blades").system
    ds = fm.sweep(blades, [1.04, 1.2], [0.5, 1.5], outputs=["contact_peak_to_peak"])
    for same in (slice(0, 3), slice(3, 6)):
        found = ds.contact_peak_to_peak[..., same].values
        np.testing.assert_allclose(found, np.broadcast_to(found[..., :1], found.shape), rtol=1e-9)


def test_blades_of_a_disk_whose_dampers_stick():
    """Engine order 4 of 24 blades: neighbours move 60 degrees apart: springs between them act fully."""
    disk = config("bladed-disk").system
    r = np.array([1.0, 1.1, 1.17])
    ds = fm.sweep(disk, r, [1e3], outputs=["contact_regime", "amplitude"])
    assert (ds.contact_regime == STUCK).all()
    blade, disks, dampers = 6.0e6, 2.4e5, 1.2e6 + 0.6e6
    inertia = 2.4 * (500.0 * np.pi) ** 2
    lost = 2.0 * 0.001 * np.sqrt((blade + disks) * inertia) * r
    wanted = blade / np.abs(blade + disks + dampers - inertia * r**2 + 1j * lost)
    np.testing.assert_allclose(ds.amplitude.isel(mu=0, beta=0), np.tile(wanted, (24, 1)).T, rtol=1e-9)


def test_a_bank_of_elements_in_parallel():
    """Forces of the elements are those of elastic, perfectly plastic ones along the motion of the joint."""
    beta, stiffness = 25.0, 4.0 / 6.0
    one = fm.response(config("lap-joint").system, 0.678, beta, points=4000)
    z, friction = one.z.values[:, :-1], one.friction.values[:, :-1]
    np.testing.assert_allclose(z, np.broadcast_to(z[0], z.shape), atol=1e-12)
    limit = beta * np.arange(1, 7) / 21.0
    assert (np.abs(friction).max(axis=1) <= limit + 1e-12).all()
    slips = np.abs(friction).max(axis=1) > limit - 1e-9
    assert slips.tolist() == [True, True, True, True, False, False]
    force = np.zeros(6)
    for cycle in range(2):
        traces = []
        for k in range(z.shape[1]):
            force = np.clip(force + stiffness * (z[:, k] - z[:, k - 1]), -limit, limit)
            traces.append(force)
        assert cycle == 0 or np.abs(np.transpose(traces) - friction)[slips].max() < 1e-5
