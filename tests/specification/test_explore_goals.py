"""Goals of a design on the page, without a browser: what the server answers, refuses and gives up."""

import itertools
import json
from urllib.parse import quote

import numpy as np
import pytest
from pages import ask, scene_from, served
from test_explore_contacts import ELASTIC, GRID, TWO

import frictionmap as fm
from frictionmap.design.watching import watched
from frictionmap.files.config import config_of

CHAIN = f"""\
[system]
contact = "fixed-wall"
contact_masses = [2]
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 1.0]
damping_ratios = 0.01
{GRID}
[units]
natural_frequency = "2.5 Hz"
load = "8 N"
stiffness = "4 N/mm"
"""
ONE = f"[system]\ndamping_ratios = 0.01\n{GRID}"
WALL = f'[system]\ncontact = "joined-base-wall"\nexcitation = "base"\n{GRID}'


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Servers by the configuration that they show."""
    with (
        served(scene_from(tmp_path_factory.mktemp("chain"), CHAIN)) as chain,
        served(scene_from(tmp_path_factory.mktemp("one"), ONE)) as one,
        served(scene_from(tmp_path_factory.mktemp("two"), TWO)) as two,
        served(scene_from(tmp_path_factory.mktemp("elastic"), ELASTIC)) as elastic,
        served(scene_from(tmp_path_factory.mktemp("wall"), WALL)) as wall,
    ):
        yield {CHAIN: chain, ONE: one, TWO: two, ELASTIC: elastic, WALL: wall}


def answer(page, query):
    status, body, _ = ask(page, f"/goal?{query}")
    assert status == 200, body
    return json.loads(body)


def ends(ds):
    """Ranges of an answer, as the page has them."""
    pairs = zip(ds.interval_begin.values.tolist(), ds.interval_end.values.tolist(), strict=True)
    return [[begin, end if np.isfinite(end) else None] for begin, end in pairs]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "of", "arguments", "band"),
    [
        (CHAIN, "mass-1", {"mass": 1}, [0.3, 2.2]),
        (CHAIN, "mass-1", {"mass": 1}, [0.5, 0.9]),
        (TWO, "mass-2", {"mass": 2}, [0.7, 1.8]),
        (ELASTIC, "mass-1", {"mass": 1}, [0.7, 1.8]),
        (ELASTIC, "contact-1", {"quantity": "contact"}, [0.7, 1.8]),
    ],
)
def test_a_least_peak_is_that_of_design(pages, text, of, arguments, band):
    system = config_of(text, {}).system
    ds = fm.design.least_peak(system, band, **arguments)
    found = answer(pages[text], f"goal=least-peak&band={band[0]},{band[1]}&of={of}")
    assert (found["beta"], found["peak"]) == (ds.beta.item(), ds.peak.values[0])
    assert found["kind"] == str(ds.kind.values)
    count = 2 if found["kind"] == "two equal peaks" else 1
    assert [peak["r"] for peak in found["peaks"]] == ds.peak_r.values[:count].tolist()
    assert [peak["stops"] for peak in found["peaks"]] == ds.peak_stops.values[:count].tolist()
    assert found["ranges"] == ends(fm.design.at_most(system, band, 1.05 * ds.peak.values[0], **arguments))
    assert any(low < found["beta"] < (high or np.inf) for low, high in found["ranges"])


@pytest.mark.parametrize("of", ["contact-1", "mass-2"])
def test_what_is_held_moves_least_where_it_is_stuck(pages, of):
    """Mass 2 is in contact with the wall."""
    found = answer(pages[CHAIN], f"goal=least-peak&band=0.3,0.9&of={of}")
    stuck = fm.design.stuck(config_of(CHAIN, {}).system, [0.3, 0.9]).beta.item()
    assert (found["peak"], found["kind"], found["peaks"]) == (0.0, "threshold", [])
    assert (found["beta"], found["ranges"]) == (stuck, [[stuck, None]])
    assert found["r"] == 0.9


def test_goals_have_the_values_of_independent_programs(pages):
    found = answer(pages[CHAIN], "goal=least-peak&band=0.3,2.2&of=mass-1")
    assert found["beta"] == pytest.approx(1.401948, rel=1e-5)
    assert found["peak"] == pytest.approx(2.727102937, rel=1e-8)
    assert found["peaks"][0]["r"] == pytest.approx(1.55202, rel=1e-5)
    assert found["peaks"][0]["regime"] == "continuous"
    found = answer(pages[CHAIN], "goal=at-most&band=0.3,2.2&of=mass-1&limit=4")
    assert found["ranges"] == [pytest.approx([0.956502710, 2.667833242], rel=1e-8)]
    found = answer(pages[ONE], "goal=no-stop&band=0.6,1.5")
    assert (found["beta"], found["r"]) == (pytest.approx(0.517959444748, rel=1e-11), 0.6)
    assert found["ranges"] == [[0.0, found["beta"]]]
    found = answer(pages[ONE], "goal=no-stop&band=0.6,1.5&mu=1.5")
    assert found["beta"] == found["some"] == pytest.approx(0.358713117310, rel=1e-11)
    found = answer(pages[ONE], "goal=stuck&band=0.6,1.5&mu=1.5")
    assert (found["beta"], found["some"]) == (1.0, pytest.approx(2.0 / 3.0, rel=1e-12))
    found = answer(pages[WALL], "goal=stuck&band=0.5,1.5")
    assert (found["beta"], found["r"], found["ranges"]) == (2.25, 1.5, [[2.25, None]])


def test_a_slider_and_units_belong_to_the_answer(pages):
    system = config_of(
        CHAIN.replace("ratios = [1.0, 1.0]\ndamping", "ratios = [1.0, 0.5]\ndamping"), {}
    ).system
    ds = fm.design.stuck(system, [0.3, 0.8])
    found = answer(pages[CHAIN], f"goal=stuck&band=0.3,0.8&{quote('stiffness_ratios[2]')}=0.5")
    assert found["beta"] == ds.beta.item()
    assert found["physical"]["force"] == {"unit": "N", "factor": 8.0}
    assert found["physical"]["length"] == {"unit": "mm", "factor": 2.0}
    assert found["units"]["length"] == "P/k₁"


def test_friction_that_never_holds_has_no_range(pages):
    """Two masses without damping: with the second one held, the first resonates at the square root of 2."""
    system = f"{quote('damping_ratios')}=0"
    found = answer(pages[CHAIN], f"goal=stuck&band=1.2,1.6&{system}")
    assert (found["beta"], found["ranges"]) == (None, [])
    assert found["r"] == pytest.approx(np.sqrt(2.0), rel=1e-12)


@pytest.mark.parametrize(
    ("text", "query", "message"),
    [
        (CHAIN, "goal=at-most&band=0.3,2.2&limit=1", "limit must be >= 2.7272 P/k1, the least peak"),
        (CHAIN, "goal=at-most&band=0.3,2.2", "limit must be given; got nothing"),
        (CHAIN, "goal=at-most&band=0.3,2.2&limit=0", "limit must be > 0; got 0"),
        (CHAIN, "goal=best&band=0.3,2.2", "goal must be one of least-peak, no-stop, stuck, at-most"),
        (CHAIN, "goal=least-peak&band=0.3", "band must be two frequencies; got 1"),
        (CHAIN, "goal=least-peak&band=0.3,x", "band must be a number; got 'x'"),
        (CHAIN, "goal=least-peak&band=2,1", "band must be two increasing frequencies; got 2 to 1"),
        (CHAIN, "goal=stuck&band=0,1", "band must be > 0; got 0"),
        (CHAIN, "goal=least-peak&band=1,2&of=mass-3", "of must be one of mass-1, mass-2, contact-1"),
        (ELASTIC, "goal=no-stop&band=1,2", "a spring in the contact has no such limit"),
        (TWO, "goal=least-peak&band=1,2&of=contact-3", "of must be one of mass-1"),
    ],
)
def test_what_is_refused_has_one_line(pages, text, query, message):
    status, body, _ = ask(pages[text], f"/goal?{query}")
    assert (status, body.decode().count("\n")) == (400, 1)
    assert message in body.decode()


def test_the_scene_names_what_a_goal_can_be_about(pages):
    _, body, _ = ask(pages[TWO], "/scene")
    labels = {one["key"]: one["label"] for one in json.loads(body)["subjects"]}
    assert labels == {
        "mass-1": "mass 1", "mass-2": "mass 2", "contact-1": "lower brace", "contact-2": "upper brace",
    }  # fmt: skip
    _, body, _ = ask(pages[ONE], "/scene")
    assert [one["label"] for one in json.loads(body)["subjects"]] == ["the mass", "the contact"]


class Stop(Exception):
    """The question is cancelled."""


@pytest.mark.parametrize(
    ("text", "question", "arguments"),
    [
        (CHAIN, fm.design.least_peak, {}),
        (CHAIN, fm.design.no_stop, {}),
        (TWO, fm.design.least_peak, {}),
        (TWO, fm.design.no_stop, {}),
        (ELASTIC, fm.design.at_most, {"limit": 10.0}),
    ],
)
def test_a_question_can_be_cancelled_and_is_not_changed_by_it(text, question, arguments):
    system, band = config_of(text, {}).system, [0.7, 1.8]
    plain, calls = question(system, band, **arguments), itertools.count()
    with watched(lambda: next(calls)):
        counted = question(system, band, **arguments)
    assert counted.drop_attrs().identical(plain.drop_attrs())
    assert next(calls) > 3  # below, the fourth look gives up

    left = iter(range(3))

    def give_up():
        if next(left, None) is None:
            raise Stop

    with watched(give_up), pytest.raises(Stop):
        question(system, band, **arguments)
    assert question(system, band, **arguments).beta == plain.beta  # nobody is asked any more


def test_a_newer_goal_cancels_the_one_before(pages):
    """With the numbers that requests have: the older one arrives later."""
    page = pages[CHAIN].page
    with page.jobs.enter("goal one", turn=7):
        status = page.answer("/goal?goal=least-peak&band=0.3,2.2&page=one&turn=3", lambda: False).status
    assert status == 204
    assert page.answer("/goal?goal=least-peak&band=0.3,2.2&page=one&turn=9", lambda: True).status == 204
    assert page.answer("/goal?goal=stuck&band=0.3,2.2&page=one&turn=9", lambda: False).status == 200
