"""The session of a host: handshake, parameters, timeouts."""

from __future__ import annotations

import math

import pytest

from lashloop.enums import Capabilities, FaultCode, Outcome, ParameterValue, State, Version
from lashloop.host import (
    Host,
    ParameterRangeError,
    ParameterRejectedError,
    RejectedError,
    SilenceError,
    UnknownParameterError,
    VersionError,
)
from lashloop.link import LinkError
from lashloop.messages import Arm, DriveMessage, Hello, Identity, ParameterReport
from simulated_link import SimulatedLink, opened, running, step
from support import PARAMETER_COUNT


def test_a_silent_drive_times_out_after_a_hello_every_100_ms() -> None:
    link = SimulatedLink()
    link.loses_request = lambda _: True
    with pytest.raises(SilenceError, match=r"silent for 2.5 s after Hello \(no good frame received"):
        opened(link)
    assert link.now_s == pytest.approx(2.5)
    assert link.count(Hello) == 25
    assert set(link.numbers) == {1}


def test_a_drive_that_starts_late_is_reached() -> None:
    link = SimulatedLink()
    link.loses_request = lambda _: link.count(Hello) < 20
    assert opened(link).identity.session == 7
    assert link.now_s == pytest.approx(1.9)


def test_an_identity_of_another_session_is_no_answer() -> None:
    link = SimulatedLink()

    def alters(message: DriveMessage) -> list[DriveMessage]:
        stale = (
            Identity(1, 0, 6, Version(9, 9, 9), 0, 1, State.IDLE, "old", 1, 1, 1, 1, 0, 0, Capabilities(0))
            if isinstance(message, Identity)
            else None
        )
        return [stale, message] if stale else [message]

    link.alters = alters
    assert opened(link).identity.board == "python"


def test_a_version_mismatch_names_both_versions() -> None:
    link = SimulatedLink()

    def alters(message: DriveMessage) -> list[DriveMessage]:
        if isinstance(message, Identity):
            fields = {name: getattr(message, name) for name in message.__slots__}
            return [Identity(**fields | {"protocol_version": 2})]
        return [message]

    link.alters = alters
    with pytest.raises(VersionError, match="drive has protocol version 2, this host has version 1"):
        opened(link)


def test_a_fault_latched_before_is_known_after_the_handshake() -> None:
    link = SimulatedLink()
    opened(link).emergency_stop()
    host = Host(link, session=8, clock=link.clock)
    assert host.identity.state is State.FAULTED
    assert host.fault is not None
    assert host.fault.message.code is FaultCode.EMERGENCY_STOP
    with pytest.raises(RejectedError, match="rejected Arm in state Faulted: WrongState"):
        host.arm()
    host.clear_fault()
    assert host.fault is None
    host.arm()


def test_inconsistent_parameters_are_reported_by_name() -> None:
    host = opened(SimulatedLink())
    for name, number in (("motor_counts_per_rev", 2**24), ("load_counts_per_rev", 4), ("reduction_ratio", 10)):
        host.set(name, number)
    expected = r"Inconsistent \(reduction_ratio does not go with the other parameters\)$"
    with pytest.raises(RejectedError, match=expected) as raised:
        host.arm()
    assert raised.value.cause == "reduction_ratio does not go with the other parameters"


def test_parameters_are_checked_before_anything_is_sent() -> None:
    link = SimulatedLink()
    host = opened(link)
    assert len(host.parameters) == PARAMETER_COUNT
    before = len(link.sent)
    with pytest.raises(UnknownParameterError, match="no parameter torque_limit; did you mean torque_limit_nm"):
        host.set("torque_limit", 5)
    for name, number, allowed in (
        ("torque_limit_nm", 1000.1, "the drive accepts 0 to 1000 N m"),
        ("torque_limit_nm", math.nan, "the drive accepts 0 to 1000 N m"),
        ("period_us", 200.5, "the drive accepts a whole number, 100 to 100000 us"),
        ("period_us", math.inf, "the drive accepts a whole number, 100 to 100000 us"),
        ("period_us", -1, "the drive accepts a whole number, 100 to 100000 us"),
        ("controller", 1, "controller = 1: the drive accepts pd"),
        ("controller", "merzouki", "controller = 'merzouki': the drive accepts pd"),
        ("period_us", "pd", "the drive accepts a whole number, 100 to 100000 us"),
    ):
        with pytest.raises(ParameterRangeError, match=allowed):
            host.set(name, number)
    assert len(link.sent) == before


def test_a_value_that_reads_back_differently_is_an_error() -> None:
    link = SimulatedLink()
    host = opened(link)
    host.parameter("torque_limit_nm")

    def alters(message: DriveMessage) -> list[DriveMessage]:
        if isinstance(message, ParameterReport):
            return [ParameterReport(message.index, Outcome.ACCEPTED, ParameterValue.f32(9.0), message.state)]
        return [message]

    link.alters = alters
    with pytest.raises(ParameterRejectedError, match="torque_limit_nm = 5: the drive answered Accepted and has 9 in"):
        host.set("torque_limit_nm", 5)


def test_a_parameter_that_is_not_live_is_rejected_while_running() -> None:
    host = running(SimulatedLink())
    with pytest.raises(ParameterRejectedError, match="stiffness_nm_rad = 2: the drive answered WrongState and"):
        host.set("stiffness_nm_rad", 2.0)


def test_a_gain_is_set_while_running_and_takes_effect_with_the_next_sample() -> None:
    host = running(SimulatedLink())
    before_nm = step(host)
    assert host.set("k_p1", 0.5) == 0.5
    assert step(host) == pytest.approx(0.5 * before_nm, rel=1e-4)


def test_a_request_is_sent_once_and_times_out_after_2_s() -> None:
    link = SimulatedLink()
    host = opened(link)
    link.loses_request = lambda it: isinstance(it, Arm)
    with pytest.raises(SilenceError, match="silent for 2 s after Arm"):
        host.arm()
    assert link.count(Arm) == 1
    assert link.now_s == pytest.approx(2.0)


def test_requests_have_the_numbers_1_to_255_in_turn_and_samples_none() -> None:
    link = SimulatedLink()
    host = running(link)
    first = len(link.sent)
    for _ in range(300):
        step(host)
        host.get("k_p1")
    assert set(link.numbers[first::2]) == {0}
    numbers = [*link.numbers[:first], *link.numbers[first + 1 :: 2]]
    assert numbers == [1 + it % 255 for it in range(len(numbers))]


def test_a_reset_restores_defaults_in_a_new_session() -> None:
    link = SimulatedLink()
    host = opened(link)
    host.set("torque_limit_nm", 5)
    assert host.reset().session == 8
    assert host.get("torque_limit_nm") == 20
    host.arm()


def test_a_far_end_that_accepts_nothing_times_out() -> None:
    link = SimulatedLink()

    def stuck(data: bytes, timeout_s: float) -> int:
        del data
        link.now_s += timeout_s
        return 0

    host = opened(link)
    link.write = stuck  # type: ignore[method-assign]
    with pytest.raises(LinkError, match=r"the far end accepted 0 of 12 bytes in 2 s"):
        host.arm()
