"""Requests in every state, sessions, versions and parameters, against the tables of the specification."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from lashloop.control import ControlLaw
from lashloop.control.cascade import PD, CascadedPd
from lashloop.drive import Drive
from lashloop.enums import FaultCode, Outcome, ParameterType, ParameterValue, State, shortest
from lashloop.frames import encode
from lashloop.messages import (
    PROTOCOL_VERSION,
    Arm,
    ClearFault,
    CommandResult,
    DescribeParameter,
    DriveMessage,
    EmergencyStop,
    EncoderSample,
    FaultReport,
    GetParameter,
    Hello,
    HostMessage,
    Identity,
    Log,
    ParameterDescription,
    ParameterReport,
    Reset,
    SetParameter,
    Start,
    Stop,
    TorqueAnswer,
)
from support import PARAMETER_COUNT, SESSION, DriveUnderTest, sample, table

if TYPE_CHECKING:
    from collections.abc import Callable

OTHER = SESSION ^ 1
ORDER_OF_ANSWERS = "### Answers"
HELLO = Hello(PROTOCOL_VERSION, SESSION)
ENTER: dict[str, Callable[[], DriveUnderTest]] = {
    "Boot": DriveUnderTest,
    "Idle": lambda: DriveUnderTest().idle(),
    "Armed": lambda: DriveUnderTest().armed(),
    "Running": lambda: DriveUnderTest().running(),
    "Faulted": lambda: faulted(),
}
# Index 0 is `controller`, 8 is `telemetry_every`, which is live.
REQUESTS: dict[str, HostMessage] = {
    "Hello, another session": Hello(PROTOCOL_VERSION, OTHER),
    "Hello, same session": HELLO,
    "Hello, another version": Hello(PROTOCOL_VERSION + 1, OTHER),
    "DescribeParameter": DescribeParameter(0),
    "GetParameter": GetParameter(0),
    "SetParameter": SetParameter(0, ParameterValue.u32(1)),
    "SetParameter, live": SetParameter(8, ParameterValue.u32(10)),
    "Arm": Arm(SESSION),
    "Arm, another session": Arm(OTHER),
    "Start": Start(SESSION),
    "Start, another session": Start(OTHER),
    "Stop": Stop(),
    "EmergencyStop": EmergencyStop(),
    "ClearFault": ClearFault(),
    "Reset": Reset(),
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
    bench = DriveUnderTest().idle()
    bench.send(EmergencyStop())
    return bench


def outcome(answers: list[DriveMessage]) -> Outcome | None:
    """Outcome of a request; None without an answer that carries one."""
    told = [it.outcome for it in answers if isinstance(it, CommandResult | ParameterReport)]
    return told[-1] if told else None


def test_the_table_of_transitions_is_complete() -> None:
    assert [row[0] for row in table("## 6. States")] == list(REQUESTS)
    assert len(TRANSITIONS) == 16 * 5 - 1


@pytest.mark.parametrize(("request_name", "state", "cell"), TRANSITIONS)
def test_every_request_in_every_state_acts_as_specified(request_name: str, state: str, cell: str) -> None:
    bench = ENTER[state]()
    assert bench.drive.state.label == state
    answers = bench.send(REQUESTS[request_name])
    if cell.startswith("-> "):
        assert bench.drive.state.label == cell[3:]
        assert outcome(answers) in (Outcome.ACCEPTED, None)
    else:
        assert bench.drive.state.label == state
        said = outcome(answers)
        assert said is not None
        assert said.label == cell
    for answer in answers:
        if isinstance(answer, CommandResult | ParameterReport | Identity):
            assert answer.state is bench.drive.state
        if isinstance(answer, TorqueAnswer):
            assert answer.status.state is bench.drive.state


def inconsistent() -> DriveUnderTest:
    """An idle drive whose encoder resolutions differ too much."""
    bench = DriveUnderTest().idle()
    bench.set("motor_counts_per_rev", ParameterValue.u32(16_777_216))
    bench.set("load_counts_per_rev", ParameterValue.u32(4))
    bench.set("reduction_ratio", ParameterValue.f32(10.0))
    return bench


def with_telemetry(every: int) -> DriveUnderTest:
    """A running drive after sample 0."""
    bench = DriveUnderTest().running(telemetry_every=ParameterValue.u32(every))
    bench.send(sample(0))
    return bench


def late() -> DriveUnderTest:
    """A running drive after its watchdog time, before any check of the watchdog."""
    bench = DriveUnderTest().running()
    bench.send(sample(0))
    bench.clock.pass_us(20_001)
    return bench


ANSWERS: dict[tuple[str, str], list[tuple[Callable[[], DriveUnderTest], HostMessage]]] = {
    ("Hello", "same version"): [(DriveUnderTest, HELLO)],
    ("Hello", "same version, fault latched"): [(faulted, HELLO)],
    ("Hello", "another version"): [(DriveUnderTest, Hello(2, SESSION))],
    ("Hello", "another version, fault latched"): [(faulted, Hello(2, SESSION))],
    ("DescribeParameter", "known index"): [(DriveUnderTest, DescribeParameter(29))],
    ("DescribeParameter", "unknown index"): [(DriveUnderTest, DescribeParameter(PARAMETER_COUNT))],
    ("GetParameter", "any index"): [(DriveUnderTest, GetParameter(0)), (DriveUnderTest, GetParameter(255))],
    ("SetParameter", "any index"): [
        (DriveUnderTest().idle, SetParameter(0, ParameterValue.u32(1))),
        (DriveUnderTest().idle, SetParameter(255, ParameterValue.u32(1))),
    ],
    ("Arm", "done, wrong state, wrong session"): [
        (DriveUnderTest().idle, Arm(SESSION)),
        (DriveUnderTest().armed, Arm(SESSION)),
        (DriveUnderTest().idle, Arm(OTHER)),
    ],
    ("Arm", "parameters don't go together"): [(inconsistent, Arm(SESSION))],
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
    if row[2] == "host":
        assert any(request == row[1] for request, _ in ANSWERS)


@pytest.mark.parametrize(("request_name", "case", "wanted"), table(ORDER_OF_ANSWERS))
def test_answers_are_sent_in_the_specified_order(request_name: str, case: str, wanted: str) -> None:
    for enter, request in ANSWERS[request_name, case]:
        bench = enter()
        assert type(request).__name__ == request_name
        answers = bench.send(request)
        assert [type(it).__name__ for it in answers] == wanted.split(", "), (bench.drive.state, request)


def test_every_row_of_the_table_of_answers_is_covered() -> None:
    assert [tuple(row[:2]) for row in table(ORDER_OF_ANSWERS)] == list(ANSWERS)


def test_requests_in_one_read_are_answered_in_order() -> None:
    bench = DriveUnderTest()
    said = bench.decode(bench.drive.receive(b"".join(map(encode, [HELLO, HELLO, Arm(SESSION), GetParameter(3)]))))
    assert [type(it).__name__ for it in said] == ["Identity", "Identity", "CommandResult", "ParameterReport"]


def test_a_fault_latched_before_any_session_clears_to_boot() -> None:
    bench = DriveUnderTest()
    bench.send(EmergencyStop())
    assert bench.only(CommandResult, ClearFault()) == CommandResult(ClearFault.KIND, Outcome.ACCEPTED, State.BOOT)


def test_a_hello_of_another_version_gets_an_identity_only() -> None:
    bench = DriveUnderTest().running()
    bench.send(sample(0))
    torque_nm = bench.drive.torque_nm
    identity, result = bench.send(Hello(9, OTHER))
    assert isinstance(identity, Identity)
    assert (identity.protocol_version, identity.session, identity.state) == (1, OTHER, State.RUNNING)
    assert isinstance(result, CommandResult)
    assert result.outcome is Outcome.VERSION_MISMATCH
    assert bench.drive.torque_nm == torque_nm != 0.0
    assert bench.drive.state is State.RUNNING


def test_a_new_session_keeps_the_parameters_and_a_reset_does_not() -> None:
    bench = DriveUnderTest().idle()
    bench.set("torque_limit_nm", ParameterValue.f32(3.0))
    bench.send(Hello(1, OTHER))
    assert bench.drive.parameters["torque_limit_nm"] == 3.0
    bench.send(Reset())
    assert bench.drive.parameters["torque_limit_nm"] == 20.0
    assert bench.only(CommandResult, Arm(OTHER)).outcome is Outcome.WRONG_SESSION


def test_the_first_fault_is_kept_and_sent_after_the_identity() -> None:
    bench = DriveUnderTest().running()
    bench.send(sample(0, reference_rad=math.inf))
    told, _ = bench.send(EmergencyStop())
    assert isinstance(told, FaultReport)
    assert told.code is FaultCode.EMERGENCY_STOP
    _, kept = bench.send(Hello(1, OTHER))
    assert isinstance(kept, FaultReport)
    assert kept.code is FaultCode.REFERENCE_NOT_FINITE


def test_parameters_match_the_specification_except_controller() -> None:
    bench = DriveUnderTest()
    described = []
    for index in range(len(bench.drive.parameters)):
        it = bench.only(ParameterDescription, DescribeParameter(index))
        numbers = [it.default, it.min, it.max]
        described.append(
            [str(index), it.name, it.unit, it.default.type.label, *map(str, numbers), "yes" if it.live else ""]
        )
    rows = [row[:8] for row in table("## 14. Parameters of the Lashloop drive")]
    for row in rows:
        if row[3] == "F32":
            row[4:7] = [shortest(ParameterValue.f32(float(number)).value) for number in row[4:7]]
    # This drive offers one law, so its `controller` has one value.
    assert rows[0][6] == "4"
    rows[0][6] = "1"
    assert described == rows


@pytest.mark.parametrize("index", range(PARAMETER_COUNT))
def test_every_parameter_accepts_exactly_its_range(index: int) -> None:
    bench = DriveUnderTest().idle()
    spec = bench.drive.parameters.specs[index]
    for value in (spec.min, spec.max, spec.default):
        report = bench.only(ParameterReport, SetParameter(index, value))
        assert (report.outcome, report.value) == (Outcome.ACCEPTED, value)
    if spec.default.type is ParameterType.U32:
        low, high = int(spec.min.value) - 1, int(spec.max.value) + 1
        outside = [ParameterValue.u32(it) for it in (low, high) if it >= 0]
        wrong = ParameterValue.f32(1.0)
    else:
        beside = (spec.min.value - 1e-3, spec.max.value * 1.001, math.inf, -math.inf, math.nan)
        outside = [ParameterValue.f32(it) for it in beside]
        wrong = ParameterValue.u32(1)
    for value in outside:
        report = bench.only(ParameterReport, SetParameter(index, value))
        assert (report.outcome, report.value) == (Outcome.OUT_OF_RANGE, spec.default)
    report = bench.only(ParameterReport, SetParameter(index, wrong))
    assert (report.outcome, report.value) == (Outcome.WRONG_TYPE, spec.default)


def test_an_unknown_index_is_rejected_before_any_other_check() -> None:
    bench = DriveUnderTest()
    report = bench.only(ParameterReport, SetParameter(PARAMETER_COUNT, ParameterValue.u32(1)))
    assert (report.outcome, report.value) == (Outcome.UNKNOWN_PARAMETER, ParameterValue.u32(0))


def test_the_identity_has_the_period_and_the_encoders_in_force() -> None:
    bench = DriveUnderTest().idle()
    for name, number in (("period_us", 2000), ("motor_counts_per_rev", 4096), ("load_counts_per_rev", 8192)):
        bench.set(name, ParameterValue.u32(number))
    it = bench.only(Identity, HELLO)
    assert (it.period_us, it.motor_counts_per_rev, it.load_counts_per_rev) == (2000, 4096, 8192)


def test_arming_rejects_inconsistent_parameters_by_name() -> None:
    bench = inconsistent()
    log, result = bench.send(Arm(SESSION))
    assert isinstance(log, Log)
    assert log.text == "motor counts per load count does not go with the others"[:52]
    assert isinstance(result, CommandResult)
    assert (result.outcome, result.state) == (Outcome.INCONSISTENT, State.IDLE)


def test_a_drive_lists_its_laws_and_arms_no_other() -> None:
    laws = [PD, ControlLaw(3, (), lambda _: CascadedPd(DriveUnderTest().drive.parameters))]
    drive = Drive(laws)
    bench = DriveUnderTest()
    bench.drive = drive
    it = bench.only(Identity, HELLO)
    assert [it.controllers.offers(number) for number in range(5)] == [False, True, False, True, False]
    for number, wanted in ((1, Outcome.ACCEPTED), (2, Outcome.INCONSISTENT), (3, Outcome.ACCEPTED)):
        bench.set("controller", ParameterValue.u32(number))
        assert outcome(bench.send(Arm(SESSION))) is wanted
        bench.send(Stop())


def test_a_drive_needs_a_law_and_unique_parameter_names() -> None:
    with pytest.raises(ValueError, match="at least one control law"):
        Drive([])
    other = replace(PD.parameters[2], unit="V")
    with pytest.raises(ValueError, match="two declarations of the parameter k_p1"):
        Drive([PD, ControlLaw(2, (other,), PD.build)])


def test_a_sample_while_not_running_gets_zero_torque() -> None:
    for enter in (ENTER["Idle"], ENTER["Armed"], ENTER["Faulted"]):
        bench = enter()
        wild = EncoderSample(99, 2**23 - 1, -(2**23), math.nan)
        for _ in range(2):
            answer = bench.only(TorqueAnswer, wild)
            assert (answer.sequence, answer.torque_nm, answer.status.flags) == (99, 0.0, 0)
