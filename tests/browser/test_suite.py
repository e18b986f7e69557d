"""The page of a suite: its badge, its rows, and the way to each record."""

from __future__ import annotations

import shlex
import signal
import subprocess
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest
from conftest import OUTPUT, PROGRAM, WORKSPACE, Opener
from test_accessibility import CONTRAST

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Page

SCENARIO = """
title = "short"
[run]
duration_s = {duration_s}
mode = "{mode}"
[plant]
model = "{model}"
[controller]
name = "pd"
[reference]
profile = "constant"
position_rad = 0.0
{rest}
"""
PEAK = """
[[expect]]
metric = "peak_tracking_error_rad"
unit = "rad"
max = {max}
"""
SWEEP = """
[[sweep.axis]]
key = "encoders.noise_counts"
values = [0.1, 0.2]
"""


def scenario(rest: str = "", duration_s: float = 1.5, mode: str = "hil") -> str:
    model = "smooth" if mode == "hil" else "backlash-shaft"
    return SCENARIO.format(duration_s=duration_s, mode=mode, model=model, rest=rest)


@dataclass
class Suite:
    """A folder of scenarios, and what `lashloop test` leaves."""

    folder: Path
    scenarios: dict[str, str]

    @property
    def out(self) -> Path:
        return self.folder / "out"

    @property
    def page(self) -> Path:
        return self.out / "index.html"

    def start(self, device: str) -> tuple[list[str], subprocess.Popen[str]]:
        for name, text in self.scenarios.items():
            path = self.folder / "s" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        words = [PROGRAM, "test", self.folder / "s", "--device", device, "--jobs", "2", "--out", self.out]
        words += ["--html", self.page]
        texts = list(map(str, words))
        return texts, subprocess.Popen(texts, cwd=WORKSPACE, stdout=subprocess.PIPE, text=True)

    def run(self, device: str = "inproc") -> tuple[list[str], int]:
        words, process = self.start(device)
        process.communicate(timeout=100)
        return words, process.returncode


def picture(page: Page, name: str) -> None:
    OUTPUT.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=OUTPUT / f"{name}.png", full_page=True)


def rows(page: Page) -> dict[str, str]:
    """Verdict of each case by the name of its file and its settings."""
    verdicts = {}
    for row in page.locator("table.suite tbody tr").all():
        name, *others = row.locator("th").inner_text().split("\n")
        settings = [line for line in others if " = " in line]
        verdicts[" ".join([name.split("/s/")[1], *settings])] = row.locator(".grade").inner_text()
    return verdicts


@pytest.fixture(scope="module")
def failing(tmp_path_factory: pytest.TempPathFactory) -> tuple[Suite, list[str]]:
    """Every verdict but INVALID, on a drive without pins."""
    scenarios = {
        "good.toml": scenario(PEAK.format(max=10)),
        "marginal.toml": scenario(PEAK.format(max=1.6)),
        "more/missed.toml": scenario(PEAK.format(max=0.1) + SWEEP),
        "pins.toml": scenario(mode="bench"),
        "wrong.toml": scenario(duration_s=-1),
    }
    suite = Suite(tmp_path_factory.mktemp("suite"), scenarios)
    words, code = suite.run("native")
    assert code == 2
    return suite, words


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 360])
def test_a_failing_suite_has_a_row_for_each_case_and_nothing_overflows(
    open_page: Opener, failing: tuple[Suite, list[str]], width: int, scheme: str
) -> None:
    suite, words = failing
    page = open_page(suite.page, width, scheme)
    picture(page, f"suite-failing-{width}-{scheme}")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate(CONTRAST)["poor"] == []
    assert page.title() == "ERROR: Scenarios"
    assert page.locator(".badge").inner_text() == "ERROR"
    assert rows(page) == {
        "good.toml": "PASS",
        "marginal.toml": "marginal",
        "more/missed.toml encoders.noise_counts = 0.1": "FAIL",
        "more/missed.toml encoders.noise_counts = 0.2": "FAIL",
        "pins.toml": "SKIPPED",
        "wrong.toml": "ERROR",
    }
    assert page.locator(".why").inner_text().startswith("2 of 6 cases passed in ")
    assert shlex.split(page.locator("#repeat code").inner_text()) == words


def test_a_filter_hides_the_rows_of_its_verdict(open_page: Opener, failing: tuple[Suite, list[str]]) -> None:
    page = open_page(failing[0].page)
    buttons = page.locator("[data-filter]")
    assert buttons.all_inner_texts() == ["PASS 1", "marginal 1", "FAIL 2", "ERROR 1", "SKIPPED 1"]
    for button in buttons.all()[:2]:
        button.click()
    shown = page.locator("table.suite tbody tr:visible .grade").all_inner_texts()
    assert shown == ["FAIL", "FAIL", "SKIPPED", "ERROR"]


def test_a_row_leads_to_the_report_of_its_record(open_page: Opener, failing: tuple[Suite, list[str]]) -> None:
    page = open_page(failing[0].page)
    links = page.locator("table.suite a")
    reports = [failing[0].out / str(link.get_attribute("href")) for link in links.all()]
    assert len(set(reports)) == 2
    for report, noise in zip(reports, ["0.1", "0.2"], strict=True):
        run = open_page(report)
        assert run.locator(".badge").inner_text() == "FAIL"
        cells = run.locator("table.overrides tbody tr").first.locator("th, td").all_inner_texts()
        assert cells[:2] == ["encoders.noise_counts", noise]


def test_an_interrupted_suite_is_incomplete(open_page: Opener, tmp_path: Path) -> None:
    scenarios = {"a.toml": scenario(), "b.toml": scenario(duration_s=1e5), "c.toml": scenario(duration_s=1e5)}
    suite = Suite(tmp_path, scenarios)
    _, process = suite.start("inproc")
    journal = suite.out / "cases.jsonl"
    until = time.monotonic() + 60
    while not (journal.exists() and journal.read_text().count("\n") == 2):
        assert time.monotonic() < until, "no result"
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode == 3
    page = open_page(suite.page)
    picture(page, "suite-interrupted")
    assert page.title() == "INCOMPLETE: Scenarios"
    assert page.locator(".badge").inner_text() == "INCOMPLETE"
    assert rows(page) == {"a.toml": "PASS", "b.toml": "NOT RUN", "c.toml": "NOT RUN"}
    assert page.locator(".why").inner_text().endswith("Interrupted; 1 of 3 cases have a result.")


def test_a_suite_of_skipped_cases_has_no_verdict(open_page: Opener, tmp_path: Path) -> None:
    suite = Suite(tmp_path, {name: scenario(mode="bench") for name in ("a.toml", "b.toml")})
    assert suite.run("native")[1] == 2
    page = open_page(suite.page, width=360)
    picture(page, "suite-skipped-360")
    assert (
        page.evaluate(
            "(({ scrollWidth, clientWidth }) => scrollWidth - clientWidth)(document.querySelector('.scroll'))"
        )
        == 0
    )
    assert page.locator(".badge").inner_text() == "NO VERDICT"
    assert rows(page) == {"a.toml": "SKIPPED", "b.toml": "SKIPPED"}
    assert page.locator(".why").inner_text().endswith("No case was run; 2 of 2 are skipped.")
