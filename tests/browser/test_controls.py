"""Zoom, pan and cursor by mouse, touch and keyboard."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from conftest import Opener, Record, wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

END_S = 7.999


def view(page: Page) -> tuple[float, float]:
    """The shown range of time."""
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    first, last = (float(edge.input_value()) for edge in page.locator("[data-edge]").all())
    return first, last


def ticks(chart: Locator) -> list[str]:
    return chart.locator("g.grid text").all_text_contents()


def place(chart: Locator, fraction: float) -> tuple[float, float]:
    """A place inside a plot, as a fraction of its frame's width."""
    box = chart.locator(".frame").bounding_box()
    assert box
    return box["x"] + fraction * box["width"], box["y"] + box["height"] / 2


def cursor(page: Page) -> str:
    return page.locator(".cursor-time").inner_text()


@pytest.fixture
def page(open_page: Opener, failed: Record) -> Page:
    page = open_page(failed.page)
    assert view(page) == pytest.approx((0, END_S), abs=1e-3)
    return page


def test_a_drag_zooms_every_chart_and_a_double_click_shows_all(page: Page) -> None:
    first, other = page.locator(".chart").nth(0), page.locator(".chart").nth(1)
    before = ticks(other)
    page.mouse.move(*place(first, 0.25))
    page.mouse.down()
    page.mouse.move(*place(first, 0.4), steps=4)
    assert first.locator(".selection.active").count() == 1
    page.mouse.move(*place(first, 0.5), steps=4)
    page.mouse.up()
    assert view(page) == pytest.approx((0.25 * END_S, 0.5 * END_S), abs=0.05)
    assert ticks(other) != before
    assert first.locator(".selection.active").count() == 0
    page.mouse.dblclick(*place(other, 0.5))
    assert view(page) == pytest.approx((0, END_S), abs=1e-3)
    assert ticks(other) == before


def test_shift_and_drag_pans_within_the_run(page: Page) -> None:
    chart = page.locator(".chart").first
    edges = page.locator("[data-edge]")
    for edge, time_s in [(edges.nth(0), "2"), (edges.nth(1), "4")]:
        edge.fill(time_s)
        edge.press("Enter")
    assert view(page) == pytest.approx((2, 4))
    page.keyboard.down("Shift")
    page.mouse.move(*place(chart, 0.75))
    page.mouse.down()
    page.mouse.move(*place(chart, 0.25), steps=4)
    page.mouse.up()
    assert view(page) == pytest.approx((3, 5), abs=0.02)
    page.mouse.move(*place(chart, 0.1))
    page.mouse.down()
    for fraction in (0.5, 0.9):
        page.mouse.move(*place(chart, fraction))
    page.mouse.move(place(chart, 0)[0] + 4000, place(chart, 0)[1])
    page.mouse.up()
    page.keyboard.up("Shift")
    assert view(page) == pytest.approx((0, 2), abs=0.02)


def test_ctrl_and_wheel_zoom_about_the_pointer(page: Page) -> None:
    chart = page.locator(".chart").first
    page.mouse.move(*place(chart, 0.5))
    page.keyboard.down("Control")
    page.mouse.wheel(0, -500)
    page.keyboard.up("Control")
    low, high = view(page)
    assert high - low == pytest.approx(END_S * 0.37, rel=0.05)
    assert (low + high) / 2 == pytest.approx(END_S / 2, abs=0.05)


def test_the_plain_wheel_scrolls_the_page(page: Page) -> None:
    page.mouse.move(*place(page.locator(".chart").first, 0.5))
    page.mouse.wheel(0, 300)
    wait_until(page, "scrollY > 100")
    assert view(page) == pytest.approx((0, END_S), abs=1e-3)


