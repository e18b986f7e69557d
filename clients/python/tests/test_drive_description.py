"""What a drive describes of itself, and the telemetry a host subscribes to."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from lashloop import limits
from lashloop.control import ControlInput, ControlLaw, ControlOutput, choice, f32, signal, u32
from lashloop.control.cascade import PD
from lashloop.drive import Drive
from lashloop.drive.run import SignalsError
from lashloop.enums import Outcome, ParameterFlags, ParameterValue, State, single
from lashloop.errors import FieldError
from lashloop.messages import (
    Arm,
    ChoiceDescription,
    ClearFault,
    CommandResult,
    DescribeChoice,
    DescribeLaw,
    DescribeParameter,
    DescribeSignal,
    EmergencyStop,
    Hello,
    Identity,
    LawDescription,
    ParameterDescription,
    Reset,
    SignalDescription,
    Start,
    Stop,
    Subscribe,
    Telemetry,
)
from support import SESSION, DriveUnderTest, sample, table

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


class Ramp:
    """A law whose torque is a gain times the number of the step, which is also a signal."""

    def __init__(self, parameters: Mapping[str, float]) -> None:
        """Keep the parameters, because the gain is live."""
        self._parameters = parameters
        self._step = 0

    def step(self, sample: ControlInput) -> ControlOutput:
        """Return torque and signals."""
        del sample
        self._step += 1
        torque_nm = self._parameters["ramp_nm"] * self._step
        return ControlOutput(torque_nm, {"ramp_step": float(self._step), "load_error_rad": -0.5})


RAMP = ControlLaw(
    name="ramp",
    parameters=(
        f32("ramp_nm", "N m", default=0.25, low=0.0, high=5.0, live=True),
        choice("direction", ["up", "down", "both"], default="both"),
        f32("k_p1", "N m/rad", 1.0, 0.0, 1e6),
    ),
    signals=(signal("ramp_step", ""), signal("load_error_rad", "rad")),
    build=Ramp,
)
BOTH = (PD, RAMP)
# Signal 0 is that of the drive; those of `pd` and then those of `ramp` follow. `load_error_rad` belongs to both laws.
COUNT = 1 + len(PD.signals) + 1
OF_DRIVE, OF_PD, OF_RAMP = 0, 1, COUNT - 1
OF_BOTH = 1 + [it.name for it in PD.signals].index("load_error_rad")


def ramp() -> DriveUnderTest:
    """An idle drive with both laws and `ramp` in force."""
    dut = DriveUnderTest(laws=BOTH).idle()
    dut.set("controller", ParameterValue.u32(1))
    return dut


def started(dut: DriveUnderTest) -> DriveUnderTest:
    """The drive in a run."""
    dut.send(Arm(SESSION))
    dut.send(Start(SESSION))
    assert dut.drive.state is State.RUNNING
    return dut


def test_the_identity_counts_what_the_drive_describes() -> None:
    dut = DriveUnderTest(laws=BOTH)
    identity = dut.only(Identity, Hello.of(SESSION))
    assert (identity.law_count, identity.signal_count) == (2, COUNT)
    assert identity.parameter_count == len(dut.drive.parameters)
    for request in (
        DescribeLaw(identity.law_count),
        DescribeSignal(identity.signal_count),
        DescribeChoice(identity.parameter_count, 0),
    ):
        assert dut.only(CommandResult, request).outcome is Outcome.UNKNOWN_INDEX


def test_laws_are_described_in_their_order_and_are_the_choices_of_controller() -> None:
    dut = DriveUnderTest(laws=BOTH)
    controller = dut.only(ParameterDescription, DescribeParameter(dut.index("controller")))
    assert controller.flags == ParameterFlags.CHOICES
    assert [it.value for it in (controller.default, controller.min, controller.max)] == [0, 0, 1]
    for index, law in enumerate(BOTH):
        assert dut.only(LawDescription, DescribeLaw(index)).name == law.name
        assert dut.only(ChoiceDescription, DescribeChoice(controller.index, index)).name == law.name


def test_parameters_have_the_bits_of_their_laws() -> None:
    dut = DriveUnderTest(laws=BOTH)
    expected = {"controller": 0b11, "torque_limit_nm": 0b11, "k_d1": 0b01, "k_p1": 0b11, "ramp_nm": 0b10}
    for name, laws in expected.items():
        assert dut.only(ParameterDescription, DescribeParameter(dut.index(name))).laws == laws, name


def test_signals_have_the_bits_of_their_laws() -> None:
    dut = DriveUnderTest(laws=BOTH)
    described = [dut.only(SignalDescription, DescribeSignal(index)) for index in range(COUNT)]
    assert described[OF_DRIVE] == SignalDescription(OF_DRIVE, 0b11, "requested_torque_nm", "N m")
    assert described[OF_PD] == SignalDescription(OF_PD, 0b01, "measured_motor_velocity_rad_s", "rad/s")
    assert described[OF_BOTH] == SignalDescription(OF_BOTH, 0b11, "load_error_rad", "rad")
    assert described[OF_RAMP] == SignalDescription(OF_RAMP, 0b10, "ramp_step", "")


def test_choices_are_described_by_value() -> None:
    dut = DriveUnderTest(laws=BOTH)
    index = dut.index("direction")
    it = dut.only(ParameterDescription, DescribeParameter(index))
    assert (it.default, it.max) == (ParameterValue.u32(2), ParameterValue.u32(2))
    names = [dut.only(ChoiceDescription, DescribeChoice(index, value)).name for value in range(3)]
    assert names == ["up", "down", "both"]
    assert dut.only(CommandResult, DescribeChoice(index, 3)).outcome is Outcome.UNKNOWN_INDEX


def test_telemetry_has_the_subscribed_signals_in_the_order_of_their_indices() -> None:
    dut = ramp()
    assert dut.send(sample(0))[1:] == []
    dut.subscribe(OF_RAMP, OF_DRIVE)
    started(dut)
    assert [dut.send(sample(it))[-1] for it in range(3)] == [
        Telemetry(0, (0.25, 1.0)),
        Telemetry(1, (0.5, 2.0)),
        Telemetry(2, (0.75, 3.0)),
    ]


def test_telemetry_follows_every_n_th_sequence_and_can_be_changed_while_running() -> None:
    dut = DriveUnderTest().running()
    assert [len(dut.send(sample(it))) for it in range(3)] == [1, 1, 1]
    dut.subscribe(0, every=3)
    assert [len(dut.send(sample(it))) for it in range(3, 10)] == [2, 1, 1, 2, 1, 1, 2]
    dut.subscribe(0, every=0)
    assert [len(dut.send(sample(it))) for it in range(10, 14)] == [1] * 4
    dut.subscribe(0, every=1)
    assert [len(dut.send(sample(it))) for it in range(14, 17)] == [2] * 3
    dut.subscribe(every=1)
    assert [len(dut.send(sample(it))) for it in range(17, 20)] == [1] * 3


def test_a_subscription_is_kept_until_a_reset() -> None:
    dut = DriveUnderTest().running()
    dut.subscribe(0)
    dut.send(EmergencyStop())
    dut.send(ClearFault())
    dut.send(Hello.of(SESSION + 1))
    dut.send(Hello.of(SESSION))
    assert len(started(dut).send(sample(0))) == 2
    dut.send(Reset())
    started(dut.idle())
    assert len(dut.send(sample(0))) == 1


MANY = ControlLaw(name="many", signals=tuple(signal(f"s{it}", "") for it in range(20)), build=PD.build)
ENTER: dict[str, Callable[[DriveUnderTest], object]] = {
    "Boot": lambda dut: dut,
    "Idle": lambda dut: dut.idle(),
    "Armed": lambda dut: dut.armed(),
    "Running": lambda dut: dut.running(),
    "Faulted": lambda dut: dut.idle().send(EmergencyStop()),
}
# Signals of `MANY` are those of the drive and 1 to 20; `pd` has those of the drive and the ones from 21 on.
SIGNALS_OF_CASE: dict[str, list[tuple[int, ...]]] = {
    "a bit without a signal": [(31,), tuple(range(14, 32))],
    "more than 13 signals": [tuple(range(14))],
    "a signal that the law in force lacks": [(0, 21)],
    "any other": [(), (0,), tuple(range(1, 14))],
    "any": [(), (0,), (31,), tuple(range(14)), (21,)],
}


@pytest.mark.parametrize(
    ("case", "states", "wanted"),
    table("[R11.8]"),
)
def test_a_subscription_is_checked_as_specified(case: str, states: str, wanted: str) -> None:
    for state in states.split(", "):
        for signals in SIGNALS_OF_CASE[case]:
            for every in (0, 1):
                dut = DriveUnderTest(laws=[MANY, PD])
                ENTER[state](dut)
                result = dut.only(CommandResult, Subscribe(sum(1 << it for it in signals), every))
                assert (result.outcome.label, result.state.label) == (wanted, state), (signals, every)


def test_a_refused_subscription_keeps_the_one_before_it() -> None:
    dut = DriveUnderTest(laws=BOTH).running()
    dut.subscribe(OF_DRIVE)
    for refused in (COUNT, OF_RAMP):
        assert dut.subscribe(refused) in (Outcome.UNKNOWN_INDEX, Outcome.SIGNAL_OF_OTHER_LAW)
    telemetry = dut.send(sample(0))[-1]
    assert isinstance(telemetry, Telemetry)
    assert len(telemetry.values) == 1


def test_a_signal_of_another_law_is_refused_while_armed_and_running() -> None:
    armed = DriveUnderTest(laws=BOTH).armed()
    running = DriveUnderTest(laws=BOTH).running()
    for dut in (armed, running):
        result = dut.only(CommandResult, Subscribe(1 << OF_DRIVE | 1 << OF_RAMP, 1))
        assert (result.outcome, result.detail) == (Outcome.SIGNAL_OF_OTHER_LAW, OF_RAMP)
        assert dut.subscribe(OF_BOTH) is Outcome.ACCEPTED


def test_arming_refuses_a_signal_of_another_law_by_index_unless_there_is_no_telemetry() -> None:
    dut = DriveUnderTest(laws=BOTH).idle()
    assert dut.subscribe(OF_RAMP) is Outcome.ACCEPTED
    result = dut.only(CommandResult, Arm(SESSION))
    assert (result.outcome, result.detail, result.state) == (Outcome.SIGNAL_OF_OTHER_LAW, OF_RAMP, State.IDLE)
    dut.set("controller", ParameterValue.u32(1))
    assert dut.only(CommandResult, Arm(SESSION)).outcome is Outcome.ACCEPTED
    dut.send(Stop())
    dut.set("controller", ParameterValue.u32(0))
    assert dut.subscribe(OF_RAMP, every=0) is Outcome.ACCEPTED
    assert dut.only(CommandResult, Arm(SESSION)).outcome is Outcome.ACCEPTED
    assert dut.subscribe(OF_RAMP, every=0) is Outcome.SIGNAL_OF_OTHER_LAW


def test_the_law_in_force_is_the_one_at_arming() -> None:
    dut = ramp()
    started(dut)
    assert dut.send(sample(0))
    assert dut.drive.torque_nm == single(0.25)
    dut.send(Stop())
    dut.set("controller", ParameterValue.u32(0))
    started(dut)
    dut.send(sample(0))
    assert abs(dut.drive.torque_nm) == pytest.approx(13.0, abs=0.01)


@pytest.mark.parametrize("given", [{}, {"ramp_step": 1.0}, {"ramp_step": 1.0, "load_error_rad": 0.0, "more": 0.0}])
def test_a_law_with_other_signals_than_declared_is_an_error_by_name(given: dict[str, float]) -> None:
    class Wrong:
        def step(self, sample: ControlInput) -> ControlOutput:
            del sample
            return ControlOutput(0.0, given)

    dut = DriveUnderTest(laws=[replace(RAMP, build=lambda _: Wrong())]).running()
    names = ", ".join(sorted(given)) or "no signal"
    with pytest.raises(SignalsError, match=f"law ramp gave {names}; it declares load_error_rad, ramp_step"):
        dut.send(sample(0))


def law(**fields: Any) -> ControlLaw:
    """The law `ramp` with other fields."""
    return replace(RAMP, **fields)


@pytest.mark.parametrize(
    ("laws", "expected"),
    [
        ([], "the laws none: a drive has 1 to 16"),
        ([RAMP, RAMP], "the laws ramp, ramp: a drive has 1 to 16, of different names"),
        ([law(name=f"law-{number}") for number in range(17)], "law-16: a drive has 1 to 16"),
        ([PD, law(parameters=(f32("k_p1", "V", 1.0, 0.0, 1e6),))], "two declarations of k_p1 differ"),
        ([PD, law(signals=(signal("load_error_rad", "mrad"),))], "two declarations of load_error_rad differ"),
        ([law(signals=tuple(signal(f"s{it}", "") for it in range(32)))], "33 entries, from requested_torque_nm on"),
        ([law(parameters=tuple(u32(f"p{it}", "", 0, 0, 1) for it in range(233)))], "241 entries, from controller on"),
    ],
)
def test_laws_that_a_drive_can_not_describe_are_named(laws: list[ControlLaw], expected: str) -> None:
    with pytest.raises(ValueError, match=expected):
        Drive(laws)


@pytest.mark.parametrize(
    ("broken", "expected"),
    [
        (law(name="a" * 29), "LawDescription.name is 'aaa"),
        (law(parameters=(u32("p" * 28, "", 0, 0, 1),)), "ParameterDescription.name is 'ppp"),
        (law(parameters=(u32("p", "furlongs/fortnight", 0, 0, 1),)), "ParameterDescription.unit is 'furlongs"),
        (law(signals=(signal("s" * 33, ""),)), "SignalDescription.name is 'sss"),
        (law(parameters=(choice("c", ["a" * 29], "a" * 29),)), "ChoiceDescription.name is 'aaa"),
    ],
)
def test_a_name_that_does_not_fit_its_field_is_an_error_at_once(broken: ControlLaw, expected: str) -> None:
    with pytest.raises(FieldError, match=expected):
        Drive([broken])


def test_the_range_of_a_parameter_is_finite() -> None:
    for default, low, high in ((0.0, -math.inf, 1.0), (0.0, 0.0, 1e39), (math.nan, 0.0, 1.0)):
        with pytest.raises(ValueError, match=re.escape(f"gain: {low} to {high} with the default {default}; all ")):
            f32("gain", "", default, low, high)


def test_the_drive_names_the_values_of_its_lists_and_no_others() -> None:
    dut = DriveUnderTest()
    lists: dict[int, dict[int, str]] = {
        limits.FAULT_NAMES: {int(row[0]): row[1] for row in table("### FaultCode")},
        limits.OUTCOME_NAMES: {int(row[0]): row[1] for row in table("### Outcome")},
        limits.STATE_NAMES: {int(row[0]): row[1] for row in table("### State")},
        limits.FLAG_NAMES: {int(row[0], 16): row[1] for row in table("### TorqueFlags")},
        limits.KIND_NAMES: {int(row[0], 16): row[1] for row in table("## 4. Messages")},
    }
    for number, names in lists.items():
        for value in range(256):
            (answer,) = dut.send(DescribeChoice(number, value))
            if value in names:
                assert answer == ChoiceDescription(number, value, names[value])
            else:
                assert isinstance(answer, CommandResult)
                assert answer.outcome is Outcome.UNKNOWN_INDEX


def test_choices_are_different_and_have_the_default_among_them() -> None:
    for names, default in (([], "a"), (["a", "a"], "a"), (["a"], "b"), ([f"c{it}" for it in range(257)], "c0")):
        with pytest.raises(ValueError, match="a parameter has 1 to 256 different choices"):
            choice("mode", names, default)


def test_the_longest_names_fit_into_a_frame() -> None:
    longest = ControlLaw(
        name="l" * 28,
        parameters=(choice("p" * 27, ["c" * 28], "c" * 28), f32("q" * 27, "u" * 10, 0.0, 0.0, 1.0)),
        signals=(signal("s" * 32, "u" * 10),),
        build=PD.build,
    )
    dut = DriveUnderTest(laws=[longest])
    assert dut.only(ParameterDescription, DescribeParameter(dut.index("q" * 27))).unit == "u" * 10
    assert dut.only(ChoiceDescription, DescribeChoice(dut.index("p" * 27), 0)).name == "c" * 28
    assert dut.only(SignalDescription, DescribeSignal(1)).name == "s" * 32
    assert dut.only(CommandResult, Subscribe(0b11, 1)).outcome is Outcome.WRONG_STATE
