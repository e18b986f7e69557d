"""The host against a drive in the same process, over a line that can lose what is sent, with a clock of its own."""

from __future__ import annotations

import contextlib
import math
from collections import Counter
from typing import TYPE_CHECKING

import pytest

from lashloop.frames import FROM_DRIVE, FROM_HOST, decode, encode
from lashloop.host import (
    DriveFaultError,
    Host,
    ParameterRangeError,
    ParameterRefusedError,
    RefusedError,
    SilenceError,
    StartTooFarError,
    UnknownParameterError,
    VersionError,
)
from lashloop.lines import LineError
from lashloop.messages import (
    Arm,
    DriveMessage,
    EncoderSample,
    FaultReport,
    Hello,
    HostMessage,
    Identity,
    Log,
    ParameterReport,
    Reset,
    Start,
    TorqueAnswer,
)
from lashloop.vocabulary import FaultCode, LogLevel, Outcome, ParameterValue, State, TorqueFlags, Version, single
from support import PARAMETER_COUNT, Bench

if TYPE_CHECKING:
    from collections.abc import Callable


class Wire:
    """A line to a drive. Time passes only while the host waits for what does not come."""

    def __init__(self) -> None:
        """Power a drive and connect it."""
        self.bench = Bench()
        self.now_s = 0.0
        self.sent: list[HostMessage] = []
        self.closed = False
        self.loses_request: Callable[[HostMessage], bool] = lambda _: False
        self.alters: Callable[[DriveMessage], list[DriveMessage]] = lambda it: [it]
        self._coming = bytearray(b"\x17 half a frame of an earlier host")

    def clock(self) -> float:
        """The host's time."""
        return self.now_s

    def write(self, data: bytes, timeout_s: float) -> int:
        """Let the drive answer, unless this is lost."""
        del timeout_s
        for frame in data.split(b"\0")[:-1]:
            if frame:
                message = decode(frame, FROM_HOST)
                self.sent.append(message)
                if not self.loses_request(message):
                    self._answer(self.bench.drive.receive(frame + b"\0"))
        return len(data)

    def _answer(self, data: bytes) -> None:
        for frame in data.split(b"\0")[:-1]:
            for message in self.alters(decode(frame, FROM_DRIVE)):
                self._coming += encode(message)

    def read(self, timeout_s: float) -> bytes:
        """Give what has come, or let the time pass for both."""
        if not self._coming:
            left_s = self.bench.drive.time_left_s
            waited_s = timeout_s if left_s is None else min(timeout_s, left_s + 1e-6)
            self.now_s += waited_s
            self.bench.clock.pass_us(waited_s * 1e6)
            self._answer(self.bench.drive.tick())
        data, self._coming = bytes(self._coming[:7]), self._coming[7:]
        return data

    def discard_input(self) -> None:
        """Forget what has come."""
        self._coming.clear()

    def close(self) -> None:
        """Note it."""
        self.closed = True

    def count(self, kind: type[HostMessage]) -> int:
        """How many of a kind were sent."""
        return Counter(map(type, self.sent))[kind]


def greeted(wire: Wire) -> Host:
    """A host of a session of ours."""
    return Host(wire, session=7, clock=wire.clock)


def running(wire: Wire) -> Host:
    """A host in a run, with a watchdog longer than its patience."""
    host = greeted(wire)
    host.set("watchdog_us", 10_000_000)
    host.arm()
    host.start()
    return host


def step(host: Host) -> float:
    """A sample with the mechanics at rest off the reference."""
    return host.torque(motor_counts=0, load_counts=0, reference_rad=1.0)


def test_a_host_greets_sets_runs_and_stops() -> None:
    wire = Wire()
    with greeted(wire) as host:
        assert (host.identity.board, host.identity.state) == ("python", State.IDLE)
        assert host.set("torque_limit_nm", 2.3) == single(2.3) == host.get("torque_limit_nm")
        host.arm()
        host.start()
        torques_nm = [step(host) for _ in range(5)]
        assert torques_nm == [single(2.3)] * 5
        assert host.last_answer is not None
        assert TorqueFlags.SATURATED in host.last_answer.status.flags
        assert host.telemetry is not None
        assert host.telemetry.sequence == 0
        report = host.stop()
        assert (report.messages, report.damaged, report.refused) == (6, 0, 0)
        assert (host.lost, host.counters.damaged) == (0, 0)
    assert wire.closed
    assert wire.bench.drive.state is State.IDLE


