"""The control periods of a host, and the limits of a run without answers."""

from __future__ import annotations

import pytest

from lashloop.enums import FaultCode, TorqueFlags
from lashloop.host import DriveFaultError, FaultAtStep, GapTooLongError, RejectedError, SilenceError, TimeLimits
from lashloop.messages import DriveMessage, EncoderSample, FaultReport, HostMessage, TorqueAnswer
from simulated_link import SimulatedLink, opened, running, step

IMPATIENT = TimeLimits(answer_s=1e-3)


def any_sample(message: HostMessage) -> bool:
    """Whether the message is a sample."""
    return isinstance(message, EncoderSample)


def test_steps_continue_where_sequences_wrap() -> None:
    link = SimulatedLink()
    host = running(link)
    for _ in range(65_600):
        step(host)
    assert host.lost == 0
    assert [it.sequence for it in link.sent if isinstance(it, EncoderSample)][65_535:65_537] == [65_535, 0]
    assert host.last_answer is not None
    assert (host.last_answer.message.sequence, host.last_answer.step) == (63, 65_599)
    assert host.telemetry is not None
    assert (host.telemetry.message.sequence, host.telemetry.step) == (60, 65_596)


def test_telemetry_keeps_its_step_without_successor() -> None:
    host = running(SimulatedLink())
    step(host)
    host.subscribe([])
    for _ in range(33_000):
        step(host)
    assert host.telemetry is not None
    assert (host.telemetry.step, host.telemetry.message.sequence) == (0, 0)


def test_a_fault_names_its_sample_but_a_stopped_firmware_none() -> None:
    link = SimulatedLink()
    host = running(link)
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

        link.alters = alters
        with pytest.raises(DriveFaultError) as raised:
            step(host)
        assert raised.value.fault == FaultAtStep(None, fault_frame)
        expected = f"the drive latched {name} (the firmware has stopped: reset the hardware), "
        assert str(raised.value) == expected + "detail 0x2a"


def test_a_fault_before_the_first_sample_has_no_step() -> None:
    link = SimulatedLink()
    host = running(link)
    for _ in range(5):
        step(host)
    assert host.emergency_stop().step == 4
    after = opened(link).fault
    assert after is not None
    assert (after.step, str(after)) == (None, "EmergencyStop (sequence 4)")


def test_after_a_reset_faults_have_no_step() -> None:
    link = SimulatedLink()
    host = running(link)
    for _ in range(33_000):
        step(host)
    host.reset()
    assert (host.telemetry, host.last_answer, host.lost) == (None, None, 0)
    fault = host.emergency_stop()
    assert (fault.step, str(fault)) == (None, "EmergencyStop (sequence 0)")


def test_a_sample_after_a_reset_is_rejected() -> None:
    link = SimulatedLink()
    host = running(link)
    for _ in range(5):
        step(host)
    host.reset()
    with pytest.raises(RejectedError, match="rejected EncoderSample in state Idle: WrongState"):
        step(host)
    assert [it.sequence for it in link.sent if isinstance(it, EncoderSample)] == [0, 1, 2, 3, 4, 0]


def test_2_5_s_without_an_answer_end_the_run() -> None:
    link = SimulatedLink()
    host = running(link)
    step(host)
    link.loses_request = any_sample
    start_s = link.now_s
    step(host)
    step(host)
    expected = (
        r"silent for 2.5 s after EncoderSample 1 \(last sample sent: 3, last torque: 0, last frame received: Tele"
    )
    with pytest.raises(SilenceError, match=expected):
        step(host)
    assert link.now_s - start_s == pytest.approx(2.5)
    # Sample 3 may have been taken, so its sequence must not be used for other counts.
    sent = link.count(EncoderSample)
    with pytest.raises(SilenceError, match=expected):
        step(host)
    assert link.count(EncoderSample) == sent


