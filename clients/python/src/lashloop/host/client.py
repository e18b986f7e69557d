"""A host: greets, learns and sets parameters, arms, starts, gives samples and takes torques.

```python
with Host.open("/dev/ttyACM0") as host:
    host.set("torque_limit_nm", 25.0)
    host.arm()
    host.start()
    torque_nm = host.torque(motor_counts=98304, load_counts=32768, reference_rad=0.0)
    host.stop()
```
"""

from __future__ import annotations

import contextlib
import difflib
import secrets
import time
from typing import TYPE_CHECKING

from lashloop.host.conversation import Conversation, TimeLimits
from lashloop.host.errors import (
    ParameterRefusedError,
    RefusedError,
    UnknownParameterError,
    VersionError,
)
from lashloop.host.exchange import reported_fault
from lashloop.host.lockstep import Lockstep
from lashloop.host.parameters import Parameter
from lashloop.lines import DEFAULT_BAUD, LineError, open_port
from lashloop.messages import (
    PROTOCOL_VERSION,
    Arm,
    ClearFault,
    CommandResult,
    DescribeParameter,
    DriveMessage,
    EmergencyStop,
    GetParameter,
    Hello,
    HostMessage,
    Identity,
    LineReport,
    ParameterDescription,
    ParameterReport,
    Reset,
    SetParameter,
    Start,
    Stop,
)
from lashloop.enums import Outcome, State

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import TracebackType

    from typing_extensions import Self

    from lashloop.decoder import Counters
    from lashloop.host.placed import Placed, PlacedFault
    from lashloop.lines import Line
    from lashloop.messages import Telemetry, TorqueAnswer

_SESSIONS = 2**32