def test_leaving_a_run_takes_the_torque_away() -> None:
    wire = Wire()
    host = running(wire)
    step(host)
    assert wire.bench.drive.torque_nm != 0.0
    with contextlib.suppress(RuntimeError), host:
        raise RuntimeError
    assert (wire.bench.drive.torque_nm, wire.bench.drive.state) == (0.0, State.IDLE)
    assert wire.closed


def test_counts_beyond_24_bits_are_wrapped() -> None:
    wire = Wire()
    host = running(wire)
    for turns in range(3):
        host.torque(motor_counts=3 * turns, load_counts=2**23 - 1 + turns, reference_rad=0.0)
    samples = [it for it in wire.sent if isinstance(it, EncoderSample)]
    assert [it.load_counts for it in samples] == [2**23 - 1, -(2**23), -(2**23) + 1]
    assert [it.sequence for it in samples] == [0, 1, 2]


@pytest.mark.parametrize(
    ("motor", "load", "said"), [(2**23, 0, "motor_counts = 8388608"), (0, -(2**23) - 1, "load_counts = -8388609")]
)
def test_a_first_sample_that_does_not_say_where_an_encoder_stands_is_not_sent(motor: int, load: int, said: str) -> None:
    wire = Wire()
    host = running(wire)
    with pytest.raises(StartTooFarError, match=f"{said}: a drive that starts knows of -8388608 to 8388607; take"):
        host.torque(motor_counts=motor, load_counts=load, reference_rad=0.0)
    assert wire.count(EncoderSample) == 0


def test_steps_are_counted_on_where_sequences_wrap() -> None:
    wire = Wire()
    host = running(wire)
    for _ in range(65_600):
        step(host)
    assert host.lost == 0
    assert [it.sequence for it in wire.sent if isinstance(it, EncoderSample)][65_535:65_537] == [65_535, 0]
    assert host.last_answer is not None
    assert (host.last_answer.sequence, host.step_of(host.last_answer.sequence)) == (63, 65_599)
    assert host.telemetry is not None
    assert host.step_of(host.telemetry.sequence) == 65_596
    wire.loses_request = lambda it: isinstance(it, EncoderSample)
    step(host)
    step(host)
    said = r"after EncoderSample 65602 \(last sample sent: 65602, last torque: 65599, "
    with pytest.raises(SilenceError, match=said):
        step(host)


def test_a_fault_is_told_with_its_step() -> None:
    wire = Wire()
    host = running(wire)
    for _ in range(65_540):
        step(host)
    with pytest.raises(DriveFaultError, match="MotorEncoderJump at sample 65540: ") as it:
        host.torque(motor_counts=100_000, load_counts=0, reference_rad=0.0)
    assert (it.value.step, it.value.fault.sequence) == (65_540, 4)


def test_a_silent_drive_is_given_up_after_greetings_every_100_ms() -> None:
    wire = Wire()
    wire.loses_request = lambda _: True
    with pytest.raises(SilenceError, match=r"silent for 2.5 s after Hello \(no good frame received"):
        greeted(wire)
    assert wire.now_s == pytest.approx(2.5)
    assert wire.count(Hello) == 25


def test_a_drive_that_comes_up_late_is_greeted() -> None:
    wire = Wire()
    wire.loses_request = lambda _: wire.count(Hello) < 20
    assert greeted(wire).identity.session == 7
    assert wire.now_s == pytest.approx(1.9)


def test_an_identity_of_another_session_is_no_answer() -> None:
    wire = Wire()

    def alters(message: DriveMessage) -> list[DriveMessage]:
        stale = (
            Identity(1, 6, Version(9, 9, 9), 0, State.IDLE, "old", 1, 1, 1, message.controllers, 0)
            if isinstance(message, Identity)
            else None
        )
        return [stale, message] if stale else [message]

    wire.alters = alters
    assert greeted(wire).identity.board == "python"


def test_another_version_is_named_with_both_sides() -> None:
    wire = Wire()

    def alters(message: DriveMessage) -> list[DriveMessage]:
        if isinstance(message, Identity):
            fields = {name: getattr(message, name) for name in message.__slots__}
            return [Identity(**fields | {"protocol_version": 2})]
        return [message]

    wire.alters = alters
    with pytest.raises(VersionError, match="drive speaks protocol version 2, this host speaks version 1"):
        greeted(wire)