def test_more_than_1000_periods_without_an_answer_end_the_run() -> None:
    link = SimulatedLink()
    host = opened(link, IMPATIENT)
    host.set("watchdog_us", 10_000_000)
    # With a slower motor the drive's longest gap is 1000 periods, the longest of all.
    host.set("motor_speed_limit_rad_s", 400.0)
    host.arm()
    host.start()
    step(host)
    link.loses_request = any_sample
    for _ in range(999):
        step(host)
    link.loses_request = lambda _: False
    step(host)
    answer = host.last_answer
    assert answer is not None
    assert (answer.step, answer.message.status.flags & TorqueFlags.GAP) == (1000, TorqueFlags.GAP)

    link.loses_request = any_sample
    start_s, sent = link.now_s, link.count(EncoderSample)
    assert {step(host) for _ in range(1000)} == {answer.message.torque_nm}
    link.loses_request = lambda _: False
    expected = "answered sample 1000 last, and a drive rejects a sample more than 1000 .* restart the drive"
    with pytest.raises(GapTooLongError, match=expected):
        step(host)
    assert link.count(EncoderSample) - sent == 1000
    assert link.now_s - start_s == pytest.approx(1.0)


def test_late_answers_continue_a_run_and_restart_the_gap() -> None:
    link = SimulatedLink()
    host = running(link, IMPATIENT)
    link.delay_s = 1.5e-3
    for _ in range(1200):
        step(host)
    # Only the first sample, retransmitted after 1 ms, had its answer in time.
    assert host.last_answer is not None
    assert (host.last_answer.step, host.lost) == (0, 1199)

    link.loses_request = any_sample
    for _ in range(1000):
        step(host)
    sent = link.count(EncoderSample)
    with pytest.raises(GapTooLongError, match="answered sample 1199 last, and a drive rejects a sample") as it:
        step(host)
    assert (it.value.answered, it.value.longest) == (1199, 1000)
    assert link.count(EncoderSample) == sent


def test_an_earlier_timeout_takes_precedence_over_the_gap() -> None:
    link = SimulatedLink()
    host = running(link, TimeLimits(answer_s=3e-3))
    step(host)
    link.loses_request = any_sample
    for _ in range(833):
        step(host)
    with pytest.raises(SilenceError, match=r"silent for 2.5 s after EncoderSample 1 \(last sample sent: 834, "):
        step(host)


def test_the_drive_rejects_a_gap_beyond_its_own_limit() -> None:
    link = SimulatedLink()
    host = running(link, IMPATIENT)
    step(host)
    link.loses_request = any_sample
    for _ in range(402):
        step(host)
    link.loses_request = lambda _: False
    with pytest.raises(RejectedError, match="rejected EncoderSample in state Running: OutOfSequence"):
        step(host)


def test_the_first_sample_is_retransmitted_unchanged() -> None:
    link = SimulatedLink()
    host = running(link)
    frames: list[bytes] = []
    write = link.write

    def recorded(data: bytes, timeout_s: float) -> int:
        frames.append(data)
        return write(data, timeout_s)

    link.write = recorded  # type: ignore[method-assign]
    link.loses_request = lambda _: len(frames) < 3
    start_s = link.now_s
    assert step(host) != 0.0
    assert (len(frames), len(set(frames))) == (3, 1)
    assert link.now_s - start_s == pytest.approx(2.0)
    # The mechanics did not move in the meantime.
    step(host)
    assert [it.sequence for it in link.sent if isinstance(it, EncoderSample)] == [0, 0, 0, 1]
    assert host.last_answer is not None
    assert (host.last_answer.step, host.lost) == (1, 0)
    assert TorqueFlags.GAP not in host.last_answer.message.status.flags


def test_a_first_sample_without_any_answer_ends_the_run() -> None:
    link = SimulatedLink()
    host = running(link)
    link.loses_request = any_sample
    with pytest.raises(SilenceError, match=r"silent for 2.5 s after EncoderSample 0 \(last sample sent: 0, "):
        step(host)
