"""The drive's state machine, sections 6 to 10 of `docs/protocol.md`.

The drive does no I/O. Its owner passes received bytes, sends the returned bytes, calls `tick` when `time_left_s` has
elapsed, and applies `torque_nm` to the motor, if any. The owner also provides the clock of device time. In HIL the
encoder sample is the tick of the control loop: no timer is in its path.
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

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

FIRMWARE_VERSION = Version(0, 1, 0)
"""Version of this drive and of the package."""
_LARGEST_LAW = 15
_U16_MAX = 2**16 - 1


class Drive:
    """A drive, initially as after power-up: disarmed, with default parameters."""

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
            raise ValueError(f"a drive needs at least one control law, with a number from 1 to {_LARGEST_LAW}")
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
        """State of the drive."""
        return self._safety.state

    @property
    def torque_nm(self) -> float:
        """Torque for the motor. Zero unless running."""
        return self._safety.torque_nm

    @property
    def time_left_s(self) -> float | None:
        """Device time until `tick` is due; None while no watchdog can trip."""
        deadline_ns = self._safety.watchdog_deadline_ns
        return None if deadline_ns is None else max(deadline_ns - self._clock_ns(), 0) * 1e-9

    def receive(self, data: bytes) -> bytes:
        """Process received bytes and return the bytes to send."""
        for message in self._decoder.feed(data):
            # A damaged frame counts as missing: the decoder counts it, and the host detects the missing answer.
            if not isinstance(message, FrameError):
                self._handle(message)
        return self._take_output()

    def tick(self) -> bytes:
        """Check the watchdog and return the bytes to send."""
        try:
            self._safety.check_watchdog(self._clock_ns())
        except FaultError as fault:
            self._latch(fault.report)
        return self._take_output()

    def note_overruns(self, count: int) -> None:
        """Count bytes lost in the hardware, for the `LineReport` at the stop."""
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
                self._handshake(message)
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
                has_session = self._session is not None
                self._conclude(message, self._safety.clear_fault(has_session=has_session))
            case Reset():
                self._safety = Safety()
                self.parameters.restore_defaults()
                self._session = self._run = None
                self._conclude(message, Outcome.ACCEPTED)

    def _conclude(self, request: HostMessage, outcome: Outcome) -> None:
        self._send(CommandResult(request.KIND, outcome, self.state))

    def _latch(self, fault: FaultReport) -> None:
        """Set the torque to zero first, then send the report."""
        self._disarm_with(fault)
        self._send(fault)

    def _disarm_with(self, fault: FaultReport) -> None:
        self._safety.latch(fault)
        self._run = None

    def _handshake(self, hello: Hello) -> None:
        same_version = hello.protocol_version == PROTOCOL_VERSION
        if same_version and hello.session != self._session:
            self._session = hello.session
            self._run = None
            self._safety.open_session()
        # An identity is always sent, so that a host of another version can report the mismatch.
        self._send(self._nameplate.identity(hello.session, self.state, self.parameters))
        if self._safety.fault is not None:
            self._send(self._safety.fault)
        if not same_version:
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
        """Build the controller now, so that contradictory parameters are rejected before the start."""
        if self.state is not State.IDLE:
            return Outcome.WRONG_STATE
        try:
            law = self._laws.get(int(self.parameters["controller"]))
            if law is None:
                raise InconsistentError("controller")
            # A copy: live parameters are read at each sample, all others hold for the run.
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
            # A sample after the watchdog time is too late, even without a call of `tick` in between.
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
            match run.classify(sample.sequence, self._safety.last_sequence):
                case Next(periods):
                    self._step(run, sample, periods, arrived_ns)
                case Repeated(answer):
                    self._send(answer)
                case _:
                    self._conclude(sample, Outcome.OUT_OF_SEQUENCE)
        # After the torque.
        if tripped is not None:
            self._send(tripped)

    def _step(self, run: Run, sample: EncoderSample, periods: int, arrived_ns: int) -> None:
        safety = self._safety
        safety.note_sample(sample.sequence, arrived_ns)
        flags = TorqueFlags.GAP if periods > 1 else TorqueFlags(0)
        try:
            safety.check_reference(sample.reference_rad)
            safety.check_speeds(*run.speeds(sample, periods))
            output = run.step(sample, periods, safety.torque_nm)
            if safety.allow(single(output.torque_nm)):
                flags |= TorqueFlags.SATURATED
        except FaultError as fault:
            self._disarm_with(fault.report)
            self._answer(sample, flags, arrived_ns)
            self._send(fault.report)
            return
        run.last_answer = self._answer(sample, flags, arrived_ns)
        every = int(self.parameters["telemetry_every"])
        if every > 0 and sample.sequence % every == 0:
            self._send(telemetry(sample.sequence, output))

    def _answer(self, sample: EncoderSample, flags: TorqueFlags, arrived_ns: int) -> TorqueAnswer:
        compute_tenths_us = min(max(self._clock_ns() - arrived_ns, 0) // 100, _U16_MAX)
        status = TorqueStatus(self.state, flags)
        answer = TorqueAnswer(sample.sequence, self.torque_nm, status, compute_tenths_us)
        self._send(answer)
        return answer


def _table(laws: dict[int, ControlLaw]) -> list[ParameterSpec]:
    """Return all parameters; laws may share parameters."""
    controller = u32("controller", "", min(laws), min(laws), max(laws))
    specs = {spec.name: spec for spec in (controller, *COMMON_PARAMETERS)}
    for law in laws.values():
        for spec in law.parameters:
            if specs.setdefault(spec.name, spec) != spec:
                raise ValueError(f"two declarations of the parameter {spec.name} differ")
    return list(specs.values())
