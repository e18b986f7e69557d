"""The page of one run: what it shows, and that it shows it everywhere."""

from __future__ import annotations

import json
import math
import re
import shlex
import shutil
import struct
from typing import TYPE_CHECKING

import pytest
from conftest import (
    DRAWN,
    OUTPUT,
    SCENARIOS,
    WORKSPACE,
    Opener,
    Record,
    lashloop,
    rewrite_samples,
    run,
    wait_until,
)
from mcap.writer import CompressionType, Writer
from playwright.sync_api import expect

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Locator, Page


def picture(page: Page, name: str) -> None:
    """Keeps a picture for people, in `target/browser`."""
    OUTPUT.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=OUTPUT / f"{name}.png", full_page=True)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 360])
def test_every_chart_has_curves_and_nothing_overflows(
    open_page: Opener, failed: Record, width: int, scheme: str
) -> None:
    page = open_page(failed.page, width, scheme)
    picture(page, f"failed-{width}-{scheme}")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    charts = page.locator(".chart:visible")
    titles = charts.locator("h3").all_text_contents()
    wanted = [
        "Load position",
        "Position error",
        "Torque",
        "Twist and gap",
        "Phase plane",
        "Hysteresis of gap and shaft",
    ]
    assert set(wanted) <= set(titles)
    assert "Estimate: dead zone" in titles
    empty = page.evaluate(
        "[...document.querySelectorAll('.chart')].filter((it) => it.checkVisibility())"
        ".filter((it) => ![...it.querySelectorAll('.curves path')].every((path) => path.getAttribute('d').length > 20))"
        ".map((it) => it.querySelector('h3').textContent)"
    )
    assert empty == []


def test_numbers_are_those_of_the_summary(open_page: Opener, failed: Record) -> None:
    page, summary = open_page(failed.page), failed.summary
    assert page.locator(".badge").inner_text() == summary["verdict"] == "FAIL"
    shown = page.evaluate(
        "[...document.querySelectorAll('[data-metric] data')]"
        ".map((it) => [it.parentElement.dataset.metric, Number(it.value)])"
    )
    assert dict(shown) == {name: value for name, value in summary["metrics"].items() if value is not None}
    rows = page.locator("table.expectations tbody tr")
    assert rows.count() == len(summary["expectations"]) > 0
    for row, expectation in zip(rows.all(), summary["expectations"], strict=True):
        assert row.locator("th").inner_text() == expectation["metric"]
        assert row.locator("td").first.inner_text().endswith("fail") == (not expectation["ok"])
        value, margin = (float(it) for it in row.locator("data").evaluate_all("all => all.map((it) => it.value)"))
        assert value == expectation["value"]
        bounds = [(1, expectation["max"]), (-1, expectation["min"])]
        distances = [sign * (bound - value) for sign, bound in bounds if bound is not None]
        assert margin == pytest.approx(min(distances))
    faults = page.locator(".timeline .name").all_inner_texts()
    assert faults == [fault["kind"] for fault in summary["faults"]] == ["load-torque", "torque-gain"]
    marks = page.locator(".chart", has_text="Load position").first.locator(".mark title")
    assert marks.evaluate_all("all => all.map((it) => it.textContent)") == faults


def test_the_sentence_names_what_is_missed(open_page: Opener, failed: Record) -> None:
    why = open_page(failed.page).locator(".why").inner_text()
    missed = [it for it in failed.summary["expectations"] if not it["ok"]]
    assert missed[0]["metric"] in why
    assert re.search(r"(above|below) the limit of|has no value", why)


def test_a_run_of_25_s_opens_at_once_and_is_small(open_page: Opener, passed: Record) -> None:
    size = passed.page.stat().st_size
    assert size < 3_000_000
    page = open_page(passed.page)
    ready_ms = float(page.evaluate("document.documentElement.dataset.ready"))
    busy_s = min(main_thread_s(page) for _ in range(3))
    report = WORKSPACE / "target" / "reports" / "browser.txt"
    report.parent.mkdir(parents=True, exist_ok=True)
    report.write_text(
        f"report.html of 25 s at 1 kHz: {size / 1e6:.2f} MB, ready after {ready_ms:.0f} ms, "
        f"{busy_s * 1e3:.0f} ms of processor time until it is drawn (best of 3)\n"
    )
    # Processor time, because the machine of a test is shared.
    assert busy_s < 1


def main_thread_s(page: Page) -> float:
    """Processor time of the page's thread for a reload, up to the last chart drawn."""
    client = page.context.new_cdp_session(page)
    client.send("Performance.enable", {"timeDomain": "threadTicks"})

    def total_s() -> float:
        metrics = client.send("Performance.getMetrics")["metrics"]
        return float(next(it["value"] for it in metrics if it["name"] == "TaskDuration"))

    before_s = total_s()
    page.reload()
    page.wait_for_selector("html[data-ready]", timeout=30_000)
    wait_until(page, DRAWN)
    after_s = total_s()
    client.detach()
    return after_s - before_s


