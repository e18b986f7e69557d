"""Requests in every state, sessions, versions and parameters, against the tables of the specification."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from lashloop.enums import CaptureTrigger, FaultCode, Outcome, ParameterType, ParameterValue, State, ZeroSource
from lashloop.frames import encode, open_frame
from lashloop.layout import has_number
from lashloop.limits import MINOR_VERSION, PROTOCOL_VERSION
from lashloop.messages import (
    HOST_MESSAGES,
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
    Identity,
    LineReport,
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
from running_drive import ENTER
from support import PARAMETER_COUNT, SESSION, DriveUnderTest, sample, sealed, table

OTHER = SESSION ^ 1
HELLO = Hello.of(SESSION)
# Index 0 is `controller`, signal 0 the torque before the limit; the last parameter is live.
REQUESTS: dict[str, HostMessage] = {
    "Hello, another session": Hello.of(OTHER),
    "Hello, same session": HELLO,
    "Hello, another version": Hello(PROTOCOL_VERSION + 1, MINOR_VERSION, OTHER),
    "DescribeParameter": DescribeParameter(0),
    "GetParameter": GetParameter(0),
    "SetParameter": SetParameter(0, ParameterValue.u32(0)),
    "SetParameter, live": SetParameter(PARAMETER_COUNT, ParameterValue.u32(10)),
    "Arm": Arm(SESSION),
    "Arm, another session": Arm(OTHER),
    "Start": Start(SESSION),
    "Start, another session": Start(OTHER),
    "Stop": Stop(),
    "EmergencyStop": EmergencyStop(),
    "ClearFault": ClearFault(),
    "Reset": Reset(),
    "DescribeLaw": DescribeLaw(0),
    "DescribeSignal": DescribeSignal(0),
    "DescribeChoice": DescribeChoice(0, 0),
    "Subscribe": Subscribe(1, 10),
    "EncoderSample": sample(0),
}
TRANSITIONS = [
    (row[0], state, cell)
    for row in table("## 6. States")
    for state, cell in zip(ENTER, row[1:], strict=True)
    if cell != "no session yet"
]


def outcome(answers: list[DriveMessage]) -> Outcome | None:
    """Outcome of a request; None without an answer that carries one."""
    outcomes = [it.outcome for it in answers if isinstance(it, CommandResult | ParameterReport)]
    return outcomes[-1] if outcomes else None


def test_the_table_of_transitions_is_complete() -> None:
    assert [row[0] for row in table("## 6. States")] == list(REQUESTS)
    assert len(TRANSITIONS) == 20 * 5 - 1


@pytest.mark.parametrize(("request_name", "state", "cell"), TRANSITIONS)
def test_every_request_in_every_state_acts_as_specified(request_name: str, state: str, cell: str) -> None:
    dut = ENTER[state]()
    assert dut.drive.state.label == state
    answers = dut.send(REQUESTS[request_name])
    if cell.startswith("-> "):
        assert dut.drive.state.label == cell[3:]
        assert outcome(answers) in (Outcome.ACCEPTED, None)
    else:
        assert dut.drive.state.label == state
        outcome_sent = outcome(answers)
        assert outcome_sent is not None
        assert outcome_sent.label == cell
    for answer in answers:
        if isinstance(answer, CommandResult | ParameterReport | Identity):
            assert answer.state is dut.drive.state
        if isinstance(answer, TorqueAnswer):
            assert answer.status.state is dut.drive.state


def test_a_fault_latched_before_any_session_clears_to_boot() -> None:
    dut = DriveUnderTest()
    dut.send(EmergencyStop())
    it = dut.only(CommandResult, ClearFault())
    assert (it.request, it.outcome, it.state) == (ClearFault.KIND, Outcome.ACCEPTED, State.BOOT)


def test_a_hello_of_another_version_gets_an_identity_only() -> None:
    dut = DriveUnderTest().running()
    dut.send(sample(0))
    torque_nm = dut.drive.torque_nm
    identity, result = dut.send(Hello(9, 1, OTHER))
    assert isinstance(identity, Identity)
    assert (identity.protocol_version, identity.session, identity.state) == (1, OTHER, State.RUNNING)
    assert isinstance(result, CommandResult)
    assert result.outcome is Outcome.VERSION_MISMATCH
    assert dut.drive.torque_nm == torque_nm != 0.0
    assert dut.drive.state is State.RUNNING


def test_a_new_session_keeps_the_parameters_and_a_reset_does_not() -> None:
    dut = DriveUnderTest().idle()
    dut.set("torque_limit_nm", ParameterValue.f32(3.0))
    dut.send(Hello.of(OTHER))
    assert dut.drive.parameters["torque_limit_nm"] == 3.0
    dut.send(Reset())
    assert dut.drive.parameters["torque_limit_nm"] == 20.0
    assert dut.only(CommandResult, Arm(OTHER)).outcome is Outcome.WRONG_SESSION


def test_the_first_fault_is_kept_and_sent_after_the_identity() -> None:
    dut = DriveUnderTest().running()
    dut.send(sample(0, reference_rad=math.inf))
    report, _ = dut.send(EmergencyStop())
    assert isinstance(report, FaultReport)
    assert report.code is FaultCode.EMERGENCY_STOP
    _, kept = dut.send(Hello.of(OTHER))
    assert isinstance(kept, FaultReport)
    assert kept.code is FaultCode.REFERENCE_NOT_FINITE


@pytest.mark.parametrize("index", range(PARAMETER_COUNT))
def test_every_parameter_accepts_exactly_its_range(index: int) -> None:
    dut = DriveUnderTest().idle()
    spec = dut.drive.parameters.specs[index]
    for value in (spec.min, spec.max, spec.default):
        report = dut.only(ParameterReport, SetParameter(index, value))
        assert (report.outcome, report.value) == (Outcome.ACCEPTED, value)
    if spec.default.type is ParameterType.U32:
        low, high = int(spec.min.value) - 1, int(spec.max.value) + 1
        outside = [ParameterValue.u32(it) for it in (low, high) if it >= 0]
        wrong = ParameterValue.f32(1.0)
    else:
        outside_values = (spec.min.value - 1e-3, spec.max.value * 1.001, math.inf, -math.inf, math.nan)
        outside = [ParameterValue.f32(it) for it in outside_values]
        wrong = ParameterValue.u32(1)
    for value in outside:
        report = dut.only(ParameterReport, SetParameter(index, value))
        assert (report.outcome, report.value) == (Outcome.OUT_OF_RANGE, spec.default)
    for other in (wrong, ParameterValue(ParameterType(77), 1)):
        report = dut.only(ParameterReport, SetParameter(index, other))
        assert (report.outcome, report.value) == (Outcome.WRONG_TYPE, spec.default)


def test_an_unknown_index_is_rejected_before_any_other_check() -> None:
    dut = DriveUnderTest()
    report = dut.only(ParameterReport, SetParameter(PARAMETER_COUNT, ParameterValue.u32(1)))
    assert (report.outcome, report.value) == (Outcome.UNKNOWN_INDEX, ParameterValue.u32(0))


def test_the_identity_has_the_period_and_the_encoders_in_force() -> None:
    dut = DriveUnderTest().idle()
    for name, number in (("period_us", 2000), ("motor_counts_per_rev", 4096), ("load_counts_per_rev", 8192)):
        dut.set(name, ParameterValue.u32(number))
    it = dut.only(Identity, HELLO)
    assert (it.period_us, it.motor_counts_per_rev, it.load_counts_per_rev) == (2000, 4096, 8192)


def test_there_is_neither_a_boot_loader_nor_bench_mode() -> None:
    for enter in ENTER.values():
        dut = enter()
        for request in (EnterLoader(SESSION), EnterLoader(OTHER), Reference(7, 0.0)):
            result = dut.only(CommandResult, request)
            assert (result.request, result.outcome) == (request.KIND, Outcome.WRONG_STATE)
            assert result.state is dut.drive.state


def test_nothing_is_stored_or_captured_and_there_are_no_encoders() -> None:
    requests = (
        StoreParameters(),
        RecallParameters(),
        ForgetParameters(),
        SetZero(ZeroSource.PRESENT),
        Capture(1, 1, 0, CaptureTrigger.NOW, 0, 0.0),
        ReadCapture(0),
    )
    for enter in ENTER.values():
        dut = enter()
        for request in requests:
            result = dut.only(CommandResult, request)
            assert (result.request, result.outcome) == (request.KIND, Outcome.UNKNOWN_REQUEST)
            assert result.state is dut.drive.state


def test_a_sample_while_not_running_gets_zero_torque() -> None:
    for enter in (ENTER["Idle"], ENTER["Armed"], ENTER["Faulted"]):
        dut = enter()
        wild = EncoderSample(99, 2**23 - 1, -(2**23), math.nan)
        for _ in range(2):
            answer = dut.only(TorqueAnswer, wild)
            assert (answer.sequence, answer.torque_nm, answer.status.flags) == (99, 0.0, 0)


def test_any_number_of_a_request_is_repeated_in_its_answers() -> None:
    dut = DriveUnderTest().running()
    for number in (0, 1, 255, 255, 7):
        for request in (HELLO, GetParameter(0), DescribeLaw(9), Start(SESSION)):
            (answer,) = dut.numbered(dut.drive.receive(encode(request, number)))
            assert answer.number == number, request
    # A fault report between two answers has none, and the refusal of a sample has 0.
    answers = dut.numbered(dut.drive.receive(encode(EmergencyStop(), 9)))
    assert [(type(it.message).__name__, it.number) for it in answers] == [("FaultReport", 0), ("CommandResult", 9)]
    dut.drive.receive(encode(Reset(), 9))
    (answer,) = dut.numbered(dut.drive.receive(encode(sample(0))))
    assert (type(answer.message).__name__, answer.number) == ("CommandResult", 0)


def test_device_time_is_that_of_the_request_and_never_runs_backwards() -> None:
    dut = DriveUnderTest()
    dut.clock.now_ns, dut.clock.step_ns = (2**32 - 10) * 1000, 5_700
    times_us: list[int | None] = []
    for request in (HELLO, Arm(SESSION), Start(SESSION), EmergencyStop(), HELLO, GetParameter(0), Stop()):
        answers = dut.send(request)
        its = {getattr(it, "device_time_us", None) for it in answers}
        assert len(its) == 1, answers
        times_us += its
    # The clock is read once for each request; the report of the fault is the same but for its time.
    assert times_us == [(2**32 - 10 + 57 * count // 10) % 2**32 for count in range(1, 8)]
    reports = [it for it in (*dut.send(EmergencyStop()), *dut.send(HELLO)) if isinstance(it, FaultReport)]
    assert reports[0] == replace(reports[1], device_time_us=reports[0].device_time_us)
    assert reports[0] != reports[1]


@pytest.mark.parametrize("name", REQUESTS)
def test_longer_requests_of_a_newer_host_are_those_of_this_version(name: str) -> None:
    for state in ENTER:
        dut, other = ENTER[state](), ENTER[state]()
        body = open_frame(encode(REQUESTS[name], 9)[:-1])
        assert dut.drive.receive(sealed(body + b"\x01\x00\xff")) == other.drive.receive(sealed(body))
        assert dut.drive.state is other.drive.state


def test_a_host_of_a_newer_minor_version_opens_a_session() -> None:
    dut = DriveUnderTest()
    identity = dut.only(Identity, Hello(PROTOCOL_VERSION, MINOR_VERSION + 1, SESSION))
    assert (identity.protocol_version, identity.minor_version) == (PROTOCOL_VERSION, MINOR_VERSION)
    assert dut.only(CommandResult, Arm(SESSION)).outcome is Outcome.ACCEPTED


UNKNOWN_KINDS = sorted(set(range(1, 0x80)) - {it.KIND for it in HOST_MESSAGES})


@pytest.mark.parametrize("state", ENTER)
def test_unknown_requests_of_a_newer_host_are_answered_and_change_nothing(state: str) -> None:
    dut = ENTER[state]()
    for kind in UNKNOWN_KINDS:
        for body, number in ((b"\x09", 9), (b"\xff" + bytes(50), 255), (b"", 0)):
            answers = dut.numbered(dut.drive.receive(sealed(bytes([kind]) + body)))
            if has_number(kind):
                (answer,) = answers
                assert answer.number == number
                wanted = CommandResult(kind, Outcome.UNKNOWN_REQUEST, dut.drive.state, 0, device_time_us=0)
                assert answer.message == wanted
            else:
                assert answers == []
            assert dut.drive.state.label == state


def test_unknown_requests_count_as_messages_and_feed_no_watchdog() -> None:
    dut = DriveUnderTest().running()
    dut.send(sample(0))
    dut.clock.pass_us(15_000)
    for kind in UNKNOWN_KINDS:
        dut.drive.receive(sealed(bytes([kind, 1])))
    report, _ = dut.send(Stop())
    assert isinstance(report, LineReport)
    assert (report.messages, report.damaged, report.refused) == (2 + len(UNKNOWN_KINDS), 0, 0)
    dut.running().send(sample(0))
    dut.clock.pass_us(15_000)
    dut.drive.receive(sealed(b"\x7f\x01"))
    dut.clock.pass_us(5_001)
    assert dut.drive.tick() != b""
