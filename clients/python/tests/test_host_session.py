"""How a host greets a drive, sets it up and gives it up."""

from __future__ import annotations

import math

import pytest

from lashloop.host import (
    Host,
    ParameterRangeError,
    ParameterRefusedError,
    RefusedError,
    SilenceError,
    UnknownParameterError,
    VersionError,
)
from lashloop.lines import LineError
from lashloop.messages import Arm, DriveMessage, Hello, Identity, ParameterReport
from lashloop.enums import FaultCode, Outcome, ParameterValue, State, Version
from support import PARAMETER_COUNT
from wire import Wire, greeted, running


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
    assert host.fault.message.code is FaultCode.EMERGENCY_STOP
    with pytest.raises(RefusedError, match="refused Arm in state Faulted: WrongState"):
        host.arm()
    host.clear_fault()
    assert host.fault is None
    host.arm()


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


def test_a_reset_brings_back_defaults_in_a_new_session() -> None:
    wire = Wire()
    host = greeted(wire)
    host.set("torque_limit_nm", 5)
    assert host.reset().session == 8
    assert host.get("torque_limit_nm") == 20
    host.arm()


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
