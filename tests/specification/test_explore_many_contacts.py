"""The page of a system with many contacts: one is found by number or name, and some are drawn and listed."""

import numpy as np
import pytest
from browser import page_of
from pages import packet, scene_from, served

import frictionmap as fm
from frictionmap.explorer.drawing import drawing_curves, drawing_of
from frictionmap.files.config import config_of

STOREYS = 14


def dampers():
    """A contact with a spring in every storey."""
    for k in range(1, STOREYS + 1):
        kind, masses = ("between-masses", [k - 1, k]) if k > 1 else ("joined-base-wall", [1])
        yield (
            f'[[system.contacts]]\nname = "damper {chr(96 + k)}"\nkind = "{kind}"\n'
            f"masses = {masses}\nstiffness = 0.5\n"
        )


TALL = f"""\
[system]
excitation = "base"
damping_reference = "base"
mass_ratios = {[1.0] * STOREYS}
stiffness_ratios = {[1.0] * STOREYS}
damping_ratios = 0.02
{"".join(dampers())}
[grid]
r = [0.8, 0.9]
beta = [5.0, 6.0]
"""


@pytest.fixture(scope="module")
def tall(tmp_path_factory):
    with served(scene_from(tmp_path_factory.mktemp("tall"), TALL)) as server:
        yield server


def test_masses_of_the_shown_contact_are_drawn_and_move():
    system = config_of(TALL, {}).system
    every, last = drawing_of(system), drawing_of(system, STOREYS - 1)
    assert every["rows"] == list(range(8))
    assert [one["row"] for one in every["contacts"]] == list(range(8))
    assert last["rows"] == [*range(6), 12, 13]
    assert last["contacts"][-1] == {
        "row": 13, "name": "damper n", "masses": [6, 7], "base": False, "elastic": True, "belt": 0.0,
    }  # fmt: skip
    forces = fm.System("fixed-wall", [12], load=[0.0] * 11 + [2.0], mass_ratios=[1.0] * 12,
                       stiffness_ratios=[1.0] * 12)  # fmt: skip
    tau = np.linspace(0.0, 2.0 * np.pi, 5)
    np.testing.assert_allclose(drawing_curves(forces, tau, 0)["load"], [2.0 * np.cos(tau)], atol=1e-6)


def test_a_motion_of_many_contacts_has_few_sentences(tall):
    header, arrays = packet(tall, "/motion?at=0.85,0.05")
    regime = fm.response(config_of(TALL, {}).system, 0.85, 0.05).contact_regime.values
    counted = {
        "never slide or slip": (regime == fm.regimes.PERMANENT_STICKING).sum(),
        "move and rest in turn": (regime == fm.regimes.STICK_SLIP).sum(),
    }
    for words, count in counted.items():
        told = [text for text in header["summary"] if words in text]
        assert len(told) == (count > 0)
        assert all(text.startswith(f"{count} of {STOREYS} contacts {words}") for text in told)
    assert sum(counted.values()) == STOREYS
    assert len(header["listed"]) == 8
    assert arrays["states"].shape[0] == len(header["contacts"]) == STOREYS
    moving = set(np.flatnonzero(regime != fm.regimes.PERMANENT_STICKING).tolist())
    assert len(moving & set(header["listed"])) == min(8, len(moving))
    groups = {entry["group"] for entry in header["entries"]} - {"masses and all contacts"}
    assert groups == {header["contacts"][k] for k in header["listed"]}


def test_a_contact_is_found_by_number_and_by_name(browser, tall):
    with page_of(browser, tall.url, wait="#find-contact", viewport={"width": 1280, "height": 800}) as page:
        labels = "() => [...document.querySelectorAll('#contact option')].map((one) => one.label)"
        assert len(page.evaluate(labels)) == STOREYS + 1
        assert page.is_hidden("[name='contacts[12].ratio'][type=range]")
        page.fill("#find-contact", "12")
        assert page.evaluate(labels) == ["12 damper l"]
        page.keyboard.press("Enter")
        page.wait_for_function("() => location.hash.includes('contact=contact-12')")
        assert page.input_value("#contact") == "contact-12"
        assert page.is_visible("[name='contacts[12].ratio'][type=range]")
        assert page.is_hidden("[name='contacts[11].ratio'][type=range]")
        page.wait_for_timeout(1600)  # choices of one moment are one step
        page.fill("#find-contact", "DAMPER C")
        assert page.evaluate(labels) == ["3 damper c"]
        assert page.inner_text(".found") == f"1 of {STOREYS + 1} fit"
        page.keyboard.press("ArrowDown")
        page.wait_for_function("() => location.hash.includes('contact=contact-3')")
        page.focus("#find-contact")
        page.keyboard.press("Escape")
        assert len(page.evaluate(labels)) == STOREYS + 1
        page.go_back()
        page.wait_for_function("() => document.querySelector('#contact').value === 'contact-12'")
        page.fill("#find-contact", "no such")
        assert page.evaluate(labels) == []
        page.keyboard.press("Enter")
        page.wait_for_timeout(300)
        assert "contact=contact-12" in page.url
