"""Pages in headless Chromium. No page may load anything from a network, and none may log an error."""

from __future__ import annotations

import csv
import io
import json
import os
import subprocess
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from playwright.sync_api import sync_playwright

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from playwright.sync_api import Browser, Page

WORKSPACE = Path(__file__).resolve().parents[2]
SCENARIOS = WORKSPACE / "scenarios"
PROGRAM = os.environ.get("LASHLOOP_BIN", str(WORKSPACE / "target" / "debug" / "lashloop"))
OUTPUT = WORKSPACE / "target" / "browser"
CHROMIUM = os.environ.get("CHROMIUM_BIN", "/usr/bin/chromium")
# A chart draws once the browser has laid out its place.
DRAWN = "[...document.querySelectorAll('.plot')].every((it) => it.hasAttribute('viewBox') || !it.checkVisibility())"
ARGUMENTS = [
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


def lashloop(*arguments: str | Path, folder: Path = WORKSPACE) -> str:
    """Runs the program in a folder; a run may end in any verdict."""
    words = [PROGRAM, *map(str, arguments)]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=100, check=False, cwd=folder)
    assert ended.returncode in (0, 1, 3), ended.stderr
    return ended.stdout


@dataclass
class Record:
    """The folder of a run with its page."""

    folder: Path

    @property
    def page(self) -> Path:
        return self.folder / "report.html"

    @property
    def summary(self) -> dict[str, Any]:
        summary: dict[str, Any] = json.loads((self.folder / "summary.json").read_text())
        return summary

    @property
    def manifest(self) -> dict[str, Any]:
        manifest: dict[str, Any] = json.loads((self.folder / "record.json").read_text())
        return manifest

    def rows(self) -> list[dict[str, float]]:
        """The steps of the run; an empty field isn't a number."""
        with (self.folder / "export.csv").open() as file:
            return [{name: float(text or "nan") for name, text in row.items()} for row in csv.DictReader(file)]


def rewrite_samples(folder: Path, schema: Callable[[str], str] = str, *, has_messages: bool = True) -> None:
    """Writes the samples of a record anew, with other schemas or without messages."""
    samples = io.BytesIO((folder / "run.mcap").read_bytes())
    with (folder / "run.mcap").open("wb") as file:
        writer, channels = Writer(file, compression=CompressionType.LZ4), dict[int, int]()
        writer.start()
        for old, channel, message in make_reader(samples).iter_messages():
            if channel.id not in channels:
                assert old
                schema_id = writer.register_schema(old.name, old.encoding, schema(old.data.decode()).encode())
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, schema_id, channel.metadata
                )
            if has_messages:
                place = (message.publish_time, message.sequence)
                writer.add_message(channels[channel.id], message.log_time, message.data, *place)
        writer.finish()  # type: ignore[no-untyped-call]


@dataclass
class Watch:
    """What a page did that it must not do."""

    messages: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


class Opener(Protocol):
    """Opens a file in a window of its own."""

    def __call__(self, path: Path, width: int = 1280, scheme: str = "light", *, has_touch: bool = False) -> Page: ...


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        yield browser
        browser.close()


def wait_until(page: Page, expression: str) -> None:
    """Waits until an expression holds. Playwright's own way polls by `eval`, which the page's policy forbids."""
    for _ in range(200):
        if page.evaluate(expression):
            return
        page.wait_for_timeout(50)
    pytest.fail(f"not within 10 s: {expression}")


@contextmanager
def watched(browser: Browser, width: int, scheme: Any, *, has_touch: bool) -> Iterator[tuple[Page, Watch]]:
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme, has_touch=has_touch)
    page, watch = context.new_page(), Watch()
    page.on("console", lambda message: watch.messages.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: watch.messages.append(f"exception: {error}"))
    page.on("dialog", lambda dialog: watch.messages.append(f"dialog: {dialog.message}"))
    page.on("request", lambda request: watch.requests.append(request.url))
    yield page, watch
    context.close()


@pytest.fixture
def open_page(browser: Browser) -> Iterator[Opener]:
    """Opens reports; at the end of the test, no page may have logged or requested anything."""
    opened = []

    def open_page(path: Path, width: int = 1280, scheme: str = "light", *, has_touch: bool = False) -> Page:
        context = watched(browser, width, scheme, has_touch=has_touch)
        page, watch = context.__enter__()
        opened.append((context, path, watch))
        page.goto(path.as_uri())
        page.wait_for_selector("html[data-ready]", timeout=30_000)
        wait_until(page, DRAWN)
        return page

    yield open_page
    for context, path, watch in opened:
        context.__exit__(None, None, None)
        assert watch.messages == []
        assert set(watch.requests) == {path.as_uri()}


def run(folder: Path, scenario: Path, *arguments: str) -> Record:
    lashloop("run", scenario, "--device", "inproc", "--out", folder, "--report", "--csv", *arguments)
    return Record(folder)


@pytest.fixture(scope="session")
def records(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("records")


@pytest.fixture(scope="session")
def passed(records: Path) -> Record:
    """25 s at 1 kHz on the smooth plant."""
    return run(records / "smooth-after", SCENARIOS / "smooth-after.toml")


@pytest.fixture(scope="session")
def failed(records: Path) -> Record:
    """8 s on the backlash shaft with two injected faults, and expectations that a disturbed drive misses."""
    faults = """
[[fault]]
kind = "load-torque"
torque_nm = 0.3
at_s = 2.0
for_s = 0.5

[[fault]]
kind = "torque-gain"
gain = 0.4
at_s = 4.0
"""
    scenario = records / "faults.toml"
    scenario.write_text((SCENARIOS / "faults.toml").read_text() + faults)
    return run(records / "faults", scenario)
