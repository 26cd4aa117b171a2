"""The report in a real browser: opened from disk, offline, on a desktop and on a phone."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from vgvt.view import write_report

pytestmark = pytest.mark.browser

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
_FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


@pytest.fixture(scope="module")
def browser() -> Iterator[object]:
    executable = os.environ.get("VGVT_CHROMIUM") or next(filter(None, map(shutil.which, _NAMES)), None)
    if executable is None:
        pytest.skip("no Chromium on this machine; set VGVT_CHROMIUM to its path")
    playwright = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
    with playwright.sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=executable, args=_FLAGS)
        yield running
        running.close()


@pytest.fixture(scope="module")
def report(example, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_report(
        tmp_path_factory.mktemp("report") / "report.html",
        title="hati-like",
        campaign=example.campaign,
        frf=example.frf,
        claims=example.claims,
        truth=example.truth,
        scorecards=example.scorecards,
        facts={"Seed": "7"},
    )


@pytest.fixture(scope="module", params=[(1400, 1000), (420, 900)], ids=["desktop", "phone"])
def opened(browser, report: Path, request: pytest.FixtureRequest) -> Iterator[tuple[object, list[str], list[str]]]:
    """One page a screen: what one test turns or chooses in it, no other looks at."""
    width, height = request.param
    page = browser.new_page(viewport={"width": width, "height": height})
    troubles: list[str] = []
    requests: list[str] = []
    page.on("console", lambda message: troubles.append(message.text) if message.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: troubles.append(str(error)))
    page.on("request", lambda sent: requests.append(sent.url))
    page.goto(report.as_uri())
    page.wait_for_selector("#frf-figure .main-svg")
    yield page, troubles, requests
    page.close()


def wait_for_change(page, expression: str, before: str) -> None:
    """Polled from outside: the page's policy forbids evaluating strings inside."""
    for _ in range(100):
        if page.evaluate(expression) != before:
            return
        page.wait_for_timeout(50)
    pytest.fail(f"{expression} never changed")


def test_it_opens_quietly_and_offline(opened) -> None:
    page, troubles, requests = opened
    assert troubles == []
    assert [url for url in requests if not url.startswith(("file:", "data:", "blob:"))] == []
    assert len(requests) == 1
    for section in ("summary", "modes", "sigma", "shapes", "animation", "mac", "frf", "setup"):
        assert page.locator(f"section#{section}").bounding_box()["height"] > 50
    assert page.locator(".figure .main-svg").count() >= 4


def test_nothing_is_wider_than_the_screen(opened) -> None:
    page, _, _ = opened
    wide, screen = page.evaluate("[document.documentElement.scrollWidth, window.innerWidth]")
    assert wide <= screen


def test_the_animation_plays_pauses_and_changes_mode(opened) -> None:
    page, troubles, _ = opened
    picture = "document.getElementById('stage').toDataURL()"
    button = page.locator("#viewer-play")
    button.scroll_into_view_if_needed()
    assert button.get_attribute("aria-pressed") == "true"
    first = page.evaluate(picture)
    wait_for_change(page, picture, first)
    button.click()
    assert button.get_attribute("aria-pressed") == "false"
    still = page.evaluate(picture)
    page.wait_for_timeout(250)
    assert page.evaluate(picture) == still
    page.locator("#viewer-mode").select_option(index=2)
    assert page.evaluate(picture) != still
    turned = page.evaluate(picture)
    page.locator("#stage").focus()
    page.keyboard.press("ArrowLeft")
    assert page.evaluate(picture) != turned
    page.locator("#viewer-model").select_option(label="truth")
    assert page.locator("#viewer-mode option").count() == 5
    assert troubles == []


def test_the_frf_follows_the_choice(opened) -> None:
    page, troubles, _ = opened
    curve = "document.querySelector('#frf-figure path.js-line').getAttribute('d')"
    before = page.evaluate(curve)
    page.locator("#frf-select").select_option(index=0)
    wait_for_change(page, curve, before)
    assert troubles == []


def test_frequency_labels_of_the_lanes_do_not_overlap(opened) -> None:
    page, _, _ = opened
    boxes = page.evaluate(
        "[...document.querySelectorAll('[data-figure=sigma-data] .textpoint text')].map(t => {"
        "const b = t.getBoundingClientRect(); return [b.left, b.right, b.top, b.bottom]; }).filter(b => b[1] > b[0])"
    )
    assert len(boxes) >= 14
    for k, a in enumerate(boxes):
        for b in boxes[k + 1 :]:
            apart = a[1] <= b[0] + 1 or b[1] <= a[0] + 1 or a[3] <= b[2] + 3 or b[3] <= a[2] + 3
            assert apart, (a, b)


def test_less_motion_is_respected(browser, report: Path) -> None:
    page = browser.new_page(viewport={"width": 900, "height": 800}, reduced_motion="reduce")
    page.goto(report.as_uri())
    assert page.locator("#viewer-play").get_attribute("aria-pressed") == "false"
    page.close()
