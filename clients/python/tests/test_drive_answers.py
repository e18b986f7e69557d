"""The answers of a drive and their order, against the table of the specification."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from lashloop.control import ControlLaw, signal
from lashloop.control.cascade import PD
from lashloop.enums import Outcome, ParameterValue, State
from lashloop.frames import encode
from lashloop.messages import (
    Arm,
    ClearFault,
    CommandResult,
    DescribeChoice,
    DescribeLaw,
    DescribeParameter,
    DescribeSignal,
    EmergencyStop,
    GetParameter,
    Hello,
    HostMessage,
    Reset,
    SetParameter,
    Start,
    Stop,
    StoreParameters,
    Subscribe,
)
from running_drive import ENTER, faulted
from support import PARAMETER_COUNT, SESSION, DriveUnderTest, sample, table

if TYPE_CHECKING:
    from collections.abc import Callable

OTHER = SESSION ^ 1
ORDER_OF_ANSWERS = "### Answers"
HELLO = Hello.of(SESSION)
TWO = (PD, ControlLaw(name="other", signals=(signal("other", ""),), build=PD.build))
FOREIGN = 1 + len(PD.signals)
"""Index of the signal of the second law, which `pd` lacks."""


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
    ("Hello", "another version"): [(DriveUnderTest, Hello(2, 0, SESSION))],
    ("Hello", "another version, fault latched"): [(faulted, Hello(2, 0, SESSION))],
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
    ("Subscribe", "any"): [
        *((enter, Subscribe(1, 10)) for enter in ENTER.values()),
        (DriveUnderTest().running, Subscribe(1 << 31, 10)),
        (lambda: DriveUnderTest(laws=TWO).armed(), Subscribe(1 << FOREIGN, 10)),
        (lambda: DriveUnderTest(laws=TWO).running(), Subscribe(1 << FOREIGN, 0)),
    ],
    ("Arm", "any"): [
        (DriveUnderTest().idle, Arm(SESSION)),
        (DriveUnderTest().armed, Arm(SESSION)),
        (DriveUnderTest().idle, Arm(OTHER)),
        (inconsistent, Arm(SESSION)),
        (foreign_signal, Arm(SESSION)),
    ],
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
    # Those of bench mode, of the boot loader, and from 0x20 on are optional.
    is_optional = row[1] in {"Reference", "EnterLoader"} or int(row[0], 16) >= StoreParameters.KIND
    if row[2] == "host" and not is_optional:
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


def test_arming_rejects_inconsistent_parameters_with_the_index_of_one() -> None:
    dut = inconsistent()
    result = dut.only(CommandResult, Arm(SESSION))
    assert (result.outcome, result.state) == (Outcome.INCONSISTENT, State.IDLE)
    assert result.detail == dut.index("reduction_ratio")
