"""How a host counts control periods, and after how many without an answer it ends a run."""

from __future__ import annotations

import pytest

from lashloop.host import DriveFaultError, GapTooLongError, PlacedFault, RefusedError, SilenceError, TimeLimits
from lashloop.messages import DriveMessage, EncoderSample, FaultReport, HostMessage, TorqueAnswer
from lashloop.enums import FaultCode, TorqueFlags
from wire import Wire, greeted, running, step

IMPATIENT = TimeLimits(answer_s=1e-3)


def any_sample(message: HostMessage) -> bool:
    """Whether it is a sample."""
    return isinstance(message, EncoderSample)


def test_steps_are_counted_on_where_sequences_wrap() -> None:
    wire = Wire()
    host = running(wire)
    for _ in range(65_600):
        step(host)
    assert host.lost == 0
    assert [it.sequence for it in wire.sent if isinstance(it, EncoderSample)][65_535:65_537] == [65_535, 0]
    assert host.last_answer is not None
    assert (host.last_answer.message.sequence, host.last_answer.step) == (63, 65_599)
    assert host.telemetry is not None
    assert (host.telemetry.message.sequence, host.telemetry.step) == (60, 65_596)


def test_telemetry_keeps_its_step_however_long_no_other_comes() -> None:
    host = running(Wire())
    step(host)
    host.set("telemetry_every", 0)
    for _ in range(33_000):
        step(host)
    assert host.telemetry is not None
    assert (host.telemetry.step, host.telemetry.message.sequence) == (0, 0)


def test_a_fault_names_its_sample_and_last_words_name_none() -> None:
    wire = Wire()
    host = running(wire)
    for _ in range(70_000):
        step(host)
    with pytest.raises(DriveFaultError, match="MotorEncoderJump at sample 70000: ") as it:
        host.torque(motor_counts=100_000, load_counts=0, reference_rad=0.0)
    assert (it.value.fault.step, it.value.fault.message.sequence) == (70_000, 70_000 - 65_536)
    assert host.fault == it.value.fault
    for code, name in ((FaultCode.PANIC, "Panic"), (FaultCode.PROCESSOR_FAULT, "ProcessorFault")):
        fault_frame = FaultReport(code, 0, 0.0, 0.0, 0x2A)

        def alters(message: DriveMessage, fault_frame: FaultReport = fault_frame) -> list[DriveMessage]:
            return [fault_frame] if isinstance(message, TorqueAnswer) else []

        wire.alters = alters
        with pytest.raises(DriveFaultError) as raised:
            step(host)
        assert raised.value.fault == PlacedFault(None, fault_frame)
        said = f"the drive latched {name} (its firmware has stopped: only a reset of the hardware brings it back), "
        assert str(raised.value) == said + "detail 0x2a"


def test_a_fault_from_before_the_first_sample_names_none_of_this_run() -> None:
    wire = Wire()
    host = running(wire)
    for _ in range(5):
        step(host)
    assert host.emergency_stop().step == 4
    after = greeted(wire).fault
    assert after is not None
    assert (after.step, str(after)) == (None, "EmergencyStop (sequence 4)")


def test_a_reset_ends_the_run_that_faults_are_placed_in() -> None:
    wire = Wire()
    host = running(wire)
    for _ in range(33_000):
        step(host)
    host.reset()
    assert (host.telemetry, host.last_answer, host.lost) == (None, None, 0)
    fault = host.emergency_stop()
    assert (fault.step, str(fault)) == (None, "EmergencyStop (sequence 0)")


def test_a_sample_after_a_reset_is_none_of_the_run_before() -> None:
    wire = Wire()
    host = running(wire)
    for _ in range(5):
        step(host)
    host.reset()
    with pytest.raises(RefusedError, match="refused EncoderSample in state Idle: WrongState"):
        step(host)
    assert [it.sequence for it in wire.sent if isinstance(it, EncoderSample)] == [0, 1, 2, 3, 4, 0]


def test_too_long_a_silence_ends_the_run_after_2_5_s() -> None:
    wire = Wire()
    host = running(wire)
    step(host)
    wire.loses_request = any_sample
    start_s = wire.now_s
    step(host)
    step(host)
    said = r"silent for 2.5 s after EncoderSample 1 \(last sample sent: 3, last torque: 0, last frame received: Tele"
    with pytest.raises(SilenceError, match=said):
        step(host)
    assert wire.now_s - start_s == pytest.approx(2.5)
    # Sample 3 may have been taken, so its sequence must not be used for other counts.
    sent = wire.count(EncoderSample)
    with pytest.raises(SilenceError, match=said):
        step(host)
    assert wire.count(EncoderSample) == sent