def test_the_read_out_at_the_cursor_is_the_recorded_step(open_page: Opener, failed: Record) -> None:
    page, rows = open_page(failed.page), failed.rows()
    chart = page.locator(".chart").first
    box = chart.locator(".plot").bounding_box()
    assert box
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + box["height"] / 2)
    time_s = float(re.sub(r"[^\d.]", "", page.locator(".cursor-time").inner_text()))
    step = round(time_s * 1000)
    # The cursor may stand between two steps.
    near = rows[max(step - 1, 0) : step + 2]
    load = number(chart.locator(".key", has_text="load").locator("output").inner_text())
    assert any(math.isclose(load, row["load_position_rad"], abs_tol=2e-4) for row in near), (time_s, load)
    # All charts have the cursor: its time is the same.
    chart = page.locator(".chart", has=page.get_by_role("heading", name="Torque", exact=True))
    torque = chart.locator(".key", has_text="torque").locator("output").first
    assert any(math.isclose(number(torque.inner_text()), row["torque_nm"], abs_tol=5e-3) for row in near)


def number(text: str) -> float:
    return float(text.replace("\N{MINUS SIGN}", "-"))


def test_a_page_without_a_summary_states_the_interruption(open_page: Opener, failed: Record, tmp_path: Path) -> None:
    folder = tmp_path / "killed"
    shutil.copytree(failed.folder, folder)
    (folder / "summary.json").unlink()
    samples = (folder / "run.mcap").read_bytes()
    (folder / "run.mcap").write_bytes(samples[: len(samples) * 2 // 3])
    lashloop("report", folder)
    page = open_page(folder / "report.html")
    assert page.locator(".badge").inner_text() == "NO VERDICT"
    assert "interrupted" in page.locator(".why").inner_text()
    assert page.locator(".chart").count() > 5


HOSTILE = """</script></style><script>document.title="owned"</script><img src=x onerror=alert(1)>"'&{{7*7}}"""


def test_names_of_others_are_text(open_page: Opener, failed: Record, tmp_path: Path) -> None:
    folder = tmp_path / HOSTILE.replace("/", "\N{FRACTION SLASH}")
    shutil.copytree(failed.folder, folder)
    for file in ("summary.json", "record.json"):
        (folder / file).write_text(json.dumps(replaced(json.loads((folder / file).read_text()))))
    rewrite_samples(folder, lambda text: text.replace("drive.measured_twist_rad [rad]", f"{HOSTILE} [{HOSTILE}]"))
    lashloop("report", folder)
    page = open_page(folder / "report.html")
    assert page.locator("h1").inner_text() == HOSTILE
    assert page.get_by_text(HOSTILE).count() > 0
    assert page.locator("img").count() == 0
    assert page.title() == f"FAIL: {HOSTILE}"
    assert page.locator("script").count() == 2
    comparison = tmp_path / "comparison.html"
    lashloop("report", folder, failed.folder, "--out", comparison)
    page = open_page(comparison)
    assert page.locator("img").count() == 0
    assert page.locator(".key-name", has_text="onerror").count() > 0


def replaced(value: object) -> object:
    """Hostile text instead of every text but those that steer the page."""
    if isinstance(value, dict):
        kept = {"signals", "mode", "clock", "verdict", "metric", "statistic"}
        return {key: it if key in kept else replaced(it) for key, it in value.items()}
    if isinstance(value, list):
        return [replaced(it) for it in value]
    return HOSTILE if isinstance(value, str) else value


def test_a_reader_learns_what_was_set_and_how_to_repeat_it(open_page: Opener, records: Path, failed: Record) -> None:
    setting = "controller.parameters.torque_limit_nm"
    record = run(records / "set", failed.folder.parent / "faults.toml", "--set", f"{setting}=15")
    manifest = json.loads((record.folder / "record.json").read_text())
    page = open_page(record.page)
    assert page.locator("h1").inner_text() == manifest["scenario"]["name"]
    cells = page.locator("table.overrides tbody tr").first.locator("th, td").all_inner_texts()
    assert cells == [setting, "15", "20.0"]
    row = page.locator("table.parameters tr", has_text="torque_limit_nm").locator("td").all_inner_texts()
    assert row[0] == "15"
    assert manifest["scenario"]["sha256"] in page.locator("#origin").inner_text()
    command = page.locator("#origin dt", has_text=re.compile("^command$")).locator("xpath=following-sibling::dd[1]")
    assert shlex.split(command.inner_text()) == manifest["command_line"]
    assert manifest["working_directory"] == str(WORKSPACE)
    program, *arguments = shlex.split(page.locator("#repeat code").inner_text())
    assert program == "lashloop"
    # From any folder, and on the record's own settings.
    assert "EQUAL bit for bit" in lashloop(*arguments, folder=records)


def test_a_record_of_one_step_is_a_page_with_its_point(open_page: Opener, records: Path) -> None:
    short = ["--set", "run.duration_s=0.001", "--set", "expect=[]"]
    record = run(records / "one", SCENARIOS / "smooth-after.toml", *short)
    assert len(record.rows()) == 1
    page = open_page(record.page)
    paths = page.locator(".chart .curves path").evaluate_all("all => all.map((it) => it.getAttribute('d'))")
    assert paths
    assert all("h3" in path and "NaN" not in path for path in paths if path)
    assert any(paths)
    page.locator(".chart .plot").first.focus()
    page.keyboard.press("Home")
    assert page.locator(".cursor-time").inner_text().startswith("cursor 0.000")


def test_a_run_that_ends_before_its_first_torque_has_its_verdict(
    open_page: Opener, failed: Record, tmp_path: Path
) -> None:
    folder = tmp_path / "none"
    shutil.copytree(failed.folder, folder)
    rewrite_samples(folder, has_messages=False)
    lashloop("report", folder)
    page = open_page(folder / "report.html")
    assert page.locator(".badge").inner_text() == "FAIL"
    assert page.locator(".chart, .controls:visible").count() == 0


# Steps of the made-up trace: more than a page has rows for.
MANY = 100_000


def test_points_of_a_thinned_trail_are_points_of_the_run(open_page: Opener, failed: Record, tmp_path: Path) -> None:
    folder = tmp_path / "circle"
    folder.mkdir()
    shutil.copy(failed.folder / "record.json", folder)
    names = ["reference_rad", "load_position_rad", "torque_nm", "load_velocity_rad_s"]
    fields = "".join(f"float64 {name} # {name} []\n" for name in names)
    with (folder / "run.mcap").open("wb") as file:
        writer = Writer(file, compression=CompressionType.LZ4)
        writer.start()
        schema = writer.register_schema("lashloop/Step", "ros1msg", fields.encode())
        channel = writer.register_channel("/step", "ros1", schema, {"period_us": "1000"})
        for step in range(MANY):
            # A seventh of a turn in each step: neighbours are far apart.
            angle = step * math.tau / 7.1
            data = struct.pack("<4d", 0.0, math.cos(angle), 0.0, math.sin(angle))
            writer.add_message(channel, step * 1_000_000, data, step * 1_000_000)
        writer.finish()  # type: ignore[no-untyped-call]
    lashloop("report", folder)
    page = open_page(folder / "report.html")
    drawn = page.locator(".chart", has_text="Phase plane").locator(".curves path").get_attribute("d") or ""
    points = [(float(x), float(y)) for x, y in re.findall(r"[ML](-?[\d.]+) (-?[\d.]+)", drawn)]
    assert len(points) > 1000
    middle, half = zip(
        *[((max(it) + min(it)) / 2, (max(it) - min(it)) / 2) for it in zip(*points, strict=True)], strict=True
    )
    radii = [math.hypot(*[(it[axis] - middle[axis]) / half[axis] for axis in (0, 1)]) for it in points]
    assert all(radius == pytest.approx(1, abs=0.01) for radius in (min(radii), max(radii)))


def test_curves_have_their_notes_and_limits_and_the_gap_its_own_chart(open_page: Opener, tmp_path: Path) -> None:
    expected = (
        "expect=[{ signal = 'torque_nm', statistic = 'peak', unit = 'N m', max = 21.0, from_s = 1.0, to_s = 5.0 }]"
    )
    scenario = SCENARIOS / "shaft-merzouki.toml"
    lashloop("run", scenario, "--device", "inproc", "--set", expected, "--out", tmp_path / "run", "--report")
    page = open_page(tmp_path / "run/report.html")

    def chart(title: str) -> Locator:
        found = page.locator(".chart", has=page.get_by_role("heading", name=title, exact=True))
        found.scroll_into_view_if_needed()
        expect(found.locator(".curves path").first).to_have_attribute("d", re.compile("^M.{20}"))
        return found

    notes = chart("Load position").locator(".note-text").all_text_contents()
    assert [it.split(" ")[0] for it in notes] == ["rise", "within", "within"]
    torque = chart("Torque")
    assert torque.locator(".key", has_text="expected of torque_nm").count() == 1
    left, right = (
        float(it) for it in re.findall(r"[\d.]+", torque.locator(".bound.expected").last.get_attribute("d") or "")[::2]
    )
    frame = torque.locator(".frame")
    start, width = (float(frame.get_attribute(name) or "nan") for name in ("x", "width"))
    assert [(it - start) / width * 25.0 for it in (left, right)] == pytest.approx([1.0, 5.0], abs=0.01)
    ticks = chart("Gap, enlarged").locator(".grid text").all_text_contents()
    assert "0.1" in ticks
    assert "5" not in ticks[-4:]
