"""The drive's state machine, sections 6 to 10 of `docs/protocol.md`.

It does no I/O: its owner hands it the bytes that arrived, sends the bytes it gives back, calls `tick` when
`time_left_s` has passed, and gives `torque_nm` to the motor if there is one. Device time comes from a clock that is
given to it. In HIL the encoder sample is the tick of the control loop: no timer is in its path.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from lashloop.control import ControlLaw, InconsistentError
from lashloop.decoder import Counters, Decoder
from lashloop.drive.answers import Nameplate, description, line_report, log, telemetry
from lashloop.drive.parameters import COMMON_PARAMETERS, Parameters, ParameterSpec, u32
from lashloop.drive.run import Next, Repeated, Run
from lashloop.drive.safety import FaultError, Safety
from lashloop.frames import FROM_HOST, FrameError, encode
from lashloop.messages import (
    PROTOCOL_VERSION,
    Arm,
    ClearFault,
    CommandResult,
    DescribeParameter,
    DriveMessage,
    EmergencyStop,
    EncoderSample,
    FaultReport,
    GetParameter,
    Hello,
    HostMessage,
    ParameterReport,
    Reset,
    SetParameter,
    Start,
    Stop,
    TorqueAnswer,
)
from lashloop.enums import (
    LogLevel,
    Outcome,
    ParameterValue,
    State,
    TorqueFlags,
    TorqueStatus,
    Version,
    single,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

FIRMWARE_VERSION = Version(0, 1, 0)
"""Version of this drive, that of the package."""
_LARGEST_LAW = 15
_U16_MAX = 2**16 - 1


class Drive:
    """A drive that has just been powered: disarmed, with default parameters."""

    def __init__(
        self,
        laws: Iterable[ControlLaw],
        *,
        board: str = "python",
        firmware: Version = FIRMWARE_VERSION,
        build_id: int = 0,
        clock_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        """Offer these control laws. `clock_ns` is device time; `board` is a name of at most 16 bytes."""
        self._laws = {law.number: law for law in laws}
        if not self._laws or not all(1 <= number <= _LARGEST_LAW for number in self._laws):
            raise ValueError(f"a drive needs at least one control law, of a number from 1 to {_LARGEST_LAW}")
        self._nameplate = Nameplate(board, firmware, build_id, tuple(self._laws))
        self._clock_ns = clock_ns
        self.parameters = Parameters(_table(self._laws))
        """The values in force."""
        self._safety = Safety()
        self._session: int | None = None
        self._run: Run | None = None
        self._decoder = Decoder(FROM_HOST)
        self._counters_at_start = Counters()
        self._overruns = 0
        self._output = bytearray()

    @property
    def state(self) -> State:
        """Where the drive is in its life."""
        return self._safety.state

    @property
    def torque_nm(self) -> float:
        """The torque the motor is to give now. Zero unless running."""
        return self._safety.torque_nm

    @property
    def time_left_s(self) -> float | None:
        """Device time from now after which `tick` is needed; None while nothing can trip."""
        deadline_ns = self._safety.watchdog_deadline_ns
        return None if deadline_ns is None else max(deadline_ns - self._clock_ns(), 0) * 1e-9

    def receive(self, data: bytes) -> bytes:
        """Take bytes from the line and give the bytes to be sent."""
        for message in self._decoder.feed(data):
            # A damaged frame is nothing but a missing one: the decoder counts it, and the host notices the silence.
            if not isinstance(message, FrameError):
                self._handle(message)
        return self._take_output()

    def tick(self) -> bytes:
        """Let time pass, for the watchdog, and give the bytes to be sent."""
        try:
            self._safety.check_watchdog(self._clock_ns())
        except FaultError as fault:
            self._latch(fault.report)
        return self._take_output()

    def note_overruns(self, count: int) -> None:
        """Count bytes that the hardware lost before they got here. The host hears of them at the stop."""
        self._overruns += count

    def _take_output(self) -> bytes:
        output = bytes(self._output)
        self._output.clear()
        return output

    def _send(self, message: DriveMessage) -> None:
        self._output += encode(message)

    def _handle(self, message: HostMessage) -> None:
        match message:
            case EncoderSample():
                self._answer_sample(message)
            case Hello():
                self._greet(message)
            case DescribeParameter(index):
                self._describe(index)
            case GetParameter(index):
                known = self._spec(index) is not None
                self._report(index, Outcome.ACCEPTED if known else Outcome.UNKNOWN_PARAMETER)
            case SetParameter(index, value):
                self._report(index, self._set(index, value))
            case Arm(session):
                self._conclude(message, self._in_session(session, self._arm))
            case Start(session):
                self._conclude(message, self._in_session(session, self._start))
            case Stop():
                outcome = self._safety.stop()
                self._run = None
                self._report_line()
                self._conclude(message, outcome)
            case EmergencyStop():
                self._latch(self._safety.emergency_stop())
                self._conclude(message, Outcome.ACCEPTED)
            case ClearFault():
                greeted = self._session is not None
                self._conclude(message, self._safety.clear_fault(greeted=greeted))
            case Reset():
                self._safety = Safety()
                self.parameters.restore_defaults()
                self._session = self._run = None
                self._conclude(message, Outcome.ACCEPTED)

    def _conclude(self, request: HostMessage, outcome: Outcome) -> None:
        self._send(CommandResult(request.KIND, outcome, self.state))

    def _latch(self, fault: FaultReport) -> None:
        """Torque to zero first, then the report."""
        self._disarm_with(fault)
        self._send(fault)

    def _disarm_with(self, fault: FaultReport) -> None:
        self._safety.latch(fault)
        self._run = None

    def _greet(self, hello: Hello) -> None:
        understood = hello.protocol_version == PROTOCOL_VERSION
        if understood and hello.session != self._session:
            self._session = hello.session
            self._run = None
            self._safety.greet()
        # An identity goes out in any case: a host of another version has to learn whom it met.
        self._send(self._nameplate.identity(hello.session, self.state, self.parameters))
        if self._safety.fault is not None:
            self._send(self._safety.fault)
        if not understood:
            self._conclude(hello, Outcome.VERSION_MISMATCH)

    def _spec(self, index: int) -> ParameterSpec | None:
        specs = self.parameters.specs
        return specs[index] if index < len(specs) else None

    def _describe(self, index: int) -> None:
        spec = self._spec(index)
        if spec is None:
            self._report(index, Outcome.UNKNOWN_PARAMETER)
            return
        self._send(description(index, spec))

    def _set(self, index: int, value: ParameterValue) -> Outcome:
        spec = self._spec(index)
        if spec is None:
            return Outcome.UNKNOWN_PARAMETER
        live = spec.live and self.state in (State.ARMED, State.RUNNING)
        if self.state is State.IDLE or live:
            return self.parameters.set(spec, value)
        return Outcome.WRONG_STATE

    def _report(self, index: int, outcome: Outcome) -> None:
        spec = self._spec(index)
        value = self.parameters.value(spec) if spec else ParameterValue.u32(0)
        self._send(ParameterReport(index, outcome, value, self.state))

    def _in_session(self, session: int, request: Callable[[], Outcome]) -> Outcome:
        return request() if session == self._session else Outcome.WRONG_SESSION

    def _arm(self) -> Outcome:
        """Build the controller now, so that parameters which don't go together are found before the start."""
        if self.state is not State.IDLE:
            return Outcome.WRONG_STATE
        try:
            law = self._laws.get(int(self.parameters["controller"]))
            if law is None:
                raise InconsistentError("controller")
            # A copy: what is live is asked for at each sample, all else holds for the run.
            parameters = dict(self.parameters)
            self._run = Run(law.build(parameters), parameters)
        except InconsistentError as error:
            self._send(log(LogLevel.ERROR, str(error)))
            return Outcome.INCONSISTENT
        return self._safety.arm()

    def _start(self) -> Outcome:
        outcome = self._safety.start(self.parameters, self._clock_ns())
        if outcome is Outcome.ACCEPTED:
            self._counters_at_start = self._decoder.counters
            self._overruns = 0
        return outcome

    def _report_line(self) -> None:
        self._send(line_report(self._decoder.counters, self._counters_at_start, self._overruns))

    def _answer_sample(self, sample: EncoderSample) -> None:
        arrived_ns = self._clock_ns()
        tripped = None
        try:
            # A sample that comes after the watchdog's time is too late, even if nobody called `tick` in between.
            self._safety.check_watchdog(arrived_ns)
        except FaultError as fault:
            tripped = fault.report
            self._disarm_with(tripped)
        run = self._run
        if self.state is State.BOOT:
            self._conclude(sample, Outcome.WRONG_STATE)
        elif self.state is not State.RUNNING or run is None:
            self._answer(sample, TorqueFlags(0), arrived_ns)
        else:
            match run.place(sample.sequence, self._safety.last_sequence):
                case Next(periods):
                    self._step(run, sample, periods, arrived_ns)
                case Repeated(answer):
                    self._send(answer)
                case _:
                    self._conclude(sample, Outcome.OUT_OF_SEQUENCE)
        # The torque comes first.
        if tripped is not None:
            self._send(tripped)

    def _step(self, run: Run, sample: EncoderSample, periods: int, arrived_ns: int) -> None:
        safety = self._safety
        safety.note_sample(sample.sequence, arrived_ns)
        flags = TorqueFlags.GAP if periods > 1 else TorqueFlags(0)
        try:
            safety.check_reference(sample.reference_rad)
            safety.check_speeds(*run.speeds(sample, periods))
            opinion = run.step(sample, periods, safety.torque_nm)
            if safety.allow(single(opinion.torque_nm)):
                flags |= TorqueFlags.SATURATED
        except FaultError as fault:
            self._disarm_with(fault.report)
            self._answer(sample, flags, arrived_ns)
            self._send(fault.report)
            return
        run.last_answer = self._answer(sample, flags, arrived_ns)
        every = int(self.parameters["telemetry_every"])
        if every > 0 and sample.sequence % every == 0:
            self._send(telemetry(sample.sequence, opinion))

    def _answer(self, sample: EncoderSample, flags: TorqueFlags, arrived_ns: int) -> TorqueAnswer:
        compute_tenths_us = min(max(self._clock_ns() - arrived_ns, 0) // 100, _U16_MAX)
        status = TorqueStatus(self.state, flags)
        answer = TorqueAnswer(sample.sequence, self.torque_nm, status, compute_tenths_us)
        self._send(answer)
        return answer


def _table(laws: dict[int, ControlLaw]) -> list[ParameterSpec]:
    """Give all parameters; what several laws need they share."""
    controller = u32("controller", "", min(laws), min(laws), max(laws))
    specs = {spec.name: spec for spec in (controller, *COMMON_PARAMETERS)}
    for law in laws.values():
        for spec in law.parameters:
            if specs.setdefault(spec.name, spec) != spec:
                raise ValueError(f"two declarations of the parameter {spec.name} that are not the same")
    return list(specs.values())
