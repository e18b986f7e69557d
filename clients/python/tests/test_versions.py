"""A host of version 1.0 with a drive of version 1.1: what the drive has added, and answers that come late."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from lashloop import limits
from lashloop.enums import (
    Capabilities,
    FaultCode,
    Outcome,
    ParameterFlags,
    ParameterType,
    ParameterValue,
    State,
    TorqueFlags,
    TorqueStatus,
)
from lashloop.frames import Numbered, encode, open_frame
from lashloop.host import (
    DriveFaultError,
    ParameterRangeError,
    ParameterRejectedError,
    RejectedError,
    SilenceError,
    VersionError,
)
from lashloop.layout import has_number
from lashloop.messages import (
    LAYOUTS,
    Arm,
    ChoiceDescription,
    CommandResult,
    DescribeChoice,
    DriveMessage,
    FaultReport,
    Hello,
    Identity,
    LineReport,
    ParameterDescription,
    ParameterReport,
    Telemetry,
    TorqueAnswer,
)
from simulated_link import SimulatedLink, opened, running, step
from support import sealed

if TYPE_CHECKING:
    from collections.abc import Callable

    from simulated_link import Altered

NAMES = {61: "BrakeStuck", 62: None, 200: "Overheated"}
"""Faults that the drive has added; it has no name for one of them."""


def added(link: SimulatedLink, message: DriveMessage) -> Altered:
    """The message with two added fields, an unknown kind before it, and the minor version of the drive."""
    if isinstance(message, Identity):
        message = replace(message, minor_version=1, capabilities=message.capabilities | Capabilities(0x40))
    body = open_frame(encode(message, link.number)[:-1])
    # A telemetry ends with its values, and the longest kinds have no room.
    if not isinstance(message, Telemetry) and len(body) <= limits.MAX_BODY - 3:
        assert len(body) == LAYOUTS[type(message)].body_lens[-1]
        body += b"\x05\x01\x02"
    return [sealed(b"\xa0" + bytes([link.number, 1])), sealed(b"\x9e\x01"), sealed(body)]


def newer() -> SimulatedLink:
    """A link to a drive of version 1.1."""
    link = SimulatedLink()
    link.alters = lambda message: added(link, message)
    return link


def test_added_fields_kinds_and_capabilities_change_nothing_for_the_host() -> None:
    link = newer()
    with opened(link) as host:
        assert (host.identity.protocol_version, host.identity.minor_version) == (1, 1)
        assert str(host.identity.capabilities) == "device time, unknown 0x40"
        assert host.laws == ("pd",)
        assert host.parameters["torque_limit_nm"].allowed == "0 to 1000 N m"
        assert host.set("torque_limit_nm", 15.0) == 15.0
        host.subscribe(["load_error_rad"], every=1)
        host.arm()
        host.start()
        assert [step(host) for _ in range(3)] == [step(host)] * 3
        report = host.stop()
        assert host.telemetry is not None
        assert host.telemetry["load_error_rad"] == pytest.approx(-1.0, abs=1e-4)
    assert (report.messages, report.damaged, report.refused) == (5, 0, 0)
    assert (host.counters.damaged, host.counters.refused, host.counters.discarded_bytes) == (0, 0, 0)
    assert host.counters.unknown == 2 * host.counters.messages


def test_the_drive_gets_the_versions_of_the_host() -> None:
    link = newer()
    opened(link)
    assert link.sent == [Hello(1, 0, 7)]


def test_another_protocol_version_is_rejected_whatever_follows_it() -> None:
    link = SimulatedLink()
    link.alters = lambda it: [replace(it, protocol_version=2, law_count=0) if isinstance(it, Identity) else it]
    with pytest.raises(VersionError, match="the drive has protocol version 2, this host has version 1"):
        opened(link)


def faulting(code: int, answers: Callable[[int], Altered]) -> SimulatedLink:
    """A link to a drive that latches a fault of this code at the second sample."""
    link = SimulatedLink()

    def alters(message: DriveMessage) -> Altered:
        if isinstance(message, TorqueAnswer) and message.sequence == 1:
            status = TorqueStatus(State.FAULTED, TorqueFlags(0))
            return [replace(message, torque_nm=0.0, status=status), FaultReport(FaultCode(code), 1, 2.5, 2.0, 0x1F, 7)]
        request = link.sent[-1]
        if isinstance(request, DescribeChoice) and request.parameter == limits.FAULT_NAMES:
            return answers(request.choice)
        return [message]

    link.alters = alters
    return link


def named(code: int) -> Altered:
    """The answer of a drive that has names for its faults."""
    name = NAMES[code]
    if name is None:
        return [CommandResult(DescribeChoice.KIND, Outcome.UNKNOWN_INDEX, State.FAULTED)]
    return [ChoiceDescription(limits.FAULT_NAMES, code, name)]


@pytest.mark.parametrize(("code", "text"), [(61, "BrakeStuck"), (62, "unknown 62"), (200, "Overheated")])
def test_a_fault_that_the_drive_has_added_ends_the_run_with_the_drive_s_name(code: int, text: str) -> None:
    link = faulting(code, named)
    host = running(link)
    step(host)
    with pytest.raises(DriveFaultError) as raised:
        step(host)
    expected = f"{text} at sample 1: 2.5, the limit is 2, detail 0x1f"
    assert str(raised.value) == f"the drive latched {expected}"
    assert raised.value.fault.message.code is FaultCode(code)
    # The name is asked for once.
    assert (str(host.fault), str(host.fault)) == (expected, expected)
    assert link.count(DescribeChoice) == 2, "the choice of `controller`, and the fault"


def test_the_number_of_a_fault_stands_if_the_drive_is_silent_about_its_name() -> None:
    link = faulting(61, lambda _: [])
    host = running(link)
    step(host)
    start_s = link.now_s
    with pytest.raises(DriveFaultError, match=r"^the drive latched unknown 61 at sample 1: 2\.5, the limit is 2, "):
        step(host)
    assert link.now_s - start_s == pytest.approx(2.0)
    assert str(host.fault).startswith("unknown 61 at sample 1")
    assert link.now_s - start_s == pytest.approx(2.0)


def test_a_fault_that_arrives_before_another_answer_is_named_on_request() -> None:
    link = SimulatedLink()
    host = opened(link)
    report = FaultReport(FaultCode(200), 0, 0.0, 0.0, 0)

    def alters(message: DriveMessage) -> Altered:
        request = link.sent[-1]
        if isinstance(request, DescribeChoice) and request.parameter == limits.FAULT_NAMES:
            return named(request.choice)
        return [report, message] if isinstance(message, ParameterReport) else [message]

    host.parameter("k_p1")
    link.alters = alters
    host.get("k_p1")
    assert str(host.fault) == "Overheated (sequence 0)"


def refusing(answer: Callable[[CommandResult | ParameterReport], DriveMessage]) -> SimulatedLink:
    """A link to a drive that changes its answers to `Arm` and `SetParameter`, and names the outcome 77."""
    link = SimulatedLink()

    def alters(message: DriveMessage) -> Altered:
        request = link.sent[-1]
        if request == DescribeChoice(limits.OUTCOME_NAMES, 77):
            return [ChoiceDescription(limits.OUTCOME_NAMES, 77, "TooHot")]
        if isinstance(message, ParameterReport) or (isinstance(message, CommandResult) and message.request == Arm.KIND):
            return [answer(message)]
        return [message]

    link.alters = alters
    return link


@pytest.mark.parametrize(
    ("outcome", "detail", "expected"),
    [
        (Outcome(77), 0, "TooHot"),
        (Outcome(77), 3, "TooHot (detail 3)"),
        (Outcome(78), 0, "unknown 78"),
        (Outcome(78), 3, "unknown 78 (detail 3)"),
        (Outcome.WRONG_STATE, 0, "WrongState"),
        (Outcome.WRONG_STATE, 4, "WrongState (detail 4)"),
        (Outcome.INCONSISTENT, 1, "Inconsistent (period_us does not go with the other parameters)"),
        (Outcome.INCONSISTENT, 99, "Inconsistent (parameter 99 does not go with the other parameters)"),
        (Outcome.INCONSISTENT, 2**32 - 1, "Inconsistent (parameter 4294967295 does not go with the other parameters)"),
        (Outcome.SIGNAL_OF_OTHER_LAW, 31, "SignalOfOtherLaw (signal 31 isn't a signal of the law in force)"),
        (Outcome.POWER_STAGE_FAULT, 2, "PowerStageFault (fault line)"),
        (Outcome.POWER_STAGE_FAULT, 9, "PowerStageFault (detail 9)"),
        (Outcome.ENCODER_IMPLAUSIBLE, 5, "EncoderImplausible (both channels of the load encoder changed at once)"),
    ],
)
def test_a_refusal_has_its_cause_in_words(outcome: Outcome, detail: int, expected: str) -> None:
    host = opened(refusing(lambda it: replace(it, outcome=outcome, detail=detail)))
    with pytest.raises(RejectedError) as raised:
        host.arm()
    assert str(raised.value) == f"the drive rejected Arm in state Armed: {expected}"
    assert raised.value.outcome is outcome
    with pytest.raises(ParameterRejectedError) as rejected:
        host.set("k_p1", 1.0)
    assert str(rejected.value) == f"k_p1 = 1: the drive answered {expected} and has 1 in force"
    assert f"({raised.value.cause})" in expected or raised.value.cause == rejected.value.cause == ""


def test_late_answers_do_not_answer_the_next_request() -> None:
    link = SimulatedLink()
    host = opened(link)
    host.set("k_p1", 3.0)
    link.delay_s = 2.5
    with pytest.raises(SilenceError, match="silent for 2 s after GetParameter"):
        host.get("k_p1")
    link.delay_s = 0.6
    # The late answer arrives 0.5 s later, with the value before.
    assert host.set("k_p1", 4.0) == 4.0
    link.delay_s = 2.5
    with pytest.raises(SilenceError, match="silent for 2 s after Arm"):
        host.arm()
    link.delay_s = 0.6
    with pytest.raises(RejectedError, match="rejected Arm in state Armed: WrongState"):
        host.arm()


def test_answers_of_other_numbers_are_ignored_in_a_run() -> None:
    link = SimulatedLink()

    def alters(message: DriveMessage) -> Altered:
        other = (link.number + 1) % 256
        others: list[Numbered[DriveMessage]] = [
            Numbered(other, CommandResult(link.sent[-1].KIND, Outcome.WRONG_STATE, State.BOOT)),
            Numbered(other, ParameterReport(1, Outcome.WRONG_STATE, ParameterValue.u32(0), State.BOOT)),
        ]
        return [*others, message]

    link.alters = alters
    host = running(link)
    assert host.set("k_p1", 0.5) == 0.5
    assert step(host) != 0.0
    assert host.stop().damaged == 0


def test_a_drive_without_a_clock_has_no_device_time() -> None:
    link = SimulatedLink()

    def alters(message: DriveMessage) -> Altered:
        if isinstance(message, Identity):
            message = replace(message, capabilities=Capabilities(0))
        if isinstance(message, Identity | ParameterReport | LineReport | CommandResult | FaultReport):
            message = replace(message, device_time_us=None)
        return [message]

    link.alters = alters
    host = running(link)
    assert (host.identity.device_time_us, str(host.identity.capabilities)) == (None, "none")
    step(host)
    assert host.stop().device_time_us is None
    fault = host.emergency_stop()
    assert fault.message.device_time_us is None
    assert host.counters.refused == 0


def test_device_time_of_a_drive_with_a_clock_is_kept() -> None:
    link = SimulatedLink()
    link.dut.clock.now_ns = 5_000_000
    assert opened(link).identity.device_time_us == 5000


def test_an_added_torque_flag_is_ignored_and_an_added_state_is_not_running() -> None:
    link = SimulatedLink()
    host = running(link)
    state, flags = State.RUNNING, TorqueFlags(0x80)

    def alters(message: DriveMessage) -> Altered:
        if isinstance(message, TorqueAnswer):
            message = replace(message, status=TorqueStatus(state, message.status.flags | flags))
        return [message]

    link.alters = alters
    assert step(host) != 0.0
    assert host.last_answer is not None
    assert TorqueFlags.GAP not in host.last_answer.message.status.flags
    state = State(9)
    with pytest.raises(RejectedError, match="rejected EncoderSample in state unknown 9: WrongState"):
        step(host)


def test_a_parameter_of_an_added_type_is_listed_and_can_not_be_set() -> None:
    link = SimulatedLink()
    value = ParameterValue(ParameterType(3), 0x10)

    def alters(message: DriveMessage) -> Altered:
        if isinstance(message, ParameterDescription) and message.name == "k_d1":
            return [replace(message, flags=ParameterFlags(0x80), default=value, min=value, max=value)]
        if isinstance(message, ParameterReport) and message.index == host.parameters["k_d1"].index:
            return [replace(message, value=value)]
        return [message]

    link.alters = alters
    host = opened(link)
    parameter = host.parameter("k_d1")
    assert parameter.allowed == "values of a type that this host does not know (unknown 3)"
    assert parameter.text(host.get("k_d1")) == "0x00000010 (unknown 3)"
    before = len(link.sent)
    with pytest.raises(ParameterRangeError, match="k_d1 = 1: the drive accepts values of a type that this host"):
        host.set("k_d1", 1)
    assert len(link.sent) == before
    assert host.set("k_p1", 2.0) == 2.0


def test_kinds_that_nobody_knows_have_numbers_by_the_same_rule() -> None:
    assert [kind for kind in range(256) if not has_number(kind)] == [*range(0x10, 0x20), *range(0x90, 0xA0)]
