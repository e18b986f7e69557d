"""The page that compares several runs."""

from __future__ import annotations

import json
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
    gap = page.locator(".chart", has=page.get_by_role("heading", name="Gap, enlarged", exact=True))
    assert gap.locator(".key-name", has_text="edge").count() >= 2
    row = page.locator("table.metrics tr", has=page.locator("code", has_text="overshoot_rad"))
    values = [float(it) for it in row.locator("data").evaluate_all("all => all.map((it) => it.value)")]
    metrics = [it.summary["metrics"]["overshoot_rad"] for it in runs]
    first, second, third = metrics
    assert values == pytest.approx([first, second, second - first, third, third - first])
    settings = page.locator("table.settings")
    laws = settings.locator("tr", has=page.get_by_text("controller.name", exact=True)).locator("td code")
    assert laws.all_inner_texts()[1:] == [it.manifest["law"] for it in runs][1:]
    rows = page.locator("table.runs tbody tr")
    for row, record in zip(rows.all(), runs, strict=True):
        assert row.locator(".hash").get_attribute("title") == record.summary["torque_sha256"]


def test_a_diff_has_its_result_its_tolerances_and_the_first_difference(
    open_page: Opener, runs: list[Record], tmp_path: Path
) -> None:
    before, after, _ = runs
    path = tmp_path / "diff.html"
    options = ["--only", "torque_nm", "load_position_rad", "static_error_rad", "--tolerance", "torque_nm=1000"]
    result = json.loads(lashloop("diff", before.folder, after.folder, *options, "--json", "--html", path))
    page = open_page(path)
    page.screenshot(path=OUTPUT / "diff.png", full_page=True)
    assert page.locator("#result .result").inner_text() == "DIFFERENT"
    first = page.locator("table.first tbody tr")
    assert first.locator("th").all_inner_texts() == [it[0] for it in result["first"]["signals"]]
    rows = page.locator("table.differences tbody tr")
    shown = {row.locator("th").inner_text(): row for row in rows.all()}
    wanted = {it["name"]: it for it in [*result["signals"], *result["metrics"]]}
    assert shown.keys() == wanted.keys()
    for name, row in shown.items():
        a, b = (wanted[name].get("largest") or wanted[name])["values"]
        difference = float(row.locator("data").first.get_attribute("value") or "nan")
        assert difference == pytest.approx(b - a)
        assert row.locator(".grade").inner_text() == ("within" if name == "torque_nm" else "different")
    assert set(page.locator("table.settings tbody th").all_inner_texts()) == {it["key"] for it in result["settings"]}
    jump = page.locator("#result h3 .jump")
    jump.click()
    low, high = (float(edge.input_value()) for edge in page.locator("[data-edge]").all())
    assert low <= result["first"]["time_s"] <= high
