"""Test fixtures: tables of the specification, a drive with a virtual clock, programs with deadlines."""

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

from cobs import cobs

from lashloop.control.cascade import PD
from lashloop.decoder import Decoder
from lashloop.drive import Drive
from lashloop.frames import FROM_DRIVE, Numbered, crc32c, encode
from lashloop.host import TimeLimits
from lashloop.layout import has_number
from lashloop.messages import Arm, CommandResult, DriveMessage, EncoderSample, Hello, SetParameter, Start, Subscribe

if TYPE_CHECKING:
    from collections.abc import Sequence

    from lashloop.control import ControlLaw
    from lashloop.enums import Outcome, ParameterValue
    from lashloop.messages import HostMessage

WORKSPACE = Path(__file__).parents[3]
SESSION = 0x4C41_5348
M = TypeVar("M", bound=DriveMessage)
PARAMETER_COUNT = len(Drive([PD]).parameters)
SIGNAL_COUNT = len(Drive([PD]).signals)

SOON_S = 90.0
"""Deadline for events that are immediate on an idle machine; sufficient on a busy one."""


PAGES = ("", "/bytes", "/lashloop-drive", "/profile-pd", "/bench-mode", "/options")
"""Pages of the specification: the one of the protocol, then its annexes."""


def document() -> str:
    """The specification, with those of its annexes that exist."""
    paths = (WORKSPACE / f"docs/protocol{page}.md" for page in PAGES)
    return "\n".join(path.read_text() for path in paths if path.exists())


def table(above: str) -> list[list[str]]:
    """The rows of the first table below a heading, or below a line with the tag of a rule, without markup."""
    title = above.lstrip("# ")
    start = rf"^.*{re.escape(title)}.*\n" if title.startswith("[") else rf"^#+ {re.escape(title)}\n"
    found = re.search(start, document(), flags=re.MULTILINE)
    assert found, f"there is no line {above}"
    rows: list[list[str]] = []
    for line in document()[found.end() :].splitlines():
        if line.startswith("#"):
            break
        if line.startswith("|"):
            plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", line.strip("|")).replace("`", "")
            rows.append([cell.strip() for cell in plain.split("|")])
        elif rows:
            break
    return rows[2:]


def sealed(body: bytes) -> bytes:
    """A frame around any body."""
    stuffed: bytes = cobs.encode(body + crc32c(body).to_bytes(4, "little"))
    return stuffed + b"\0"


@dataclass
class Clock:
    """Device time that advances on request, and by `step_ns` at each reading."""

    now_ns: int = 0
    step_ns: int = 0

    def __call__(self) -> int:
        """Read the clock."""
        self.now_ns += self.step_ns
        return self.now_ns

    def pass_us(self, time_us: float) -> None:
        """Advance the time."""
        self.now_ns += round(time_us * 1000)


@dataclass
class DriveUnderTest:
    """The device under test: a drive that is addressed by messages."""

    clock: Clock = field(default_factory=Clock)
    laws: Sequence[ControlLaw] = (PD,)
    drive: Drive = field(init=False)

    def __post_init__(self) -> None:
        """Power up the drive."""
        self.drive = Drive(self.laws, clock_ns=self.clock)
        self.decoder = Decoder(FROM_DRIVE)
        self.number = 0

    def numbered(self, data: bytes) -> list[Numbered[DriveMessage]]:
        """Messages in the bytes of the drive, with their numbers."""
        items = list(self.decoder.feed(data))
        return [it for it in items if isinstance(it, Numbered)]

    def decode(self, data: bytes) -> list[DriveMessage]:
        """Messages in the bytes of the drive."""
        return [it.message for it in self.numbered(data)]

    def send(self, message: HostMessage) -> list[DriveMessage]:
        """Send a message with the next number and return all answers, which have that number."""
        self.number = (self.number + 1) % 256
        answers = self.numbered(self.drive.receive(encode(message, self.number)))
        counters = self.decoder.counters
        assert counters.damaged + counters.refused + counters.unknown == 0
        number = self.number if has_number(message.KIND) else 0
        assert [it.number for it in answers] == [number if has_number(it.message.KIND) else 0 for it in answers]
        return [it.message for it in answers]

    def only(self, kind: type[M], message: HostMessage) -> M:
        """Send a message and return its only answer, of this kind."""
        (answer,) = self.send(message)
        assert isinstance(answer, kind), answer
        return answer

    def index(self, name: str) -> int:
        """Index of a parameter."""
        return [spec.name for spec in self.drive.parameters.specs].index(name)

    def set(self, name: str, value: ParameterValue) -> None:
        """Set a parameter, which the drive must accept."""
        self.send(SetParameter(self.index(name), value))
        assert self.drive.parameters.value(self.drive.parameters.specs[self.index(name)]) == value

    def subscribe(self, *signals: int, every: int = 1) -> Outcome:
        """Subscribe to signals by index and return the outcome."""
        return self.only(CommandResult, Subscribe(sum(1 << it for it in signals), every)).outcome

    def idle(self) -> DriveUnderTest:
        """Open the session."""
        self.send(Hello.of(SESSION))
        return self

    def armed(self) -> DriveUnderTest:
        """Open the session and arm."""
        self.idle().send(Arm(SESSION))
        return self

    def running(self, **settings: ParameterValue) -> DriveUnderTest:
        """Open the session, set, arm and start."""
        self.idle()
        for name, value in settings.items():
            self.set(name, value)
        self.send(Arm(SESSION))
        self.send(Start(SESSION))
        return self


def sample(sequence: int, motor: int = 0, load: int = 0, reference_rad: float = 1.0) -> EncoderSample:
    """A sample; by default of mechanics at rest at zero with a reference of 1 rad, so that any law gives torque."""
    return EncoderSample(sequence, motor, load, reference_rad)


class Program:
    """A program that prints the path of its pseudo-terminal and serves it. Leaving the block kills the program."""

    def __init__(self, words: Sequence[str | Path]) -> None:
        """Start the program and wait for the path."""
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
            raise AssertionError(f"{words} printed {self.path!r} instead of the path of a pseudo-terminal")

    def signal(self, number: int) -> None:
        """Send a signal to the program."""
        self._process.send_signal(number)

    def __enter__(self) -> Program:
        """Return the program itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Kill the program."""
        self.end()

    def end(self) -> None:
        """Kill the program, if it still runs."""
        self._process.kill()
        self._process.communicate(timeout=SOON_S)

    def ended(self) -> tuple[int, str]:
        """Wait for the program to exit and return exit code and standard error."""
        _, stderr = self._process.communicate(timeout=SOON_S)
        return self._process.returncode, stderr


PATIENT = TimeLimits(handshake_s=30.0, request_s=30.0, answer_s=30.0, silence_s=60.0)
"""For a drive in a process of its own: other tests may keep the processor from it for seconds."""


def python_drive() -> Program:
    """`python -m lashloop drive`."""
    return Program([sys.executable, "-m", "lashloop", "drive"])


def program() -> Path:
    """The `lashloop` program of the Rust workspace; never omitted."""
    binary = Path(os.environ.get("LASHLOOP_BIN", WORKSPACE / "target/debug/lashloop")).resolve()
    assert binary.is_file(), (
        f"{binary} is missing: build it with `cargo build -p lashloop-cli`, or name one in LASHLOOP_BIN"
    )
    return binary


def rust_twin() -> Program:
    """`lashloop device`."""
    return Program([program(), "device"])
