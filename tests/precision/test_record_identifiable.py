"""Records that a model of constant friction explains almost: what is called found, and what helps."""

import numpy as np
import pytest
from decays import Truth, synthetic
from imperfect import Rig, measured
from records import Truth as Record
from records import steady
from records import synthetic as noisy

import frictionmap as fm

#: Friction that falls from 1.6 times its value at high speed, and an elastic contact.
FALLING, ELASTIC = Rig(0.84, rise=0.6, contact=60.0), Rig(0.84)

HELD = {"f_n": 3.13, "zeta": 0.0055, "mu": 1.0}

#: A decay of the same mass with little friction.
DECAY = Truth(3.13, 0.0055, 0.2, 9.0, -0.03, 0.1, 250.0, 5.0, 0.02)


def fit(rig, **known):
    return fm.identify.record(*measured(rig, 1), damping_reference="base", known=known)


def code(ds):
    return ds.verdict.flag_meanings.split()[int(ds.verdict)]


def headline(ds):
    return str(ds.verdict.comment).split("; ")[int(ds.verdict)]


def value(ds, name, what="estimate"):
    return float(ds[what].sel(parameter=name))


@pytest.mark.parametrize("rig", [ELASTIC, pytest.param(FALLING, marks=pytest.mark.slow)])
def test_what_everything_free_gives_is_not_called_found(rig):
    """It is wrong: damping is many times the true one, and of FALLING mu is beyond 2."""
    ds = fit(rig)
    assert value(ds, "zeta") > 4.0 * rig.zeta
    assert float(ds.residual_rms) < 0.06 < 0.05 * float(ds.data.max())
    assert code(ds) == "not_identified"
    words = headline(ds)
    assert "not identifiable: " in words
    assert "found" not in words
    assert "zeta" in words
    assert "x_F" in words
    assert ("mu" in words.split(" cannot ")[0]) == (rig is FALLING)
    for remedy in ("f_n and zeta from a free decay", "mu = 1", "several records together"):
        assert remedy in words
    assert float(ds.model_error) > 10.0
    assert "does not explain the record down to its noise" in ds.warnings


def test_with_frequency_damping_and_mu_held_friction_is_found():
    """Elasticity of the contact makes x_F appear some percent larger; two records come in their order."""
    frictions = []
    for x_F in (0.55, 0.84):
        ds = fit(ELASTIC._replace(x_F=x_F), **HELD)
        assert code(ds) == "stick_slip"
        assert value(ds, "x_F") == pytest.approx(x_F, rel=0.04)
        frictions.append(value(ds, "x_F"))
    assert frictions[0] < frictions[1]


@pytest.mark.slow
def test_a_decay_beside_the_record_gives_damping_and_friction():
    """The model is still wrong, but the decay has a hold on f_n and zeta."""
    ds = fm.identify.joint(
        [synthetic(DECAY, 1), measured(ELASTIC, 1), measured(ELASTIC._replace(x_F=0.55), 2)],
        damping_reference="base", labels=["decay", "high", "low"],
    )  # fmt: skip
    assert code(ds) == "friction_found"
    for name, truth in (("f_n", 3.13), ("zeta", 0.0055), ("x_F_decay", 0.2)):
        assert abs(value(ds, name) - truth) < 4.0 * value(ds, name, "standard_error"), name
    assert value(ds, "x_F_high") == pytest.approx(0.84, rel=0.04)
    assert value(ds, "x_F_low") == pytest.approx(0.55, rel=0.04)
    assert "high: the model does not explain the record down to its noise" in ds.warnings


def test_a_record_that_the_model_explains_is_found_with_everything_free():
    truth = Record(
        3.13, 0.0055, 0.8372, 1.0, -0.1, 1.001, (0.0, 1.82 * np.exp(0.7j), 0.02 * np.exp(2.0j))
    )  # fmt: skip
    ds = fm.identify.record(*noisy(truth, steady(truth), 5), damping_reference="base")
    assert code(ds) == "stick_slip"
    assert float(ds.model_error) == 1.0
    assert (value(ds, "mu"), value(ds, "mu", "lower")) == (1.0, 1.0)
    assert np.isnan(value(ds, "mu", "standard_error"))
    for name, exact in (("f_n", 3.13), ("zeta", 0.0055), ("x_F", 0.8372)):
        assert abs(value(ds, name) - exact) < 4.0 * value(ds, name, "standard_error"), name