def test_a_fault_that_the_drive_came_with_is_known_after_the_greeting() -> None:
    wire = Wire()
    greeted(wire).emergency_stop()
    host = Host(wire, session=8, clock=wire.clock)
    assert host.identity.state is State.FAULTED
    assert host.fault is not None
    assert host.fault.code is FaultCode.EMERGENCY_STOP
    with pytest.raises(RefusedError, match="refused Arm in state Faulted: WrongState"):
        host.arm()
    host.clear_fault()
    assert host.fault is None
    host.arm()


def test_a_lost_answer_holds_the_torque_and_is_counted() -> None:
    wire = Wire()
    host = running(wire)
    before_nm = step(host)
    wire.loses_request = lambda it: isinstance(it, EncoderSample) and it.sequence in (1, 2)
    start_s = wire.now_s
    held = [host.torque(motor_counts=0, load_counts=0, reference_rad=0.5) for _ in range(2)]
    assert held == [before_nm, before_nm]
    assert host.lost == 2
    assert wire.now_s - start_s == pytest.approx(2.0)
    assert host.torque(motor_counts=0, load_counts=0, reference_rad=0.5) != before_nm
    assert host.last_answer is not None
    assert TorqueFlags.GAP in host.last_answer.status.flags


def test_too_long_a_silence_ends_the_run_after_2_5_s() -> None:
    wire = Wire()
    host = running(wire)
    step(host)
    wire.loses_request = lambda it: isinstance(it, EncoderSample)
    start_s = wire.now_s
    step(host)
    step(host)
    said = r"silent for 2.5 s after EncoderSample 3 \(last sample sent: 3, last torque: 0, last frame received: Tele"
    with pytest.raises(SilenceError, match=said):
        step(host)
    assert wire.now_s - start_s == pytest.approx(2.5)


def test_the_first_sample_is_sent_again_until_it_is_answered() -> None:
    wire = Wire()
    host = running(wire)
    wire.loses_request = lambda it: isinstance(it, EncoderSample) and wire.count(EncoderSample) < 3
    assert step(host) != 0.0
    assert [it.sequence for it in wire.sent if isinstance(it, EncoderSample)] == [0, 0, 0]
    assert host.lost == 0
    wire.loses_request = lambda it: isinstance(it, EncoderSample)
    host.stop()
    host.arm()
    host.start()
    with pytest.raises(SilenceError, match="EncoderSample 0"):
        step(host)


def test_a_late_answer_is_not_taken_for_the_next_one() -> None:
    wire = Wire()
    host = running(wire)
    kept: list[DriveMessage] = []

    def alters(message: DriveMessage) -> list[DriveMessage]:
        if isinstance(message, TorqueAnswer) and message.sequence == 1:
            kept.append(message)
            return []
        late = list(kept)
        kept.clear()
        return [*late, message]

    step(host)
    wire.alters = alters
    first_nm = host.torque(motor_counts=0, load_counts=0, reference_rad=1.0)
    second_nm = host.torque(motor_counts=0, load_counts=0, reference_rad=0.25)
    assert host.last_answer is not None
    assert host.last_answer.sequence == 2
    assert second_nm != first_nm


def test_a_fault_says_which_value_broke_which_limit() -> None:
    wire = Wire()
    host = running(wire)
    step(host)
    with pytest.raises(
        DriveFaultError, match=r"MotorEncoderJump at sample 1: 47\d\d\.\d+ rad/s, the limit is 1000 rad/s"
    ) as it:
        host.torque(motor_counts=100_000, load_counts=0, reference_rad=0.0)
    assert it.value.fault == host.fault


def test_a_watchdog_that_trips_ends_the_run_at_the_next_sample() -> None:
    wire = Wire()
    host = greeted(wire)
    host.arm()
    host.start()
    step(host)
    wire.loses_request = lambda it: isinstance(it, EncoderSample)
    with pytest.raises(DriveFaultError, match="latched Watchdog at sample 0"):
        step(host)


def test_last_words_end_the_run() -> None:
    wire = Wire()
    host = running(wire)
    wire.alters = lambda _: [FaultReport(FaultCode.PANIC, 0, 0.0, 0.0, 0x2A)]
    with pytest.raises(DriveFaultError, match="latched Panic at sample 0, detail 0x2a"):
        step(host)


def test_a_sample_outside_of_a_run_is_refused_by_name() -> None:
    with pytest.raises(RefusedError, match="refused EncoderSample in state Idle: WrongState"):
        step(greeted(Wire()))