class Host:
    """An open conversation with a drive that has been greeted."""

    def __init__(
        self,
        line: Line,
        *,
        session: int | None = None,
        limits: TimeLimits | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Greet the drive on an open line. Without a number the session gets a random one, as each should."""
        self._talk = Conversation(line, limits or TimeLimits(), clock)
        self._session = secrets.randbelow(_SESSIONS) if session is None else session
        self._parameters: dict[str, Parameter] | None = None
        self._may_give_torque = False
        self._run = Lockstep(self._talk)
        self._talk.clear()
        self.identity = self._greet()

    @classmethod
    def open(cls, path: str, baud: int = DEFAULT_BAUD, *, limits: TimeLimits | None = None) -> Self:
        """Open a serial port or a pseudo-terminal and greet the drive there."""
        line = open_port(path, baud)
        try:
            return cls(line, limits=limits)
        except BaseException:
            line.close()
            raise

    def __enter__(self) -> Self:
        """Give the host itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Take the torque away, if there may be one, and let go of the line."""
        self.close()

    def close(self) -> None:
        """Take the torque away, if there may be one, and let go of the line."""
        if self._may_give_torque:
            # The line may be what is broken; then the drive's watchdog does it.
            with contextlib.suppress(LineError):
                self._talk.send(Stop())
        self._talk.close()

    @property
    def last_answer(self) -> Placed[TorqueAnswer] | None:
        """The last torque since the start that came in time, with its control period."""
        return self._run.last_answer

    @property
    def lost(self) -> int:
        """How many samples since the start have had no answer in time."""
        return self._run.lost

    @property
    def telemetry(self) -> Placed[Telemetry] | None:
        """The last telemetry since the start, with its control period."""
        return self._talk.telemetry

    @property
    def fault(self) -> PlacedFault | None:
        """The last fault that the drive reported, with its control period, until it is cleared."""
        return self._talk.fault

    @property
    def logs(self) -> list[str]:
        """What the drive had to say in words, the last hundred lines."""
        return [log.text for log in self._talk.logs]

    @property
    def counters(self) -> Counters:
        """What this end's receiver has seen."""
        return self._talk.counters

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """What the drive says of its parameters, by name. Asked for once."""
        if self._parameters is None:
            described = map(self._describe, range(self.identity.parameter_count))
            self._parameters = {parameter.name: parameter for parameter in described}
        return self._parameters

    def parameter(self, name: str) -> Parameter:
        """Give one of them; `UnknownParameterError` names those most like it."""
        if name not in self.parameters:
            raise UnknownParameterError(name, difflib.get_close_matches(name, self.parameters))
        return self.parameters[name]

    def get(self, name: str) -> float:
        """Give the value in force."""
        parameter = self.parameter(name)
        report = self._talk.ask(GetParameter(parameter.index), _report_of(parameter.index))
        return report.value.value

    def set(self, name: str, value: float) -> float:
        """Set a parameter, and give what is in force afterwards: the value in the parameter's precision."""
        parameter = self.parameter(name)
        wanted = parameter.value(value)
        report = self._talk.ask(SetParameter(parameter.index, wanted), _report_of(parameter.index))
        if report.outcome is not Outcome.ACCEPTED or report.value != wanted:
            raise ParameterRefusedError(name, wanted, report.outcome, report.value)
        return report.value.value

    def arm(self) -> None:
        """Let the drive build its controller from the parameters. Torque stays zero."""
        self._command(Arm(self._session))

    def start(self) -> None:
        """Begin a run."""
        self._may_give_torque = True
        self._command(Start(self._session))
        self._run = Lockstep(self._talk)

    def torque(self, *, motor_counts: int, load_counts: int, reference_rad: float) -> float:
        """Send the encoder sample of the next control period and give the torque from then on, in N m.

        Each call that returns is a control period: mechanics stand still during a call, however long that takes, and
        go on for a period between two. Counts may be of any size, as 24 bits of them are sent; only those of the first
        sample say where the encoders stand, so `StartTooFarError` if they take more.

        A sample without an answer in time leaves the torque before in force and is counted as lost. The first one is
        sent again as it was, because no other can be the first; the call after its answer is period 1. What goes on for
        too long is an error, whichever comes first: `SilenceError` after `TimeLimits.silence_s` without an answer in
        time, `GapTooLongError` where the next sample would be more than 1000 control periods after the last one
        answered, in time or late. `RefusedError` if the drive does not take the sample, `DriveFaultError` if the run
        has ended by a fault.
        """
        return self._run.torque(motor_counts, load_counts, reference_rad)

    def stop(self) -> LineReport:
        """End the run in good order, and give what the drive's receiver has seen of it."""
        reports: list[LineReport] = []

        def result(message: DriveMessage) -> CommandResult | None:
            if isinstance(message, LineReport):
                reports.append(message)
            return _result_of(Stop.KIND)(message)

        self._conclude(Stop(), self._talk.ask(Stop(), result))
        self._may_give_torque = False
        if not reports:
            raise self._talk.silence("Stop, for a LineReport before its result,", self._talk.limits.request_s)
        return reports[-1]

    def emergency_stop(self) -> PlacedFault:
        """Take the torque away and latch a fault; gives the fault that this is reported as."""
        self._talk.fault = None
        self._command(EmergencyStop())
        self._may_give_torque = False
        return reported_fault(self._talk)

    def clear_fault(self) -> None:
        """Acknowledge the latched fault."""
        self._command(ClearFault())
        self._talk.fault = None

    def reset(self) -> Identity:
        """Put the drive where it is after power-up, and greet it again, in a new session.

        The run is forgotten with it: `last_answer`, `telemetry` and `fault` are None, `lost` is 0.
        """
        self._command(Reset())
        self._may_give_torque = False
        self._run = Lockstep(self._talk)
        self._talk.fault = None
        self._session = (self._session + 1) % _SESSIONS
        self.identity = self._greet()
        return self.identity

    def _greet(self) -> Identity:
        limits, clock = self._talk.limits, self._talk.clock
        hello = Hello(PROTOCOL_VERSION, self._session)

        def of_this_session(message: DriveMessage) -> Identity | None:
            return message if isinstance(message, Identity) and message.session == hello.session else None

        deadline = clock() + limits.greeting_s
        while (left_s := deadline - clock()) > 0:
            self._talk.send(hello)
            identity = self._talk.wait(of_this_session, min(limits.hello_every_s, left_s))
            if identity is not None:
                if identity.protocol_version != PROTOCOL_VERSION:
                    raise VersionError(identity.protocol_version)
                if identity.state is State.FAULTED:
                    reported_fault(self._talk)
                return identity
        raise self._talk.silence("Hello", limits.greeting_s)

    def _describe(self, index: int) -> Parameter:
        def wanted(message: DriveMessage) -> ParameterDescription | None:
            return message if isinstance(message, ParameterDescription) and message.index == index else None

        return Parameter.of(self._talk.ask(DescribeParameter(index), wanted))

    def _command(self, request: HostMessage) -> None:
        self._conclude(request, self._talk.ask(request, _result_of(request.KIND)))

    def _conclude(self, request: HostMessage, result: CommandResult) -> None:
        if result.outcome is not Outcome.ACCEPTED:
            said = self.logs[-1:] if result.outcome is Outcome.INCONSISTENT else []
            raise RefusedError(type(request).__name__, result.outcome, result.state, said)


def _result_of(request: int) -> Callable[[DriveMessage], CommandResult | None]:
    return lambda it: it if isinstance(it, CommandResult) and it.request == request else None


def _report_of(index: int) -> Callable[[DriveMessage], ParameterReport | None]:
    return lambda it: it if isinstance(it, ParameterReport) and it.index == index else None
