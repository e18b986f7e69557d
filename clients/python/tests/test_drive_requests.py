"""Requests in every state, sessions, versions and parameters, against the tables of the specification."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from lashloop.control import ControlLaw, signal, u32
from lashloop.control.cascade import PD
from lashloop.enums import FaultCode, Outcome, ParameterType, ParameterValue, State
from lashloop.frames import encode
from lashloop.messages import (
    PROTOCOL_VERSION,
    Arm,
    ClearFault,
    CommandResult,
    DescribeChoice,
    DescribeLaw,
    DescribeParameter,
    DescribeSignal,
    DriveMessage,
    EmergencyStop,
    EncoderSample,
    FaultReport,
    GetParameter,
    Hello,
    HostMessage,
    Identity,
    Log,
    ParameterReport,
    Reset,
    SetParameter,
    Start,
    Stop,
    Subscribe,
    TorqueAnswer,
)
from support import PARAMETER_COUNT, SESSION, DriveUnderTest, sample, table

if TYPE_CHECKING:
    from collections.abc import Callable

OTHER = SESSION ^ 1
ORDER_OF_ANSWERS = "### Answers"
HELLO = Hello(PROTOCOL_VERSION, SESSION)
TUNED = replace(PD, parameters=(*PD.parameters, u32("tuning", "", 10, 0, 10, live=True)))
"""The law with a live parameter after its own."""
TWO = (PD, ControlLaw(name="other", signals=(signal("other", ""),), build=PD.build))
FOREIGN = 1 + len(PD.signals)
"""Index of the signal of the second law, which `pd` lacks."""
ENTER: dict[str, Callable[[], DriveUnderTest]] = {
    "Boot": lambda: DriveUnderTest(laws=[TUNED]),
    "Idle": lambda: DriveUnderTest(laws=[TUNED]).idle(),
    "Armed": lambda: DriveUnderTest(laws=[TUNED]).armed(),
    "Running": lambda: DriveUnderTest(laws=[TUNED]).running(),
    "Faulted": lambda: faulted(),
}
# Index 0 is `controller`, signal 0 the torque before the limit; the last parameter is live.
REQUESTS: dict[str, HostMessage] = {
    "Hello, another session": Hello(PROTOCOL_VERSION, OTHER),
    "Hello, same session": HELLO,
    "Hello, another version": Hello(PROTOCOL_VERSION + 1, OTHER),
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


def faulted() -> DriveUnderTest:
    """A drive with a session and a latched emergency stop."""
    dut = DriveUnderTest(laws=[TUNED]).idle()
    dut.send(EmergencyStop())
    return dut


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


def inconsistent() -> DriveUnderTest:
    """An idle drive whose encoder resolutions differ too much."""
    dut = DriveUnderTest().idle()
    dut.set("motor_counts_per_rev", ParameterValue.u32(16_777_216))
    dut.set("load_counts_per_rev", ParameterValue.u32(4))
    dut.set("reduction_ratio", ParameterValue.f32(10.0))
    return dut


def foreign_signal() -> DriveUnderTest:
    """An idle drive with a subscription to a signal of its other law."""
    dut = DriveUnderTest(laws=TWO).idle()
    assert dut.subscribe(FOREIGN) is Outcome.ACCEPTED
    return dut


def with_telemetry(every: int) -> DriveUnderTest:
    """A running drive after sample 0."""
    dut = DriveUnderTest().running()
    dut.subscribe(0, every=every)
    dut.send(sample(0))
    return dut


def late() -> DriveUnderTest:
    """A running drive after its watchdog time, before any check of the watchdog."""
    dut = DriveUnderTest().running()
    dut.send(sample(0))
    dut.clock.pass_us(20_001)
    return dut


ANSWERS: dict[tuple[str, str], list[tuple[Callable[[], DriveUnderTest], HostMessage]]] = {
    ("Hello", "same version"): [(DriveUnderTest, HELLO)],
    ("Hello", "same version, fault latched"): [(faulted, HELLO)],
    ("Hello", "another version"): [(DriveUnderTest, Hello(2, SESSION))],
    ("Hello", "another version, fault latched"): [(faulted, Hello(2, SESSION))],
    ("DescribeParameter", "known index"): [(DriveUnderTest, DescribeParameter(PARAMETER_COUNT - 1))],
    ("DescribeParameter", "unknown index"): [(DriveUnderTest, DescribeParameter(PARAMETER_COUNT))],
    ("GetParameter", "any index"): [(DriveUnderTest, GetParameter(0)), (DriveUnderTest, GetParameter(255))],
    ("SetParameter", "any index"): [
        (DriveUnderTest().idle, SetParameter(0, ParameterValue.u32(1))),
        (DriveUnderTest().idle, SetParameter(255, ParameterValue.u32(1))),
    ],
    ("DescribeLaw", "known index"): [(DriveUnderTest, DescribeLaw(0))],
    ("DescribeLaw", "unknown index"): [(DriveUnderTest, DescribeLaw(1))],
    ("DescribeSignal", "known index"): [(DriveUnderTest, DescribeSignal(len(PD.signals)))],
    ("DescribeSignal", "unknown index"): [(DriveUnderTest, DescribeSignal(1 + len(PD.signals)))],
    ("DescribeChoice", "known index"): [(DriveUnderTest, DescribeChoice(0, 0))],
    ("DescribeChoice", "unknown index"): [
        (DriveUnderTest, DescribeChoice(0, 1)),
        (DriveUnderTest, DescribeChoice(1, 0)),
        (DriveUnderTest, DescribeChoice(255, 0)),
    ],
    ("Subscribe", "done, refused for any other reason"): [
        *((enter, Subscribe(1, 10)) for enter in ENTER.values()),
        (DriveUnderTest().running, Subscribe(1 << 31, 10)),
    ],
    ("Subscribe", "the law in force lacks a signal"): [
        (lambda: DriveUnderTest(laws=TWO).armed(), Subscribe(1 << FOREIGN, 10)),
        (lambda: DriveUnderTest(laws=TWO).running(), Subscribe(1 << FOREIGN, 0)),
    ],
    ("Arm", "done, wrong state, wrong session"): [
        (DriveUnderTest().idle, Arm(SESSION)),
        (DriveUnderTest().armed, Arm(SESSION)),
        (DriveUnderTest().idle, Arm(OTHER)),
    ],
    ("Arm", "parameters don't go together"): [(inconsistent, Arm(SESSION))],
    ("Arm", "the law in force lacks a subscribed signal"): [(foreign_signal, Arm(SESSION))],
    ("Start", "any"): [(DriveUnderTest().armed, Start(SESSION)), (DriveUnderTest, Start(SESSION))],
    ("Stop", "any"): [(enter, Stop()) for enter in ENTER.values()],
    ("EmergencyStop", "any"): [(enter, EmergencyStop()) for enter in ENTER.values()],
    ("ClearFault", "any"): [(enter, ClearFault()) for enter in ENTER.values()],
    ("Reset", "any"): [(enter, Reset()) for enter in ENTER.values()],
    ("EncoderSample", "Boot"): [(DriveUnderTest, sample(0))],
    ("EncoderSample", "Idle, Armed, Faulted"): [(ENTER[state], sample(7)) for state in ("Idle", "Armed", "Faulted")],
    ("EncoderSample", "Running, no telemetry due"): [(lambda: with_telemetry(2), sample(1))],
    ("EncoderSample", "Running, telemetry due"): [(lambda: with_telemetry(2), sample(2))],
    ("EncoderSample", "Running, the sample causes a fault"): [
        (lambda: with_telemetry(1), sample(1, reference_rad=math.nan))
    ],
    ("EncoderSample", "Running, later than the watchdog allows"): [(late, sample(1)), (late, sample(0))],
    ("EncoderSample", "Running, repeated"): [(lambda: with_telemetry(1), sample(0))],
    ("EncoderSample", "Running, out of sequence"): [(lambda: with_telemetry(1), sample(1001))],
}


@pytest.mark.parametrize("row", table("## 4. Messages"), ids=lambda row: str(row[1]))
def test_every_request_has_its_rows_in_the_table_of_answers(row: list[str]) -> None:
    # Those of sections 18 and 19 are optional.
    if row[2] == "host" and row[1] not in {"Reference", "EnterLoader"}:
        assert any(request == row[1] for request, _ in ANSWERS)


@pytest.mark.parametrize(("request_name", "case", "wanted"), table(ORDER_OF_ANSWERS))
def test_answers_are_sent_in_the_specified_order(request_name: str, case: str, wanted: str) -> None:
    for enter, request in ANSWERS[request_name, case]:
        dut = enter()
        assert type(request).__name__ == request_name
        answers = dut.send(request)
        assert [type(it).__name__ for it in answers] == wanted.split(", "), (dut.drive.state, request)


def test_every_row_of_the_table_of_answers_is_covered() -> None:
    assert [tuple(row[:2]) for row in table(ORDER_OF_ANSWERS)] == list(ANSWERS)


def test_requests_in_one_read_are_answered_in_order() -> None:
    dut = DriveUnderTest()
    answers = dut.decode(dut.drive.receive(b"".join(map(encode, [HELLO, HELLO, Arm(SESSION), GetParameter(3)]))))
    assert [type(it).__name__ for it in answers] == ["Identity", "Identity", "CommandResult", "ParameterReport"]


def test_a_fault_latched_before_any_session_clears_to_boot() -> None:
    dut = DriveUnderTest()
    dut.send(EmergencyStop())
    assert dut.only(CommandResult, ClearFault()) == CommandResult(ClearFault.KIND, Outcome.ACCEPTED, State.BOOT)


def test_a_hello_of_another_version_gets_an_identity_only() -> None:
    dut = DriveUnderTest().running()
    dut.send(sample(0))
    torque_nm = dut.drive.torque_nm
    identity, result = dut.send(Hello(9, OTHER))
    assert isinstance(identity, Identity)
    assert (identity.protocol_version, identity.session, identity.state) == (1, OTHER, State.RUNNING)
    assert isinstance(result, CommandResult)
    assert result.outcome is Outcome.VERSION_MISMATCH
    assert dut.drive.torque_nm == torque_nm != 0.0
    assert dut.drive.state is State.RUNNING


def test_a_new_session_keeps_the_parameters_and_a_reset_does_not() -> None:
    dut = DriveUnderTest().idle()
    dut.set("torque_limit_nm", ParameterValue.f32(3.0))
    dut.send(Hello(1, OTHER))
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
    _, kept = dut.send(Hello(1, OTHER))
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
    report = dut.only(ParameterReport, SetParameter(index, wrong))
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


def test_arming_rejects_inconsistent_parameters_by_name() -> None:
    dut = inconsistent()
    log, result = dut.send(Arm(SESSION))
    assert isinstance(log, Log)
    assert log.text == "motor counts per load count does not go with the others"[:52]
    assert isinstance(result, CommandResult)
    assert (result.outcome, result.state) == (Outcome.INCONSISTENT, State.IDLE)


def test_a_sample_while_not_running_gets_zero_torque() -> None:
    for enter in (ENTER["Idle"], ENTER["Armed"], ENTER["Faulted"]):
        dut = enter()
        wild = EncoderSample(99, 2**23 - 1, -(2**23), math.nan)
        for _ in range(2):
            answer = dut.only(TorqueAnswer, wild)
            assert (answer.sequence, answer.torque_nm, answer.status.flags) == (99, 0.0, 0)
