"""The least peak in the plane of two friction forces: nothing better is found by brute force."""

from dataclasses import replace

import numpy as np
import pytest

import frictionmap as fm
from frictionmap import design
from frictionmap.files.designs import describe_design

CHAIN = fm.System(
    mass_ratios=[1, 1, 1],
    stiffness_ratios=[1, 1, 1],
    damping_ratios=0.05,
    load_mass=1,
    contacts=[fm.Contact(masses=[2], ratio=1.0), fm.Contact(masses=[3], ratio=0.5)],
)
BAND, FRICTION = (0.3, 1.7), (0.05, 3.0)


def with_ratio(ratio):
    return replace(CHAIN, contacts=[CHAIN.contacts[0], replace(CHAIN.contacts[1], ratio=ratio)])


@pytest.fixture(scope="module")
def answer():
    return design.two_forces(CHAIN, BAND, ratio=(0.5, 2.0), beta=FRICTION)


@pytest.mark.slow
def test_brute_force_finds_nothing_better(answer):
    """On a grid of frequencies a peak looks lower than it is, by less than 1e-3 here."""
    r, beta = np.linspace(*BAND, 141), np.linspace(0.3, 1.5, 25)
    found = []
    for ratio in np.linspace(0.5, 2.0, 16):
        ds = fm.sweep(with_ratio(float(ratio)), r, beta, outputs=["regime", "amplitude"])
        found.append(ds.amplitude.sel(dof=1).max("r").min().item())
    best = answer.peak.values[0]
    assert best * (1.0 - 1e-3) <= min(found) <= best * 1.02


@pytest.mark.slow
def test_the_answer_is_the_least_of_its_ridge(answer):
    k = int(answer.peak_of_ratio.values.argmin())
    assert answer.ratio_search.values[k] == answer.second_ratio.item()
    assert answer.peak_of_ratio.values[k] == pytest.approx(answer.peak.values[0], rel=1e-8)
    assert 0 < k < answer.sizes["ratio_search"] - 1
    assert (np.diff(answer.ratio_search) > 0).all()
    assert str(answer.kind.values) == "two equal peaks"


@pytest.mark.slow
def test_it_is_drawn_and_summarised(answer):
    assert len(fm.plot_design(answer)) == 3
    (line,) = [line for line in describe_design(answer) if line.startswith("friction of contact 2")]
    assert line.endswith(f"ratio {answer.second_ratio.item():.4g}")


@pytest.mark.parametrize(
    ("system", "options", "said"),
    [
        (fm.System(), {}, "^cannot vary two forces: the system has no list of contacts"),
        (CHAIN, {"second": 3}, "^second must be"),
        (CHAIN, {"ratio": (1.0, 0.5)}, "^ratio must be"),
        (CHAIN, {"ratio": (0.1, 0.5, 1.0)}, "^ratio must be two numbers; got 3"),
    ],
)
def test_what_is_refused(system, options, said):
    with pytest.raises(fm.InputError, match=said):
        design.two_forces(system, BAND, beta=FRICTION, **options)