def test_more_than_1000_periods_without_an_answer_end_the_run() -> None:
    wire = Wire()
    host = greeted(wire, IMPATIENT)
    host.set("watchdog_us", 10_000_000)
    # With a slower motor the drive's longest gap is 1000 periods, the longest of all.
    host.set("motor_speed_limit_rad_s", 400.0)
    host.arm()
    host.start()
    step(host)
    wire.loses_request = any_sample
    for _ in range(999):
        step(host)
    wire.loses_request = lambda _: False
    step(host)
    answer = host.last_answer
    assert answer is not None
    assert (answer.step, answer.message.status.flags & TorqueFlags.GAP) == (1000, TorqueFlags.GAP)

    wire.loses_request = any_sample
    start_s, sent = wire.now_s, wire.count(EncoderSample)
    assert {step(host) for _ in range(1000)} == {answer.message.torque_nm}
    wire.loses_request = lambda _: False
    said = "answered sample 1000 last, and no drive takes one that is more than 1000 .* start the drive anew"
    with pytest.raises(GapTooLongError, match=said):
        step(host)
    assert wire.count(EncoderSample) - sent == 1000
    assert wire.now_s - start_s == pytest.approx(1.0)


def test_late_answers_keep_a_run_going_and_the_last_of_them_begins_the_gap() -> None:
    wire = Wire()
    host = running(wire, IMPATIENT)
    wire.delay_s = 1.5e-3
    for _ in range(1200):
        step(host)
    # Only the first sample, sent again after 1 ms, had its answer in time.
    assert host.last_answer is not None
    assert (host.last_answer.step, host.lost) == (0, 1199)

    wire.loses_request = any_sample
    for _ in range(1000):
        step(host)
    sent = wire.count(EncoderSample)
    with pytest.raises(GapTooLongError, match="answered sample 1199 last, and no drive takes one") as it:
        step(host)
    assert (it.value.answered, it.value.longest) == (1199, 1000)
    assert wire.count(EncoderSample) == sent


def test_a_silence_that_is_over_first_is_told_first() -> None:
    wire = Wire()
    host = running(wire, TimeLimits(answer_s=3e-3))
    step(host)
    wire.loses_request = any_sample
    for _ in range(833):
        step(host)
    with pytest.raises(SilenceError, match=r"silent for 2.5 s after EncoderSample 1 \(last sample sent: 834, "):
        step(host)


def test_a_gap_longer_than_this_drive_takes_is_refused_by_name() -> None:
    wire = Wire()
    host = running(wire, IMPATIENT)
    step(host)
    wire.loses_request = any_sample
    for _ in range(402):
        step(host)
    wire.loses_request = lambda _: False
    with pytest.raises(RefusedError, match="refused EncoderSample in state Running: OutOfSequence"):
        step(host)


def test_the_first_sample_is_sent_again_byte_for_byte_and_the_next_call_is_the_next_period() -> None:
    wire = Wire()
    host = running(wire)
    frames: list[bytes] = []
    write = wire.write

    def recorded(data: bytes, timeout_s: float) -> int:
        frames.append(data)
        return write(data, timeout_s)

    wire.write = recorded  # type: ignore[method-assign]
    wire.loses_request = lambda _: len(frames) < 3
    start_s = wire.now_s
    assert step(host) != 0.0
    assert (len(frames), len(set(frames))) == (3, 1)
    assert wire.now_s - start_s == pytest.approx(2.0)
    # The mechanics stood still all the while.
    step(host)
    assert [it.sequence for it in wire.sent if isinstance(it, EncoderSample)] == [0, 0, 0, 1]
    assert host.last_answer is not None
    assert (host.last_answer.step, host.lost) == (1, 0)
    assert TorqueFlags.GAP not in host.last_answer.message.status.flags


def test_a_first_sample_that_is_never_answered_ends_the_run() -> None:
    wire = Wire()
    host = running(wire)
    wire.loses_request = any_sample
    with pytest.raises(SilenceError, match=r"silent for 2.5 s after EncoderSample 0 \(last sample sent: 0, "):
        step(host)