def test_a_drive_that_was_reset_by_somebody_refuses_the_next_sample() -> None:
    wire = Wire()
    host = running(wire)
    wire.bench.say(Reset())
    with pytest.raises(RefusedError, match="refused EncoderSample in state Boot: WrongState"):
        step(host)


def test_inconsistent_parameters_come_with_what_the_drive_says() -> None:
    host = greeted(Wire())
    for name, number in (("motor_counts_per_rev", 2**24), ("load_counts_per_rev", 4), ("reduction_ratio", 10)):
        host.set(name, number)
    with pytest.raises(RefusedError, match='Inconsistent, saying "motor counts per load count does'):
        host.arm()


def test_parameters_are_checked_before_anything_is_sent() -> None:
    wire = Wire()
    host = greeted(wire)
    assert len(host.parameters) == PARAMETER_COUNT
    before = len(wire.sent)
    with pytest.raises(UnknownParameterError, match="no parameter torque_limit; did you mean torque_limit_nm"):
        host.set("torque_limit", 5)
    for name, number, allowed in (
        ("torque_limit_nm", 1000.1, "the drive takes 0 to 1000 N m"),
        ("torque_limit_nm", math.nan, "the drive takes 0 to 1000 N m"),
        ("telemetry_every", 2.5, "the drive takes a whole number, 0 to 65535"),
        ("telemetry_every", math.inf, "the drive takes a whole number, 0 to 65535"),
        ("telemetry_every", -1, "the drive takes a whole number, 0 to 65535"),
    ):
        with pytest.raises(ParameterRangeError, match=allowed):
            host.set(name, number)
    assert len(wire.sent) == before


def test_a_value_that_reads_back_differently_is_an_error() -> None:
    wire = Wire()
    host = greeted(wire)
    host.parameter("torque_limit_nm")

    def alters(message: DriveMessage) -> list[DriveMessage]:
        if isinstance(message, ParameterReport):
            return [ParameterReport(message.index, Outcome.ACCEPTED, ParameterValue.f32(9.0), message.state)]
        return [message]

    wire.alters = alters
    with pytest.raises(ParameterRefusedError, match="torque_limit_nm = 5: the drive answered Accepted and has 9 in"):
        host.set("torque_limit_nm", 5)


def test_a_parameter_that_is_not_live_is_refused_while_running() -> None:
    host = running(Wire())
    assert host.set("telemetry_every", 3) == 3
    with pytest.raises(ParameterRefusedError, match="k_p1 = 2: the drive answered WrongState and has 1 in force"):
        host.set("k_p1", 2.0)


def test_a_request_is_sent_once_and_given_up_after_2_s() -> None:
    wire = Wire()
    host = greeted(wire)
    wire.loses_request = lambda it: isinstance(it, Arm)
    with pytest.raises(SilenceError, match="silent for 2 s after Arm"):
        host.arm()
    assert wire.count(Arm) == 1
    assert wire.now_s == pytest.approx(2.0)


def test_a_start_whose_answer_is_lost_is_stopped_on_leaving() -> None:
    wire = Wire()
    host = greeted(wire)
    host.arm()
    wire.alters = lambda _: []
    with pytest.raises(SilenceError, match="Start"):
        host.start()
    assert wire.count(Start) == 1
    host.close()
    assert wire.bench.drive.state is not State.RUNNING


def test_a_reset_brings_back_defaults_in_a_new_session() -> None:
    wire = Wire()
    host = greeted(wire)
    host.set("torque_limit_nm", 5)
    assert host.reset().session == 8
    assert host.get("torque_limit_nm") == 20
    host.arm()


def test_what_comes_in_between_is_borne_and_kept() -> None:
    wire = Wire()
    wire.alters = lambda it: [Log(LogLevel.WARNING, "hot"), it]
    host = running(wire)
    step(host)
    assert set(host.logs) == {"hot"}
    assert len(host.logs) <= 100


def test_a_far_end_that_takes_nothing_is_an_error_in_time() -> None:
    wire = Wire()

    def stuck(data: bytes, timeout_s: float) -> int:
        del data
        wire.now_s += timeout_s
        return 0

    host = greeted(wire)
    wire.write = stuck  # type: ignore[method-assign]
    with pytest.raises(LineError, match=r"the far end took 0 of 11 bytes in 2 s"):
        host.arm()
