"""What the tests stand on: the specification as tables, a drive with a clock of ours, and programs with deadlines."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import threading
from dataclasses import dataclass, field
from pathlib import Path
from queue import Empty, Queue
from typing import TYPE_CHECKING, TypeVar

from lashloop.control.cascade import PD
from lashloop.decoder import Decoder
from lashloop.drive import Drive
from lashloop.frames import FROM_DRIVE, FrameError, encode
from lashloop.messages import Arm, DriveMessage, EncoderSample, Hello, SetParameter, Start

if TYPE_CHECKING:
    from collections.abc import Sequence

    from lashloop.messages import HostMessage
    from lashloop.enums import ParameterValue

WORKSPACE = Path(__file__).parents[3]
SESSION = 0x4C41_5348
M = TypeVar("M", bound=DriveMessage)
PARAMETER_COUNT = len(Drive([PD]).parameters)

SOON_S = 30.0
"""For what happens soon on a machine that isn't busy, and still does on one that is."""


def document() -> str:
    """The specification."""
    return (WORKSPACE / "docs/protocol.md").read_text()


def table(above: str) -> list[list[str]]:
    """The rows of the first table below a line of the specification, without markup."""
    _, _, below = document().partition(f"\n{above}\n")
    assert below, f"there is no line {above}"
    rows: list[list[str]] = []
    for line in below.splitlines():
        if line.startswith("#"):
            break
        if line.startswith("|"):
            plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", line.strip("|")).replace("`", "")
            rows.append([cell.strip() for cell in plain.split("|")])
        elif rows:
            break
    return rows[2:]


@dataclass
class Clock:
    """Device time that passes only when told, or by `step_ns` each time somebody looks."""

    now_ns: int = 0
    step_ns: int = 0

    def __call__(self) -> int:
        """Look."""
        self.now_ns += self.step_ns
        return self.now_ns

    def pass_us(self, time_us: float) -> None:
        """Let time pass."""
        self.now_ns += round(time_us * 1000)


@dataclass
class Bench:
    """A drive and somebody who talks to it in messages."""

    clock: Clock = field(default_factory=Clock)
    drive: Drive = field(init=False)

    def __post_init__(self) -> None:
        """Power the drive."""
        self.drive = Drive([PD], clock_ns=self.clock)
        self.decoder = Decoder(FROM_DRIVE)

    def heard(self, data: bytes) -> list[DriveMessage]:
        """What the drive says, all of it whole."""
        messages = list(self.decoder.feed(data))
        return [it for it in messages if not isinstance(it, FrameError)]

    def say(self, message: HostMessage) -> list[DriveMessage]:
        """Send a message and give what comes."""
        answers = self.heard(self.drive.receive(encode(message)))
        assert self.decoder.counters.damaged + self.decoder.counters.refused == 0
        return answers

    def only(self, kind: type[M], message: HostMessage) -> M:
        """Send a message that has one answer of this kind."""
        (answer,) = self.say(message)
        assert isinstance(answer, kind), answer
        return answer

    def index(self, name: str) -> int:
        """Index of a parameter."""
        return [spec.name for spec in self.drive.parameters.specs].index(name)

    def set(self, name: str, value: ParameterValue) -> None:
        """Set a parameter that has to be taken."""
        self.say(SetParameter(self.index(name), value))
        assert self.drive.parameters.value(self.drive.parameters.specs[self.index(name)]) == value

    def idle(self) -> Bench:
        """Greet."""
        self.say(Hello(1, SESSION))
        return self

    def armed(self) -> Bench:
        """Greet and arm."""
        self.idle().say(Arm(SESSION))
        return self

    def running(self, **settings: ParameterValue) -> Bench:
        """Greet, set, arm and start."""
        self.idle()
        for name, value in settings.items():
            self.set(name, value)
        self.say(Arm(SESSION))
        self.say(Start(SESSION))
        return self


def sample(sequence: int, motor: int = 0, load: int = 0, reference_rad: float = 1.0) -> EncoderSample:
    """A sample; by default the mechanics rest at zero and the load is wanted at 1 rad, so that any law pushes."""
    return EncoderSample(sequence, motor, load, reference_rad)


class Program:
    """A program that prints the path of its terminal and serves there. Leaving the block kills it."""

    def __init__(self, words: Sequence[str | Path]) -> None:
        """Start it and wait for the path."""
        self._process = subprocess.Popen(
            list(map(str, words)), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        lines: Queue[str] = Queue()
        stdout = self._process.stdout
        assert stdout is not None
        threading.Thread(target=lambda: lines.put(stdout.readline()), daemon=True).start()
        try:
            self.path = lines.get(timeout=SOON_S).strip()
        except Empty:
            self.path = ""
        if not Path(self.path or "/nowhere").exists():
            self.end()
            raise AssertionError(f"{words} said {self.path!r} in place of the path of a terminal")

    def signal(self, number: int) -> None:
        """Send it a signal."""
        self._process.send_signal(number)

    def __enter__(self) -> Program:
        """Give the program itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Kill it."""
        self.end()

    def end(self) -> None:
        """Kill it, if it is still there."""
        self._process.kill()
        self._process.communicate(timeout=SOON_S)

    def ended(self) -> tuple[int, str]:
        """Wait for its own end, and give exit code and standard error."""
        _, stderr = self._process.communicate(timeout=SOON_S)
        return self._process.returncode, stderr


def python_drive() -> Program:
    """`python -m lashloop drive`."""
    return Program([sys.executable, "-m", "lashloop", "drive"])


def rust_twin() -> Program:
    """`lashloop device` of the Rust workspace: never left out."""
    binary = Path(os.environ.get("LASHLOOP_BIN", WORKSPACE / "target/release/lashloop"))
    assert binary.is_file(), (
        f"there is no {binary}: build it with `cargo build --release -p lashloop`, or name one in LASHLOOP_BIN"
    )
    return Program([binary, "device"])
