"""A host in a run: samples, torques and faults."""

from __future__ import annotations

import contextlib

import pytest

from lashloop.enums import LogLevel, State, TorqueFlags, single
from lashloop.host import DriveFaultError, RejectedError, SilenceError, StartTooFarError
from lashloop.messages import DriveMessage, EncoderSample, Log, Reset, Start, TorqueAnswer
from simulated_link import SimulatedLink, opened, running, step


def test_a_host_opens_a_session_sets_runs_and_stops() -> None:
    link = SimulatedLink()
    with opened(link) as host:
        assert (host.identity.board, host.identity.state) == ("python", State.IDLE)
        assert host.set("torque_limit_nm", 2.3) == single(2.3) == host.get("torque_limit_nm")
        assert host.subscribe(["load_error_rad", "requested_torque_nm"], every=2)
        host.arm()
        host.start()
        torques_nm = [step(host) for _ in range(5)]
        assert torques_nm == [single(2.3)] * 5
        assert host.last_answer is not None
        assert TorqueFlags.SATURATED in host.last_answer.message.status.flags
        report = host.stop()
        assert host.telemetry is not None
        # In the order of the drive, by name: K_P2 and the ratio make 13 N m of an error of -1 rad.
        assert host.telemetry.step == 4
        assert list(host.telemetry.values) == ["requested_torque_nm", "load_error_rad"]
        assert host.telemetry["load_error_rad"] == pytest.approx(-1.0, abs=1e-4)
        assert host.telemetry["requested_torque_nm"] == pytest.approx(13.0, abs=0.01)
        assert (report.messages, report.damaged, report.refused) == (6, 0, 0)
        assert (host.lost, host.counters.damaged) == (0, 0)
    assert link.closed
    assert link.dut.drive.state is State.IDLE


def test_leaving_the_block_stops_the_run() -> None:
    link = SimulatedLink()
    host = running(link)
    step(host)
    assert link.dut.drive.torque_nm != 0.0
    with contextlib.suppress(RuntimeError), host:
        raise RuntimeError
    assert (link.dut.drive.torque_nm, link.dut.drive.state) == (0.0, State.IDLE)
    assert link.closed


def test_counts_beyond_24_bits_wrap_around() -> None:
    link = SimulatedLink()
    host = running(link)
    for turns in range(3):
        host.torque(motor_counts=3 * turns, load_counts=2**23 - 1 + turns, reference_rad=0.0)
    samples = [it for it in link.sent if isinstance(it, EncoderSample)]
    assert [it.load_counts for it in samples] == [2**23 - 1, -(2**23), -(2**23) + 1]
    assert [it.sequence for it in samples] == [0, 1, 2]


@pytest.mark.parametrize(
    ("motor", "load", "expected"), [(2**23, 0, "motor_counts = 8388608"), (0, -(2**23) - 1, "load_counts = -8388609")]
)
def test_a_first_sample_beyond_24_bits_is_not_sent(motor: int, load: int, expected: str) -> None:
    link = SimulatedLink()
    host = running(link)
    with pytest.raises(
        StartTooFarError, match=f"{expected}: the first sample of a run allows -8388608 to 8388607; use"
    ):
        host.torque(motor_counts=motor, load_counts=load, reference_rad=0.0)
    assert link.count(EncoderSample) == 0


def test_a_lost_answer_holds_the_torque_and_is_counted() -> None:
    link = SimulatedLink()
    host = running(link)
    before_nm = step(host)
    link.loses_request = lambda it: isinstance(it, EncoderSample) and it.sequence in (1, 2)
    start_s = link.now_s
    held = [host.torque(motor_counts=0, load_counts=0, reference_rad=0.5) for _ in range(2)]
    assert held == [before_nm, before_nm]
    assert host.lost == 2
    assert link.now_s - start_s == pytest.approx(2.0)
    assert host.torque(motor_counts=0, load_counts=0, reference_rad=0.5) != before_nm
    assert host.last_answer is not None
    assert TorqueFlags.GAP in host.last_answer.message.status.flags


def test_a_late_answer_does_not_answer_the_next_sample() -> None:
    link = SimulatedLink()
    host = running(link)
    kept: list[DriveMessage] = []

    def alters(message: DriveMessage) -> list[DriveMessage]:
        if isinstance(message, TorqueAnswer) and message.sequence == 1:
            kept.append(message)
            return []
        late = list(kept)
        kept.clear()
        return [*late, message]

    step(host)
    link.alters = alters
    first_nm = host.torque(motor_counts=0, load_counts=0, reference_rad=1.0)
    second_nm = host.torque(motor_counts=0, load_counts=0, reference_rad=0.25)
    assert host.last_answer is not None
    assert host.last_answer.step == 2
    assert second_nm != first_nm


def test_a_fault_names_value_and_limit() -> None:
    link = SimulatedLink()
    host = running(link)
    step(host)
    with pytest.raises(
        DriveFaultError, match=r"MotorEncoderJump at sample 1: 47\d\d\.\d+ rad/s, the limit is 1000 rad/s"
    ) as it:
        host.torque(motor_counts=100_000, load_counts=0, reference_rad=0.0)
    assert it.value.fault == host.fault


def test_a_tripped_watchdog_ends_the_run_at_the_next_sample() -> None:
    link = SimulatedLink()
    host = opened(link)
    host.arm()
    host.start()
    step(host)
    link.loses_request = lambda it: isinstance(it, EncoderSample)
    with pytest.raises(DriveFaultError, match="latched Watchdog at sample 0"):
        step(host)


def test_a_sample_outside_of_a_run_is_rejected_by_name() -> None:
    with pytest.raises(RejectedError, match="rejected EncoderSample in state Idle: WrongState"):
        step(opened(SimulatedLink()))


def test_a_drive_that_was_reset_rejects_the_next_sample() -> None:
    link = SimulatedLink()
    host = running(link)
    link.dut.send(Reset())
    with pytest.raises(RejectedError, match="rejected EncoderSample in state Boot: WrongState"):
        step(host)


def test_a_start_with_a_lost_answer_is_stopped_on_leaving() -> None:
    link = SimulatedLink()
    host = opened(link)
    host.arm()
    link.alters = lambda _: []
    with pytest.raises(SilenceError, match="Start"):
        host.start()
    assert link.count(Start) == 1
    host.close()
    assert link.dut.drive.state is not State.RUNNING


def test_messages_in_between_are_recorded() -> None:
    link = SimulatedLink()
    link.alters = lambda it: [Log(LogLevel.WARNING, "hot"), it]
    host = running(link)
    step(host)
    assert set(host.logs) == {"hot"}
    assert len(host.logs) <= 100
