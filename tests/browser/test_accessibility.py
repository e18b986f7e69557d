"""Names, contrast and paper."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import pytest
from conftest import OUTPUT, Opener, Record

if TYPE_CHECKING:
    from playwright.sync_api import Browser

# Text whose contrast with its ground is below 4.5 (below 3 for large text), as WCAG 2.2 counts it.
CONTRAST = """() => {
  const canvas = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  const rgba = (colour) => {
    canvas.clearRect(0, 0, 1, 1);
    canvas.fillStyle = colour;
    canvas.fillRect(0, 0, 1, 1);
    return canvas.getImageData(0, 0, 1, 1).data;
  };
  const linear = (value) => (value <= 0.04045 * 255 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4);
  const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const ground = (element) => {
    for (let it = element; it; it = it.parentElement) {
      const colour = rgba(getComputedStyle(it).backgroundColor);
      if (colour[3] === 255) return colour;
    }
    return [255, 255, 255];
  };
  const poor = [];
  let count = 0;
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement;
    const text = walker.currentNode.textContent.trim();
    if (!text || !element.checkVisibility() || element.closest("script, title, defs")) continue;
    const style = getComputedStyle(element);
    const isDrawing = element.namespaceURI.endsWith("svg");
    const [a, b] = [rgba(isDrawing ? style.fill : style.color), ground(element)].map(luminance);
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    const size = parseFloat(style.fontSize);
    const isLarge = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    count += 1;
    if (contrast < (isLarge ? 3 : 4.5)) poor.push(`${contrast.toFixed(2)} ${text.slice(0, 40)}`);
  }
  return { count, poor };
}"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_all_text_has_enough_contrast(open_page: Opener, failed: Record, scheme: str) -> None:
    result = open_page(failed.page, scheme=scheme).evaluate(CONTRAST)
    assert result["count"] > 200
    assert result["poor"] == []


def test_the_button_switches_between_light_and_dark(open_page: Opener, failed: Record) -> None:
    page = open_page(failed.page)
    ground = "getComputedStyle(document.body).backgroundColor"
    light = page.evaluate(ground)
    button = page.locator(".theme")
    button.click()
    assert page.evaluate(ground) != light
    button.click()
    assert page.evaluate(ground) == light


def test_all_that_is_interactive_or_drawn_has_a_name(open_page: Opener, failed: Record) -> None:
    page = open_page(failed.page)
    nameless = page.evaluate(
        """[...document.querySelectorAll("a, button, input, svg.plot, svg[role=img]")].filter((it) => {
            const label = it.getAttribute("aria-label") || it.closest("label")?.textContent || it.textContent;
            const by = document.getElementById(it.getAttribute("aria-labelledby"));
            return !(by ? by.textContent : label).trim();
        }).map((it) => it.outerHTML.slice(0, 80))"""
    )
    assert nameless == []
    assert page.locator("html").get_attribute("lang") == "en"
    ids = page.evaluate("[...document.querySelectorAll('[id]')].map((it) => it.id)")
    assert len(ids) == len(set(ids))
    dangling = page.evaluate(
        "[...document.querySelectorAll('[aria-labelledby], [aria-describedby], nav a')].flatMap((it) =>"
        " [it.getAttribute('aria-labelledby'), it.getAttribute('aria-describedby'), it.hash?.slice(1)])"
        ".filter((id) => id && !document.getElementById(id))"
    )
    assert dangling == []
    levels = page.evaluate("[...document.querySelectorAll('h1, h2, h3')].map((it) => Number(it.tagName[1]))")
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(later - earlier <= 1 for earlier, later in pairwise(levels))
    assert page.locator("th:not([scope])").count() == 0


def test_every_control_is_reached_by_tab(open_page: Opener, failed: Record) -> None:
    page = open_page(failed.page)
    reached = set()
    for _ in range(60):
        page.keyboard.press("Tab")
        reached.add(
            page.evaluate("(({ classList, dataset }) => dataset.do || classList[0] || '')(document.activeElement)")
        )
    assert {"theme", "in", "out", "reset", "plot"} <= reached


def test_paper_has_every_chart_whole_and_no_controls(open_page: Opener, failed: Record) -> None:
    page = open_page(failed.page, scheme="dark")
    page.emulate_media(media="print", color_scheme="dark")
    # A4 less margins of 14 mm.
    page.set_viewport_size({"width": 688, "height": 1000})
    page.wait_for_timeout(100)
    clipped = page.evaluate(
        """[...document.querySelectorAll(".plot, table, .histogram")].filter((it) => {
            const box = it.getBoundingClientRect();
            return it.checkVisibility() && (box.width < 100 || box.left < 0 || box.right > innerWidth + 1);
        }).map((it) => it.outerHTML.slice(0, 80))"""
    )
    assert clipped == []
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    # A pixel of the page is 0.75 pt.
    points = page.evaluate(
        """[...document.querySelectorAll(".plot text")].filter((it) => it.checkVisibility()).map((it) => {
            const plot = it.closest("svg");
            const scale = plot.getBoundingClientRect().width / plot.viewBox.baseVal.width;
            return 0.75 * scale * parseFloat(getComputedStyle(it).fontSize);
        })"""
    )
    assert len(points) > 50
    assert min(points) >= 7
    assert page.locator(".controls:visible, .theme:visible").count() == 0
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    OUTPUT.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=OUTPUT / "print.png", full_page=True)
    assert page.pdf(path=OUTPUT / "report.pdf", format="A4", print_background=False).startswith(b"%PDF")


def test_a_page_without_scripts_has_verdict_and_tables(browser: Browser, failed: Record) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(failed.page.as_uri())
    assert page.locator(".badge").inner_text() == "FAIL"
    assert page.locator("[data-metric]").count() > 10
    assert page.locator(".controls:visible, .theme:visible").count() == 0
    context.close()
