"""The live page of a run: charts that grow, verdict so far, cursor, stop, and the end."""

from __future__ import annotations

import json
import os
import re
import subprocess
from typing import TYPE_CHECKING, Any

import pytest
from conftest import SCENARIOS, WORKSPACE, watched
from playwright.sync_api import expect

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from playwright.sync_api import Browser, Page

# Notes the length of the longest array of the page.
LONGEST_ARRAY = """
    window.longest = 0;
    window.Float32Array = new Proxy(Float32Array, {
      construct(type, given) {
        const made = new type(...given);
        window.longest = Math.max(window.longest, made.length);
        return made;
      },
    });
"""
# A machine that is shared wakes late; these runs are about the page.
SETTINGS = ["allow.late=1000000", "controller.parameters.watchdog_us=60000000"]


class LiveRun:
    """A run that starts once its page is open."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        """Starts it with these further arguments and reads its URL."""
        program = os.environ.get("LASHLOOP_BIN", str(WORKSPACE / "target" / "debug" / "lashloop"))
        settings = [word for setting in SETTINGS for word in ("--set", setting)]
        live = ["--live", "--live-wait", "60", "--out", str(folder), "--quiet"]
        scenario = str(SCENARIOS / "faults.toml")
        command = [program, "run", scenario, "--device", "inproc", *settings, *live, *arguments]
        self.folder = folder
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=WORKSPACE)
        assert self.process.stdout
        self.url = self.process.stdout.readline().removeprefix("live").strip()

    def end(self) -> dict[str, Any]:
        self.process.communicate(timeout=100)
        summary: dict[str, Any] = json.loads((self.folder / "summary.json").read_text())
        return summary


@pytest.fixture
def pages(browser: Browser) -> Iterator[Any]:
    """Opens live pages, which may request only their own server and must not log."""
    opened = []

    def open_page(run: LiveRun, width: int = 1280, scheme: str = "light", script: str = "") -> Page:
        context = watched(browser, width, scheme, has_touch=False)
        page, watch = context.__enter__()
        opened.append((context, run, watch))
        page.add_init_script(script)
        page.goto(run.url)
        page.wait_for_selector("g.curves path[d]:not([d=''])", state="attached", timeout=60_000)
        return page

    yield open_page
    for context, run, watch in opened:
        context.__exit__(None, None, None)
        assert watch.messages == []
        assert watch.requests, "the page is loaded from the run"
        assert all(url.startswith(run.url.partition("?")[0]) or url == "data:," for url in watch.requests)


def test_page_of_a_complete_run_has_the_numbers_of_its_summary(pages: Any, tmp_path: Path) -> None:
    run = LiveRun(tmp_path, "--live-token=0123456789abcdef")
    page = pages(run)
    expect(page.locator("#connection")).to_have_text("the run has ended", timeout=60_000)
    summary = run.end()
    assert page.locator("#badge").inner_text() == summary["verdict"]
    assert str(tmp_path) in page.locator("#why").inner_text()
    titles = page.locator(".chart:visible h3").all_text_contents()
    own = [it for it in titles if it.startswith("Drive's own signals")]
    assert titles[1 : 1 + len(own)] == own
    assert [it for it in titles if it not in own] == [
        "Load position",
        "Torque",
        "Twist and gap",
        "Gap, enlarged",
        "Dead-zone estimate",
        "Disturbing torque",
    ]
    enlarged = page.locator(".chart", has=page.get_by_role("heading", name="Gap, enlarged", exact=True))
    enlarged.scroll_into_view_if_needed()
    # The gap of 0.16 rad fills the height, whatever the twist.
    for tick in ("0.1", "\u22120.1"):
        expect(enlarged.locator(".grid text", has_text=re.compile(f"^{re.escape(tick)}$"))).to_have_count(1)
    energy = page.locator(".chart", has=page.get_by_role("heading", name="Signals in J", exact=True))
    assert energy.is_hidden()
    page.get_by_role("button", name="Signals in J", exact=True).click()
    expect(energy).to_be_visible()
    expect(energy.locator("g.curves path").first).to_have_attribute("d", re.compile("^M.{20}"))
    page.get_by_role("button", name=own[0], exact=True).click()
    assert page.locator(".chart", has=page.get_by_role("heading", name=own[0], exact=True)).is_hidden()
    left, right = (page.locator(".chart:visible").nth(index).bounding_box() for index in (0, 1))
    assert left is not None
    assert right is not None
    assert left["y"] == right["y"], "two charts are side by side"
    rows = page.locator("#expectations tr")
    assert rows.count() == len(summary["expectations"])
    for row, expected in zip(rows.all(), summary["expectations"], strict=True):
        shown = float(row.locator("td").first.inner_text().split()[0])
        assert shown == pytest.approx(expected["value"], rel=1e-4)
        assert row.locator("td").last.inner_text() == ("met" if expected["ok"] else "missed")
    page.locator(".plot").first.hover(position={"x": 300, "y": 60})
    assert "cursor at" in page.locator("#cursor-time").inner_text()
    assert page.locator("#stop").is_disabled()
    page.screenshot(path=str(WORKSPACE / "target" / "browser-live.png"), full_page=True)


def test_stop_ends_a_run_whose_charts_grow(pages: Any, tmp_path: Path) -> None:
    run = LiveRun(tmp_path, "--clock", "real-time", "--set", "run.duration_s=600", "--set", "expect=[]")
    page = pages(run, width=360, scheme="dark")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), "nothing is wider than a phone"
    progress = page.locator("#progress")
    before = progress.get_attribute("value")
    assert before is not None
    expect(progress).not_to_have_attribute("value", before, timeout=60_000)
    page.get_by_role("button", name="last 2 s").click()
    page.get_by_role("button", name="Stop the run").click()
    expect(page.locator("#badge")).to_have_text("INVALID", timeout=60_000)
    assert "interrupted by the user" in page.locator("#why").inner_text()
    assert run.end()["end"] == "interrupted by the user"


def test_page_keeps_as_much_of_a_long_run_as_the_bench(pages: Any, tmp_path: Path) -> None:
    # 20,000 fine buckets, of which the bench keeps 2,000, and 4,000 of the whole run, of which it keeps 5,000.
    run = LiveRun(tmp_path, "--set", "run.duration_s=200", "--set", "expect=[]", "--set", "fault=[]")
    page = pages(run, script=LONGEST_ARRAY)
    expect(page.locator("#connection")).to_have_text("the run has ended", timeout=100_000)
    assert run.end()["steps"] == 200_000
    # A bucket has two values, and an array twice the buckets: the older half goes when it is full.
    assert 0 < page.evaluate("window.longest") <= 2 * 2 * 5_000
    box = "(it) => it.getBoundingClientRect().width"
    plot = page.locator(".plot").first.evaluate(box)
    assert page.locator("g.curves path").first.evaluate(box) > 0.8 * plot, "the curve covers the whole run"
