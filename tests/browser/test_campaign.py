"""The page of a campaign: its numbers, its maps, its choices."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from conftest import OUTPUT, SCENARIOS, Opener, lashloop
from test_accessibility import CONTRAST

if TYPE_CHECKING:
    from pathlib import Path

CAMPAIGN = """
title = "short"
scenario = "{scenario}"
set = ["run.duration_s=1.5", "meant=mismatch"]

[[variant]]
name = "wide"
[[variant]]
name = "narrow"
set = ["plant.dead_zone_rad=0.1"]

[[part]]
name = "grid"
[[part.axis]]
key = "plant.torque_delay_us"
label = "delay"
unit = "us"
values = [0, 500, 1000]
[[part.axis]]
key = "plant.load_inertia_kg_m2"
label = "inertia"
unit = "kg m^2"
values = [5, 7.5]
[[part.axis]]
key = "encoders.noise_counts"
label = "noise"
values = [0, 1]

[[expect]]
metric = "peak_tracking_error_rad"
quantile = 0.5
max = 1.0
[[expect]]
metric = "torque_total_variation_nm"
quantile = 1.0
max = 1000.0

[evidence]
worst = 1
of = "torque_total_variation_nm"
failures = 1
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("campaign")
    file = folder / "campaign.toml"
    file.write_text(CAMPAIGN.format(scenario=SCENARIOS / "shaft-pd.toml"))
    lashloop("campaign", "run", file, "--out", folder / "out")
    return folder / "out"


@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (360, "dark")])
def test_numbers_of_a_campaign_are_those_of_its_report(
    open_page: Opener, folder: Path, width: int, scheme: str
) -> None:
    report: dict[str, Any] = json.loads((folder / "report.json").read_text())
    page = open_page(folder / "report.html", width, scheme)
    OUTPUT.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=OUTPUT / f"campaign-{width}-{scheme}.png", full_page=True)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate(CONTRAST)["poor"] == []
    assert page.locator(".badge").inner_text() == report["verdict"] == "FAIL"
    values = page.locator("table.expectations tbody td:nth-child(3) data")
    assert [float(str(it.get_attribute("value"))) for it in values.all()] == [
        it["value"] for it in report["expectations"]
    ]
    page.locator("[data-choose]").select_option("torque_total_variation_nm")
    blocks = page.locator("[data-choice]:visible")
    assert [it.get_attribute("data-choice") for it in blocks.all()] == ["torque_total_variation_nm"]
    for group in report["groups"]:
        column = next(it for it in group["columns"] if it["column"] == "torque_total_variation_nm")
        row = blocks.locator(f"tr[data-variant={group['variant']}]")
        shown = {
            it: row.locator(f"[data-quantile={it}] data").get_attribute("value") for it in ["median", "p95", "max"]
        }
        assert {name: float(str(value)) for name, value in shown.items()} == {name: column[name] for name in shown}
    assert page.locator(".evidence article").count() == 2
    assert page.locator(".evidence article svg").count() == 4


def test_a_map_has_a_cell_for_each_pair_of_values_of_the_chosen_axes(open_page: Opener, folder: Path) -> None:
    page = open_page(folder / "report.html")
    drawings = page.locator("svg.map")
    assert drawings.count() == 2
    assert drawings.first.locator(".cell").count() == 6
    # Every run misses the expectations of the scenario within 1.5 s.
    assert set(drawings.first.locator(".value").all_text_contents()) <= {"0", "100\u202f%"}
    page.locator("[data-map=axes]").select_option(index=2)
    assert drawings.first.locator(".cell").count() == 4
    slices = page.locator("[data-map='further axes'] option").all_inner_texts()
    assert slices == ["worst over delay", "mean over delay", "delay 0", "delay 500", "delay 1000"]
    page.locator("[data-map=colour]").select_option(label="peak_tracking_error_rad in rad")
    page.locator("[data-map='further axes']").select_option(label="delay 1000")
    name = drawings.first.get_attribute("aria-label")
    assert name == "wide: peak_tracking_error_rad in rad \u00b7 delay 1000 \u00b7 limit \u2264 1 rad"
    values = [float(text) for text in drawings.first.locator(".value").all_text_contents()]
    assert len(values) == 4
    assert all(value > 1.0 for value in values), "the reference is a step beyond the limit"
    assert drawings.first.locator(".iso").get_attribute("d") == ""


def test_no_control_of_a_campaign_lacks_a_name_and_paper_has_every_table(open_page: Opener, folder: Path) -> None:
    page = open_page(folder / "report.html")
    nameless = page.evaluate(
        """[...document.querySelectorAll("select, button, a, svg[role=img]")].filter((it) =>
            !(it.getAttribute("aria-label") || it.closest("label")?.textContent || it.textContent).trim()).length"""
    )
    assert nameless == 0
    reached = set()
    for _ in range(20):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("Object.keys(document.activeElement.dataset)[0] || ''"))
    assert {"choose", "map", "copy"} <= reached
    page.emulate_media(media="print")
    # A4 less margins of 14 mm.
    page.set_viewport_size({"width": 688, "height": 1000})
    wide = page.evaluate(
        "[...document.querySelectorAll('svg, table')].filter((it) => it.checkVisibility()"
        " && it.getBoundingClientRect().right > innerWidth + 1).length"
    )
    assert wide == 0
