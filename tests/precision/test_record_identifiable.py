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


@pytest.mark.whole
@pytest.mark.slow
def test_what_everything_free_gives_is_not_called_found():
    """It is wrong: damping is many times the true one, and mu is beyond 2."""
    ds = fit(FALLING)
    assert value(ds, "zeta") > 4.0 * FALLING.zeta
    assert float(ds.residual_rms) < 0.06 < 0.05 * float(ds.data.max())
    assert code(ds) == "not_identified"
    words = headline(ds)
    assert "not identifiable: " in words
    assert "found" not in words
    assert "zeta" in words
    assert "x_F" in words
    assert "mu" in words.split(" cannot ")[0]
    for remedy in ("f_n and zeta from a free decay", "mu = 1", "several records together"):
        assert remedy in words
    assert float(ds.model_error) > 10.0
    assert "does not explain the record down to its noise" in ds.warnings


@pytest.mark.parametrize("known", [{}, HELD])
def test_the_spring_of_the_contact_is_found_that_nobody_mentioned(known):
    """With a rigid contact damping was many times the true one, or friction some percent too large."""
    ds = fit(ELASTIC, **known)
    assert code(ds) == "spring_found"
    assert "explains the data with a spring in the contact (contact_stiffness" in headline(ds)
    exact = {"f_n": 3.13, "zeta": 0.0055, "x_F": 0.84, "contact_stiffness": 40.0}
    for name in [name for name in exact if name not in known]:
        assert abs(value(ds, name) - exact[name]) < 4.0 * value(ds, name, "standard_error"), name


def test_a_spring_that_is_not_found_leaves_no_friction_found():
    """The sum of squares has many least values; the best one is missed, and the verdict says so."""
    ds = fit(ELASTIC._replace(x_F=0.55), **HELD)
    assert code(ds) in ("spring_found", "not_explained")
    if code(ds) == "not_explained":
        assert "must not be used" in headline(ds)
    assert value(ds, "x_F", "lower") <= 0.55 <= value(ds, "x_F", "upper")


@pytest.mark.slow
def test_a_decay_with_the_record_gives_damping_and_friction():
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
