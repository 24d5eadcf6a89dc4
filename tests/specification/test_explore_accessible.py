"""The page for everybody: no serious finding of axe-core at several sizes, in light and in dark."""

import pytest
from browser import page_of, point
from pages import ONE, scene_from, served

#: A screen, a phone, a small window such as a screen at 200 %.
VIEWS = {
    "screen": {"viewport": {"width": 1280, "height": 800}},
    "dark": {"viewport": {"width": 1280, "height": 800}, "color_scheme": "dark"},
    "phone": {"viewport": {"width": 390, "height": 844}},
    "projector": {"viewport": {"width": 1920, "height": 1080}},
    "200 %": {"viewport": {"width": 640, "height": 400}},
}


@pytest.fixture(scope="module")
def one(tmp_path_factory):
    with served(scene_from(tmp_path_factory.mktemp("one"), ONE)) as server:
        yield server


@pytest.mark.parametrize("view", VIEWS)
def test_axe_finds_nothing_serious(browser, one, view):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    with page_of(browser, one.url, **VIEWS[view]) as page:
        page.locator("#stage").scroll_into_view_if_needed()
        page.mouse.click(*point(page, 0.3, 0.4))
        if view == "projector":
            page.keyboard.press("l")  # the page of a lecture
        page.wait_for_timeout(1000)
        found = axe.run(page).response
    serious = [one for one in found["violations"] if one["impact"] in ("serious", "critical")]
    assert [(one["id"], [node["target"] for node in one["nodes"]]) for one in serious] == []
    assert len(found["passes"]) > 10
