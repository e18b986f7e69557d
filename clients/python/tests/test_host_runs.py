"""What a host makes of samples, torques and faults."""

from __future__ import annotations

import contextlib

import pytest

from lashloop.host import DriveFaultError, RefusedError, SilenceError, StartTooFarError
from lashloop.messages import DriveMessage, EncoderSample, Log, Reset, Start, TorqueAnswer
from lashloop.enums import LogLevel, State, TorqueFlags, single
from wire import Wire, greeted, running, step


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
        assert TorqueFlags.SATURATED in host.last_answer.message.status.flags
        assert host.telemetry is not None
        assert host.telemetry.step == 0
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
    assert TorqueFlags.GAP in host.last_answer.message.status.flags


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
    assert host.last_answer.step == 2
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


def test_a_sample_outside_of_a_run_is_refused_by_name() -> None:
    with pytest.raises(RefusedError, match="refused EncoderSample in state Idle: WrongState"):
        step(greeted(Wire()))


def test_a_drive_that_was_reset_by_somebody_refuses_the_next_sample() -> None:
    wire = Wire()
    host = running(wire)
    wire.bench.say(Reset())
    with pytest.raises(RefusedError, match="refused EncoderSample in state Boot: WrongState"):
        step(host)


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


def test_what_comes_in_between_is_borne_and_kept() -> None:
    wire = Wire()
    wire.alters = lambda it: [Log(LogLevel.WARNING, "hot"), it]
    host = running(wire)
    step(host)
    assert set(host.logs) == {"hot"}
    assert len(host.logs) <= 100