def test_the_keyboard_alone_moves_zooms_and_resets(page: Page) -> None:
    plot = page.locator(".chart .plot").first
    plot.focus()
    page.keyboard.press("Home")
    assert cursor(page) == "cursor 0.000 s"
    page.keyboard.press("ArrowRight")
    one = float(cursor(page).split()[1])
    assert 0 < one < 0.05
    for _ in range(4):
        page.keyboard.press("+")
    low, high = view(page)
    assert high - low == pytest.approx(END_S / 16, rel=0.01)
    page.keyboard.press("Shift+ArrowRight")
    assert view(page)[0] > low
    page.keyboard.press("End")
    assert cursor(page).startswith("cursor 7.999")
    assert view(page)[1] == pytest.approx(END_S, abs=1e-3)
    spoken = page.locator(".chart [aria-live]").first.text_content() or ""
    assert "load" in spoken
    assert "reference" in spoken
    page.keyboard.press("Escape")
    assert view(page) == pytest.approx((0, END_S), abs=1e-3)


def test_magnified_keys_move_step_by_step(page: Page) -> None:
    page.locator(".chart .plot").first.focus()
    page.keyboard.press("Home")
    for _ in range(9):
        page.keyboard.press("+")
    for step in range(1, 4):
        page.keyboard.press("ArrowRight")
        assert float(cursor(page).split()[1]) == pytest.approx(step * 1e-3)


def test_the_cursor_is_in_every_chart_and_leaves_with_the_pointer(page: Page) -> None:
    page.mouse.move(*place(page.locator(".chart").first, 0.5))
    lines = page.locator(".cursor-line:not(.hidden)")
    assert lines.count() == page.locator(".cursor-line").count() > 4
    # A trail has the point of that time.
    trail = page.locator(".chart", has_text="Phase plane")
    assert trail.locator(".dot:not(.hidden)").count() == 1
    page.mouse.move(5, 5)
    assert lines.count() == 0
    assert cursor(page) == ""


def test_a_click_in_the_legend_hides_a_curve_and_fits_the_axis(page: Page) -> None:
    chart = page.locator(".chart", has_text="Estimate: dead zone")
    before = ticks(chart)
    key = chart.get_by_role("button", name="estimate")
    key.click()
    assert key.get_attribute("aria-pressed") == "false"
    hidden = chart.locator(".curves path").evaluate_all("all => all.map((it) => it.getAttribute('d') === '')")
    assert hidden == [True, False]
    assert ticks(chart) != before
    key.click()
    assert ticks(chart) == before


def test_a_worst_step_leads_to_its_time(page: Page) -> None:
    page.get_by_text("Timing of the exchange").click()
    jump = page.locator(".worst .jump").first
    time_s = float(jump.get_attribute("data-time") or "nan")
    jump.click()
    low, high = view(page)
    assert low <= time_s <= high
    assert high - low < 0.2


def test_a_finger_moves_the_cursor_and_two_zoom(open_page: Opener, failed: Record) -> None:
    page = open_page(failed.page, 360, has_touch=True)
    chart = page.locator(".chart").first
    chart.scroll_into_view_if_needed()
    page.touchscreen.tap(*place(chart, 0.5))
    assert float(cursor(page).split()[1]) == pytest.approx(END_S / 2, abs=0.1)
    chart.locator(".plot").evaluate(
        """(plot) => {
            const box = plot.querySelector(".frame").getBoundingClientRect();
            const send = (type, id, fraction) => plot.dispatchEvent(new PointerEvent(type, {
                pointerId: id, pointerType: "touch", bubbles: true,
                clientX: box.left + fraction * box.width, clientY: box.top + 20,
            }));
            send("pointerdown", 1, 0.4);
            send("pointerdown", 2, 0.6);
            send("pointermove", 1, 0.3);
            send("pointermove", 2, 0.7);
            send("pointerup", 1, 0.3);
            send("pointerup", 2, 0.7);
        }"""
    )
    low, high = view(page)
    assert high - low == pytest.approx(END_S / 2, rel=0.02)
    assert (low + high) / 2 == pytest.approx(END_S / 2, abs=0.1)
