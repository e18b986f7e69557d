"""A host: opens a session, sets parameters, arms and starts the drive, exchanges samples for torques.

```python
with Host.open("/dev/ttyACM0") as host:
    host.set("controller", "pd")
    host.set("torque_limit_nm", 25.0)
    host.subscribe(["load_error_rad", "requested_torque_nm"], every=1)
    host.arm()
    host.start()
    torque_nm = host.torque(motor_counts=98304, load_counts=32768, reference_rad=0.0)
    print(host.telemetry["load_error_rad"])
    host.stop()
```
"""

from __future__ import annotations

import contextlib
import difflib
import secrets
import time
from typing import TYPE_CHECKING

from lashloop.enums import CaptureTrigger, Outcome, State, ZeroSource
from lashloop.host.captured import Captured
from lashloop.host.describe import DriveDescription, check_counts, describe
from lashloop.host.errors import (
    ParameterRejectedError,
    UnknownParameterError,
    UnknownSignalError,
    VersionError,
)
from lashloop.host.exchange import reported_fault
from lashloop.host.line import DriveLine, TimeLimits
from lashloop.host.lockstep import Lockstep
from lashloop.host.names import cause, named_fault, outcome_name, rejection
from lashloop.limits import MAX_TELEMETRY_VALUES, PROTOCOL_VERSION
from lashloop.link import DEFAULT_BAUD, LinkError, open_port
from lashloop.messages import (
    Arm,
    Capture,
    CaptureRows,
    ClearFault,
    CommandResult,
    DriveMessage,
    EmergencyStop,
    ForgetParameters,
    GetParameter,
    Hello,
    HostMessage,
    Identity,
    LineReport,
    ParameterReport,
    ReadCapture,
    RecallParameters,
    Reset,
    SetParameter,
    SetZero,
    Start,
    Stop,
    StoreParameters,
    Subscribe,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from types import TracebackType

    from typing_extensions import Self

    from lashloop.decoder import Counters
    from lashloop.host.at_step import AtStep, FaultAtStep, TelemetryAtStep
    from lashloop.host.description import Parameter, Signal
    from lashloop.link import Link
    from lashloop.messages import TorqueAnswer

_SESSIONS = 2**32


class Host:
    """An open session with a drive."""

    def __init__(
        self,
        link: Link,
        *,
        session: int | None = None,
        limits: TimeLimits | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Open a session on an open link, by default with a random number."""
        self._line = DriveLine(link, limits or TimeLimits(), clock)
        self._session = secrets.randbelow(_SESSIONS) if session is None else session
        self._description: DriveDescription | None = None
        self._may_be_running = False
        self._run = Lockstep(self._line)
        self._captured: tuple[tuple[str, ...], int] = ((), 1)
        self._line.clear()
        self.identity = self._handshake()

    @classmethod
    def open(cls, path: str, baud: int = DEFAULT_BAUD, *, limits: TimeLimits | None = None) -> Self:
        """Open a serial port or a pseudo-terminal and a session with its drive."""
        link = open_port(path, baud)
        try:
            return cls(link, limits=limits)
        except BaseException:
            link.close()
            raise

    def __enter__(self) -> Self:
        """Return the host itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop a possible run and close the link."""
        self.close()

    def close(self) -> None:
        """Stop a possible run and close the link."""
        if self._may_be_running:
            # If the link has failed, the watchdog of the drive ends the run.
            with contextlib.suppress(LinkError):
                self._line.send(Stop(), self._line.next_number())
        self._line.close()

    @property
    def last_answer(self) -> AtStep[TorqueAnswer] | None:
        """The last torque since the start that arrived in time, with its control period."""
        return self._run.last_answer

    @property
    def lost(self) -> int:
        """Number of samples since the start without an answer in time."""
        return self._run.lost

    @property
    def telemetry(self) -> TelemetryAtStep | None:
        """The last telemetry since the start, with its control period. See `subscribe`."""
        return self._line.telemetry

    @property
    def fault(self) -> FaultAtStep | None:
        """The last fault report, with its control period, until cleared.

        The drive is asked once for the name of a code that this host has no name for.
        """
        return named_fault(self._line)

    @property
    def logs(self) -> list[str]:
        """The last hundred log texts of the drive."""
        return [log.text for log in self._line.logs]

    @property
    def counters(self) -> Counters:
        """Receive statistics of the host."""
        return self._line.counters

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the drive's laws. The index of a name is the value of the parameter `controller`."""
        return self._described.laws

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """The drive's parameters by name."""
        return self._described.parameters

    @property
    def signals(self) -> Mapping[str, Signal]:
        """The drive's signals by name."""
        return self._described.signals

    @property
    def _described(self) -> DriveDescription:
        """What the drive describes, requested once."""
        if self._description is None:
            self._description = describe(self._line, self.identity)
        return self._description

    def parameter(self, name: str) -> Parameter:
        """Return a parameter; `UnknownParameterError` names similar ones."""
        if name not in self.parameters:
            raise UnknownParameterError(name, difflib.get_close_matches(name, self.parameters))
        return self.parameters[name]

    def get(self, name: str) -> float:
        """Return the value in force."""
        parameter = self.parameter(name)
        report = self._line.request(GetParameter(parameter.index), _report_of(parameter.index))
        return report.value.value

    def set(self, name: str, value: float | str) -> float:
        """Set a parameter to a number or to one of its choices and return the value then in force.

        A number is rounded to the parameter's precision. The value of a choice is its index. A live parameter may be
        set in a run; it is in force from the next sample.
        """
        parameter = self.parameter(name)
        wanted = parameter.value(value)
        report = self._line.request(SetParameter(parameter.index, wanted), _report_of(parameter.index))
        if report.outcome is not Outcome.ACCEPTED or report.value != wanted:
            words, outcome = cause(self._line, report.outcome, report.detail), outcome_name(self._line, report.outcome)
            raise ParameterRejectedError(name, wanted, report.outcome, report.value, words, outcome)
        return report.value.value

    def subscribe(self, signals: Iterable[str] | None = None, *, every: int = 10) -> tuple[str, ...]:
        """Subscribe to telemetry of these signals after every n-th sample, and return them in the order of the drive.

        By default the signals of the law in force, the first 13 of them. No signal, or 0, ends telemetry. The
        subscription holds until the next one, or until a reset. `UnknownSignalError` names a signal that the drive does
        not have. `RejectedError` for more than 13 signals, and while armed or running for a signal of another law;
        while idle `arm` checks the law.
        """
        if signals is None:
            # A drive with one law may lack the parameter.
            law = self.laws[int(self.get("controller")) if "controller" in self.parameters else 0]
            names = [it.name for it in self.signals.values() if law in it.laws][:MAX_TELEMETRY_VALUES]
        else:
            names = list(signals)
        wanted, bits = self._selected(names)
        self._command(Subscribe(bits, every))
        # Answers keep their order, so all telemetry from now on is of this subscription.
        self._line.subscription = wanted
        return wanted

    def store_parameters(self) -> None:
        """Make the values in force the defaults, after power-up and `reset` too. `RejectedError` if none are stored."""
        self._command(StoreParameters())
        self._description = None

    def recall_parameters(self) -> None:
        """Set every parameter to its default."""
        self._command(RecallParameters())

    def forget_parameters(self) -> None:
        """Make those of the firmware the defaults, and set every parameter to its default."""
        self._command(ForgetParameters())
        self._description = None

    def set_zero(self, source: ZeroSource = ZeroSource.PRESENT) -> None:
        """Make a position of motor and load the zero of the drive's own encoders."""
        self._command(SetZero(source))

    def capture(
        self,
        signals: Iterable[str],
        *,
        every: int = 1,
        before: int = 0,
        trigger: CaptureTrigger = CaptureTrigger.NOW,
        of: str | None = None,
        level: float = 0.0,
    ) -> tuple[str, ...]:
        """Record up to four signals in every n-th control step, and return them in the order of the drive.

        `before` rows precede the event: `trigger` of the signal `of`, by default the first one, at `level`. No signal
        ends the capture. `UnknownSignalError` names a signal that the drive does not have. `RejectedError` for what the
        drive refuses, such as more rows before the event than it holds.
        """
        wanted, bits = self._selected(list(signals))
        (of_trigger, *_), _ = self._selected([of]) if of else (wanted or ("",), 0)
        index = self.signals[of_trigger].index if of_trigger else 0
        self._command(Capture(bits, every, before, trigger, index, level))
        self._captured = (wanted, every)
        return wanted

    def read_capture(self) -> Captured:
        """Return the capture of this host. `RejectedError` with `NOT_CAPTURED` before it is complete."""
        signals, every = self._captured
        values: list[float] = []
        event = 0
        while True:
            request = ReadCapture(len(values) // max(len(signals), 1))
            answer = self._line.request(request, _rows_from(request.first))
            if isinstance(answer, CaptureRows):
                values += answer.values
                event = answer.event
                continue
            if isinstance(answer, CommandResult) and answer.outcome is not Outcome.UNKNOWN_INDEX:
                raise rejection(self._line, request, answer)
            rows = zip(*[iter(values)] * len(signals), strict=False)
            return Captured(signals, every, event, tuple(rows))

    def _selected(self, names: list[str]) -> tuple[tuple[str, ...], int]:
        """Return these signals in the order of the drive, and their bits."""
        for name in names:
            if name not in self.signals:
                raise UnknownSignalError(name, difflib.get_close_matches(name, self.signals))
        wanted = tuple(it for it in self.signals if it in names)
        return wanted, sum(1 << self.signals[it].index for it in wanted)

    def arm(self) -> None:
        """Arm the drive. Torque stays zero."""
        self._command(Arm(self._session))

    def start(self) -> None:
        """Start a run."""
        self._may_be_running = True
        self._command(Start(self._session))
        self._run = Lockstep(self._line)

    def torque(self, *, motor_counts: int, load_counts: int, reference_rad: float) -> float:
        """Send the encoder sample of the next control period and return the torque to hold until the next, in N m.

        Each call is one control period. The mechanics stand still during a call and advance by one period between two
        calls. Counts may have any size, because 24 bits of them are sent. The first sample defines the position of the
        encoders: `StartTooFarError` if its counts exceed 24 bits.

        A sample without an answer in time counts as lost, and the previous torque is held. The first sample is
        retransmitted instead, because the drive requires sequence 0.

        `SilenceError` after `TimeLimits.silence_s` without an answer in time. `GapTooLongError` if the next sample
        would follow the last one answered, in time or late, by more than 1000 control periods. `RejectedError` if the
        drive rejects the sample. `DriveFaultError` if a fault has ended the run.
        """
        return self._run.torque(motor_counts, load_counts, reference_rad)

    def stop(self) -> LineReport:
        """End the run and return the receive statistics of the drive."""
        reports: list[LineReport] = []

        def result(message: DriveMessage) -> CommandResult | None:
            if isinstance(message, LineReport):
                reports.append(message)
            return _result_of(Stop.KIND)(message)

        self._conclude(Stop(), self._line.request(Stop(), result))
        self._may_be_running = False
        if not reports:
            raise self._line.silence("Stop, for a LineReport before its result,", self._line.limits.request_s)
        return reports[-1]

    def emergency_stop(self) -> FaultAtStep:
        """Send an emergency stop and return the fault that the drive reports."""
        self._line.fault = None
        self._command(EmergencyStop())
        self._may_be_running = False
        return reported_fault(self._line)

    def clear_fault(self) -> None:
        """Clear the latched fault."""
        self._command(ClearFault())
        self._line.fault = None

    def reset(self) -> Identity:
        """Return the drive to its state after power-up and open a new session.

        The data of the run are discarded: `last_answer`, `telemetry` and `fault` are None, `lost` is 0.
        """
        self._command(Reset())
        self._may_be_running = False
        self._run = Lockstep(self._line)
        self._line.fault = None
        self._line.subscription = ()
        self._session = (self._session + 1) % _SESSIONS
        self.identity = self._handshake()
        return self.identity

    def _handshake(self) -> Identity:
        limits, clock = self._line.limits, self._line.clock
        # Repeated with the same number, so that any of them may be answered.
        hello, number = Hello.of(self._session), self._line.next_number()

        def of_this_session(message: DriveMessage) -> Identity | None:
            return message if isinstance(message, Identity) and message.session == hello.session else None

        deadline = clock() + limits.handshake_s
        while (left_s := deadline - clock()) > 0:
            self._line.send(hello, number)
            identity = self._line.wait(of_this_session, min(limits.hello_every_s, left_s), number)
            if identity is not None:
                if identity.protocol_version != PROTOCOL_VERSION:
                    raise VersionError(identity.protocol_version)
                check_counts(identity)
                if identity.state is State.FAULTED:
                    reported_fault(self._line)
                return identity
        raise self._line.silence("Hello", limits.handshake_s)

    def _command(self, request: HostMessage) -> None:
        self._conclude(request, self._line.request(request, _result_of(request.KIND)))

    def _conclude(self, request: HostMessage, result: CommandResult) -> None:
        if result.outcome is not Outcome.ACCEPTED:
            raise rejection(self._line, request, result)


def _result_of(request: int) -> Callable[[DriveMessage], CommandResult | None]:
    return lambda it: it if isinstance(it, CommandResult) and it.request == request else None


def _rows_from(first: int) -> Callable[[DriveMessage], CaptureRows | CommandResult | None]:
    result = _result_of(ReadCapture.KIND)
    return lambda it: it if isinstance(it, CaptureRows) and it.first == first else result(it)


def _report_of(index: int) -> Callable[[DriveMessage], ParameterReport | None]:
    return lambda it: it if isinstance(it, ParameterReport) and it.index == index else None
