"""The drive's state machine, sections 6 to 12 of `docs/protocol.md`.

The drive does no I/O. Its owner passes received bytes, sends the returned bytes, calls `tick` when `time_left_s` has
elapsed, and applies `torque_nm` to the motor, if any. The owner also provides the clock of device time. In HIL the
encoder sample is the tick of the control loop: no timer is in its path.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from lashloop.control import ControlLaw, InconsistentError
from lashloop.decoder import Counters, Decoder
from lashloop.drive.answers import ACCEPTED, Nameplate, Result, line_report, panic, telemetry, timed
from lashloop.drive.description import REQUESTED_TORQUE, Description
from lashloop.drive.parameters import Parameters
from lashloop.drive.run import Next, Repeated, Run, UndeclaredError
from lashloop.drive.safety import FaultError, Safety
from lashloop.drive.subscription import Subscription
from lashloop.enums import Outcome, ParameterValue, State, TorqueFlags, TorqueStatus, Version, single
from lashloop.frames import DELIMITER, FROM_HOST, Numbered, UnknownKindError, encode
from lashloop.layout import has_number
from lashloop.limits import PROTOCOL_VERSION
from lashloop.messages import (
    Arm,
    Capture,
    ClearFault,
    CommandResult,
    DescribeChoice,
    DescribeLaw,
    DescribeParameter,
    DescribeSignal,
    DriveMessage,
    EmergencyStop,
    EncoderSample,
    EnterLoader,
    FaultReport,
    ForgetParameters,
    GetParameter,
    Hello,
    HostMessage,
    ParameterReport,
    ReadCapture,
    RecallParameters,
    Reference,
    Reset,
    SetParameter,
    SetZero,
    Start,
    Stop,
    StoreParameters,
    Subscribe,
    TorqueAnswer,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from lashloop.declarations import ParameterSpec

FIRMWARE_VERSION = Version(0, 1, 0)
"""Version of this drive and of the package."""
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
        is_dirty: bool = True,
        clock_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        """Offer these control laws; the first one is in force after power-up.

        `board` is a name of at most 16 bytes. `build_id` has the first 32 bits of a commit, 0 if unknown; `is_dirty`
        unless the drive was built from exactly that commit. `clock_ns` is device time. `ValueError` if two laws declare
        one name differently, or a name does not fit its field.
        """
        self._description = Description(tuple(laws))
        law_count, signal_count = len(self._description.laws), len(self._description.signals)
        self._nameplate = Nameplate(board, firmware, build_id, is_dirty, law_count, signal_count)
        self._clock_ns = clock_ns
        self.parameters = Parameters(self._description.parameters)
        """The values in force."""
        self._safety = Safety()
        self._session: int | None = None
        self._run: Run | None = None
        self._subscription = Subscription()
        self._decoder = Decoder(FROM_HOST)
        self._counters_at_start = Counters()
        self._overruns = 0
        self._output = bytearray()
        self._number = self._now_ns = 0
        """Number and arrival of the request in progress: device time is read once for each, also for its answers."""

    @property
    def signals(self) -> list[str]:
        """Names of the signals, in the order of their indices."""
        return [spec.name for spec in self._description.signals]

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
        # A damaged frame counts as missing: the decoder counts it, and the host detects the missing answer.
        for item in self._decoder.feed(data):
            if isinstance(item, Numbered):
                self._number, self._now_ns = item.number, self._clock_ns()
                self._handle(item.message)
            elif isinstance(item, UnknownKindError) and has_number(item.kind):
                self._number, self._now_ns = item.number, self._clock_ns()
                self._send(CommandResult(item.kind, Outcome.UNKNOWN_REQUEST, self.state))
        return self._take_output()

    def tick(self) -> bytes:
        """Check the watchdog and return the bytes to send."""
        self._now_ns = self._clock_ns()
        try:
            self._safety.check_watchdog(self._now_ns)
        except FaultError as fault:
            self._latch(fault.report)
        return self._take_output()

    def halt(self, line_number: int) -> bytes:
        """Return the last bytes of a drive whose program has failed in this line: a delimiter, and the report."""
        return DELIMITER + encode(timed(panic(line_number), self._clock_ns()))

    def note_overruns(self, count: int) -> None:
        """Count bytes lost in the hardware, for the `LineReport` at the stop."""
        self._overruns += count

    def _take_output(self) -> bytes:
        output = bytes(self._output)
        self._output.clear()
        return output

    def _send(self, message: DriveMessage) -> None:
        self._output += encode(timed(message, self._now_ns), self._number)

    def _handle(self, message: HostMessage) -> None:
        match message:
            case EncoderSample():
                self._answer_sample(message)
            case Hello():
                self._handshake(message)
            case DescribeParameter(index):
                answer = self._description.parameter(index)
                if answer is None:
                    self._report(index, Result(Outcome.UNKNOWN_INDEX))
                else:
                    self._send(answer)
            case DescribeLaw(index):
                self._describe(message, self._description.law(index))
            case DescribeSignal(index):
                self._describe(message, self._description.signal(index))
            case DescribeChoice(parameter, choice):
                self._describe(message, self._description.choice(parameter, choice))
            case GetParameter(index):
                known = self._spec(index) is not None
                self._report(index, ACCEPTED if known else Result(Outcome.UNKNOWN_INDEX))
            case SetParameter(index, value):
                self._report(index, self._set(index, value))
            case Subscribe():
                self._conclude(message, self._subscribe(Subscription.of(message)))
            case Arm(session):
                self._conclude(message, self._in_session(session, self._arm))
            case Start(session):
                self._conclude(message, self._in_session(session, self._start))
            case Stop():
                result = Result(self._safety.stop())
                self._run = None
                self._report_line()
                self._conclude(message, result)
            case EmergencyStop():
                self._latch(self._safety.emergency_stop())
                self._conclude(message, ACCEPTED)
            case ClearFault():
                has_session = self._session is not None
                self._conclude(message, Result(self._safety.clear_fault(has_session=has_session)))
            case Reference() | EnterLoader():
                # This drive has neither pins, so there is no bench mode, nor a boot loader.
                self._conclude(message, Result(Outcome.WRONG_STATE))
            case StoreParameters() | RecallParameters() | ForgetParameters() | SetZero() | Capture() | ReadCapture():
                # It stores and captures nothing, and has no encoders.
                self._conclude(message, Result(Outcome.UNKNOWN_REQUEST))
            case Reset():
                self._safety = Safety()
                self.parameters.restore_defaults()
                self._subscription = Subscription()
                self._session = self._run = None
                self._conclude(message, ACCEPTED)

    def _conclude(self, request: HostMessage, result: Result) -> None:
        self._send(CommandResult(request.KIND, result.outcome, self.state, result.detail))

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
            self._conclude(hello, Result(Outcome.VERSION_MISMATCH))

    def _spec(self, index: int) -> ParameterSpec | None:
        specs = self.parameters.specs
        return specs[index] if index < len(specs) else None

    def _describe(self, request: HostMessage, answer: DriveMessage | None) -> None:
        if answer is None:
            self._conclude(request, Result(Outcome.UNKNOWN_INDEX))
        else:
            self._send(answer)

    def _set(self, index: int, value: ParameterValue) -> Result:
        spec = self._spec(index)
        if spec is None:
            return Result(Outcome.UNKNOWN_INDEX)
        live = spec.live and self.state in (State.ARMED, State.RUNNING)
        if not (live or self.state is State.IDLE):
            return Result(Outcome.WRONG_STATE)
        before = self.parameters.value(spec)
        outcome = self.parameters.set(spec, value)
        if outcome is Outcome.ACCEPTED and self._run is not None:
            try:
                self._run.update(self.parameters)
            except InconsistentError as error:
                self.parameters.set(spec, before)
                return self._inconsistent(error)
        return Result(outcome)

    def _report(self, index: int, result: Result) -> None:
        spec = self._spec(index)
        value = self.parameters.value(spec) if spec else ParameterValue.u32(0)
        self._send(ParameterReport(index, result.outcome, value, self.state, result.detail))

    def _inconsistent(self, error: InconsistentError) -> Result:
        """Return the refusal with the index of the parameter that the law in force has named."""
        names = list(self.parameters)
        if error.name not in names:
            raise UndeclaredError(self._law.name, error.name) from error
        return Result(Outcome.INCONSISTENT, names.index(error.name))

    def _subscribe(self, subscription: Subscription) -> Result:
        if self.state in (State.BOOT, State.FAULTED):
            return Result(Outcome.WRONG_STATE)
        result = subscription.check(self._description)
        # In `Idle` the law may still change, so `Arm` checks the signals.
        if result == ACCEPTED and self.state is not State.IDLE:
            result = subscription.check_law(self._description, self._law_index)
        if result == ACCEPTED:
            self._subscription = subscription
        return result

    @property
    def _law_index(self) -> int:
        """The law in force, or in `Idle` the one of the next run."""
        return int(self.parameters["controller"])

    @property
    def _law(self) -> ControlLaw:
        return self._description.laws[self._law_index]

    def _in_session(self, session: int, request: Callable[[], Result]) -> Result:
        return request() if session == self._session else Result(Outcome.WRONG_SESSION)

    def _arm(self) -> Result:
        """Build the controller now, so that contradictory parameters are rejected before the start."""
        if self.state is not State.IDLE:
            return Result(Outcome.WRONG_STATE)
        if self._subscription.every > 0:
            result = self._subscription.check_law(self._description, self._law_index)
            if result != ACCEPTED:
                return result
        try:
            self._run = Run(self._law, self.parameters)
        except InconsistentError as error:
            return self._inconsistent(error)
        return Result(self._safety.arm())

    def _start(self) -> Result:
        outcome = self._safety.start(self.parameters, self._now_ns)
        if outcome is Outcome.ACCEPTED:
            self._counters_at_start = self._decoder.counters
            self._overruns = 0
        return Result(outcome)

    def _report_line(self) -> None:
        self._send(line_report(self._decoder.counters, self._counters_at_start, self._overruns))

    def _answer_sample(self, sample: EncoderSample) -> None:
        tripped = None
        try:
            # A sample after the watchdog time is too late, even without a call of `tick` in between.
            self._safety.check_watchdog(self._now_ns)
        except FaultError as fault:
            tripped = fault.report
            self._disarm_with(tripped)
        run = self._run
        if self.state is State.BOOT:
            self._conclude(sample, Result(Outcome.WRONG_STATE))
        elif self.state is not State.RUNNING or run is None:
            self._answer(sample, TorqueFlags(0))
        else:
            match run.classify(sample.sequence, self._safety.last_sequence):
                case Next(periods):
                    self._step(run, sample, periods)
                case Repeated(answer):
                    self._send(answer)
                case _:
                    self._conclude(sample, Result(Outcome.OUT_OF_SEQUENCE))
        # After the torque.
        if tripped is not None:
            self._send(tripped)

    def _step(self, run: Run, sample: EncoderSample, periods: int) -> None:
        safety = self._safety
        safety.note_sample(sample.sequence, self._now_ns)
        flags = TorqueFlags.GAP if periods > 1 else TorqueFlags(0)
        try:
            safety.check_reference(sample.reference_rad)
            safety.check_speeds(*run.speeds(sample, periods))
            output = run.step(sample, periods, safety.torque_nm)
            if safety.allow(single(output.torque_nm)):
                flags |= TorqueFlags.SATURATED
        except FaultError as fault:
            self._disarm_with(fault.report)
            self._answer(sample, flags)
            self._send(fault.report)
            return
        run.last_answer = self._answer(sample, flags)
        if self._subscription.is_due(sample.sequence):
            values = {**output.signals, REQUESTED_TORQUE: output.torque_nm}
            subscribed = (values[self._description.signals[index].name] for index in self._subscription.signals)
            self._send(telemetry(sample.sequence, subscribed))

    def _answer(self, sample: EncoderSample, flags: TorqueFlags) -> TorqueAnswer:
        compute_tenths_us = min(max(self._clock_ns() - self._now_ns, 0) // 100, _U16_MAX)
        status = TorqueStatus(self.state, flags)
        answer = TorqueAnswer(sample.sequence, self.torque_nm, status, compute_tenths_us)
        self._send(answer)
        return answer
