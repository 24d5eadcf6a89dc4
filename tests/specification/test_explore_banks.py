"""The page of banks as one contact."""

import numpy as np
import pytest
from pages import packet, scene_from, served
from test_explore_contacts import middles

import frictionmap as fm
from frictionmap.files.config import config_of

TEXT = """\
[system]
mass_ratios = [1.0, 0.8]
stiffness_ratios = [1.0, 1.2]
damping_ratios = 0.02
[[system.contacts]]
name = "joint"
kind = "between-masses"
masses = [1, 2]
bank = "contact"
stiffness = [0.5, 0.4, 0.3]
ratio = [0.2, 0.3, 0.5]
[[system.contacts]]
name = "damper"
masses = [1]
stiffness = 2.0
[grid]
r = [0.3, 1.8]
beta = [0.1, 1.0]
"""
R, BETA, SHAPE = (0.3, 1.8), (0.1, 1.0), (6, 4)
CHANGED = "&damping_ratios=0.1&contacts[2].stiffness=1.0"


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    with served(scene_from(tmp_path_factory.mktemp("page"), TEXT)) as found:
        yield found


@pytest.mark.parametrize("query", ["", CHANGED], ids=["as given", "changed"])
def test_a_map_is_that_of_the_changed_configuration(page, query):
    text = TEXT.replace("= 0.02", "= 0.1").replace("= 2.0", "= 1.0") if query else TEXT
    axes = (middles(*ends, count) for ends, count in zip((R, BETA), SHAPE, strict=True))
    ds = fm.sweep(config_of(text, {}).system, *axes, outputs=("regime",)).isel(mu=0)
    _, arrays = packet(page, f"/map?columns={SHAPE[0]}&rows={SHAPE[1]}{query}")
    stuck = arrays["classes"].reshape(SHAPE) == 1
    np.testing.assert_array_equal(stuck, ds.regime.values == fm.regimes.PERMANENT_STICKING)
    assert 0 < stuck.sum() < stuck.size


def test_a_motion_is_that_of_response(page):
    header, arrays = packet(page, "/motion?at=0.7,0.4&contact=contact-1")
    ds = fm.response(config_of(TEXT, {}).system, 0.7, 0.4, points=400)
    size = np.abs(ds.x.values).max()
    np.testing.assert_allclose(arrays["z"], ds.z.values[0], atol=1e-6 * size)
    np.testing.assert_allclose(arrays["friction"], ds.friction.values[0], atol=1e-6 * size)
    np.testing.assert_array_equal(arrays["direction"], ds.direction.values[0])
    listed = {entry["name"]: value for entry, value in zip(header["entries"], arrays["numbers"], strict=True)}
    assert listed["slips_per_cycle"] == ds.slips_per_cycle.values[0]


def test_its_boundary_is_that_of_boundaries(page):
    _, arrays = packet(page, "/lines?count=4")
    wanted = fm.boundaries(config_of(TEXT, {}).system, middles(*R, 4)).beta_noslip.values.ravel()
    np.testing.assert_allclose(arrays["line_noslip"], wanted, rtol=1e-12)
    assert np.isfinite(wanted).all()
