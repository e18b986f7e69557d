"""The page that compares several runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from conftest import OUTPUT, SCENARIOS, Opener, Record, lashloop, run

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="module")
def runs(records: Path) -> list[Record]:
    """Two laws on one plant, and another plant."""
    names = ["smooth-before", "smooth-after", "friction-after"]
    return [run(records / f"compared-{name}", SCENARIOS / f"{name}.toml") for name in names]


def test_runs_are_distinguishable_and_differences_are_to_the_first(
    open_page: Opener, runs: list[Record], tmp_path: Path
) -> None:
    path = tmp_path / "comparison.html"
    lashloop("report", *[it.folder for it in runs], "--out", path)
    page = open_page(path)
    OUTPUT.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=OUTPUT / "comparison.png", full_page=True)
    assert page.evaluate("document.documentElement.scrollWidth") <= 1280
    position = page.locator(".chart").first
    names = position.locator(".key-name").all_inner_texts()
    assert names == [it.folder.name for it in runs] + ["reference"]
    strokes = position.locator(".curves path").evaluate_all("all => all.map((it) => getComputedStyle(it).stroke)")
    assert len(set(strokes)) == 4
    row = page.locator("table.metrics tr", has=page.locator("code", has_text="overshoot_rad"))
    values = [float(it) for it in row.locator("data").evaluate_all("all => all.map((it) => it.value)")]
    metrics = [it.summary["metrics"]["overshoot_rad"] for it in runs]
    first, second, third = metrics
    assert values == pytest.approx([first, second, second - first, third, third - first])
    assert "digest of all torques" in page.locator("table.settings").inner_text()
