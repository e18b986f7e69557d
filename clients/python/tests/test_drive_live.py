"""Live parameters of a drive: section 9 of the specification."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from lashloop.control import ControlInput, ControlLaw, ControlOutput, InconsistentError, f32
from lashloop.control.cascade import PD
from lashloop.drive.run import UndeclaredError
from lashloop.enums import Outcome, ParameterFlags, ParameterValue, State
from lashloop.messages import (
    Arm,
    CommandResult,
    DescribeParameter,
    GetParameter,
    ParameterDescription,
    ParameterReport,
    SetParameter,
    Stop,
)
from running_drive import torque
from support import SESSION, DriveUnderTest, sample

if TYPE_CHECKING:
    from collections.abc import Mapping

GAINS = ("k_p1", "k_d1", "k_p2", "k_d2", "k_1")


class Bounded:
    """A law whose torque is a live parameter, which must not exceed another one."""

    def __init__(self, parameters: Mapping[str, float]) -> None:
        """Check and take over the parameters."""
        self.blames = "own_nm"
        self.update(parameters)

    def update(self, parameters: Mapping[str, float]) -> None:
        """Take over the torque, unless it exceeds the bound."""
        if parameters["own_nm"] > parameters["bound_nm"]:
            raise InconsistentError(self.blames)
        self._own_nm = parameters["own_nm"]

    def step(self, sample: ControlInput) -> ControlOutput:
        """Return the torque."""
        del sample
        return ControlOutput(self._own_nm)


class Reading:
    """A law that reads the mapping at each step."""

    def __init__(self, parameters: Mapping[str, float]) -> None:
        """Keep the mapping."""
        self._parameters = parameters

    def step(self, sample: ControlInput) -> ControlOutput:
        """Return the torque."""
        del sample
        return ControlOutput(self._parameters["own_nm"])


PARAMETERS = (
    f32("own_nm", "N m", default=1.0, low=0.0, high=10.0, live=True),
    f32("bound_nm", "N m", default=5.0, low=0.0, high=10.0),
)
BOUNDED = ControlLaw(name="bounded", parameters=PARAMETERS, build=Bounded)
READING = ControlLaw(name="reading", parameters=PARAMETERS, build=Reading)


def change(dut: DriveUnderTest, name: str, number: float) -> ParameterReport:
    """Set a real parameter and return the answer."""
    return dut.only(ParameterReport, SetParameter(dut.index(name), ParameterValue.f32(number)))


def flags(dut: DriveUnderTest, name: str) -> ParameterFlags:
    """The flags in the description of a parameter."""
    return dut.only(ParameterDescription, DescribeParameter(dut.index(name))).flags


@pytest.mark.parametrize("law", [BOUNDED, READING], ids=["update", "mapping"])
def test_a_live_value_is_in_force_from_the_next_step(law: ControlLaw) -> None:
    dut = DriveUnderTest(laws=[law]).running()
    assert torque(dut.send(sample(0))).torque_nm == 1.0
    assert change(dut, "own_nm", 2.5).outcome is Outcome.ACCEPTED
    assert torque(dut.send(sample(0))).torque_nm == 1.0
    assert torque(dut.send(sample(1))).torque_nm == 2.5
    report = change(dut, "bound_nm", 1.0)
    assert (report.outcome, report.value, report.state) == (
        Outcome.WRONG_STATE,
        ParameterValue.f32(5.0),
        State.RUNNING,
    )


@pytest.mark.parametrize("law", [BOUNDED, READING], ids=["update", "mapping"])
def test_a_live_value_that_is_set_while_armed_is_that_of_the_first_step(law: ControlLaw) -> None:
    dut = DriveUnderTest(laws=[law]).armed()
    assert change(dut, "own_nm", 2.5).state is State.ARMED
    assert torque(dut.running().send(sample(0))).torque_nm == 2.5


def test_a_live_value_that_contradicts_the_others_leaves_the_old_one_in_force() -> None:
    dut = DriveUnderTest(laws=[BOUNDED]).running()
    dut.send(sample(0))
    report = change(dut, "own_nm", 6.0)
    assert (report.outcome, report.detail) == (Outcome.INCONSISTENT, dut.index("own_nm"))
    assert (report.value, report.state) == (ParameterValue.f32(1.0), State.RUNNING)
    assert dut.only(ParameterReport, GetParameter(dut.index("own_nm"))).value == ParameterValue.f32(1.0)
    assert torque(dut.send(sample(1))).torque_nm == 1.0
    assert change(dut, "own_nm", 5.0).outcome is Outcome.ACCEPTED
    assert torque(dut.send(sample(2))).torque_nm == 5.0


def test_a_live_value_out_of_its_range_is_refused_before_the_law_sees_it() -> None:
    dut = DriveUnderTest(laws=[BOUNDED]).running()
    report = change(dut, "own_nm", 10.5)
    assert (report.outcome, report.detail, report.value) == (Outcome.OUT_OF_RANGE, 0, ParameterValue.f32(1.0))


def test_contradictory_values_are_refused_at_arming_with_the_index() -> None:
    dut = DriveUnderTest(laws=[BOUNDED]).idle()
    assert change(dut, "own_nm", 6.0).outcome is Outcome.ACCEPTED
    result = dut.only(CommandResult, Arm(SESSION))
    assert (result.outcome, result.detail, result.state) == (
        Outcome.INCONSISTENT,
        dut.index("own_nm"),
        State.IDLE,
    )


@pytest.mark.parametrize("blamed", ["own", "the torque"])
def test_a_law_that_blames_no_parameter_is_an_error_by_name(blamed: str) -> None:
    def build(parameters: Mapping[str, float]) -> Bounded:
        law = Bounded(parameters)
        law.blames = blamed
        return law

    dut = DriveUnderTest(laws=[replace(BOUNDED, build=build)]).running()
    with pytest.raises(UndeclaredError, match=f"the law bounded calls {blamed} inconsistent, which isn't a parameter"):
        change(dut, "own_nm", 6.0)


def test_the_gains_of_pd_and_no_other_parameters_are_live() -> None:
    dut = DriveUnderTest()
    assert [it.name for it in dut.drive.parameters.specs if ParameterFlags.LIVE in flags(dut, it.name)] == list(GAINS)


def test_the_gains_of_pd_change_the_torque_of_the_next_step() -> None:
    for gain in GAINS:
        changed, same = DriveUnderTest().running(), DriveUnderTest().running()
        for sequence in range(4):
            # Both move, so that every gain has an effect.
            it = sample(sequence, motor=40 * sequence, load=10 * sequence)
            torques_nm = [torque(dut.send(it)).torque_nm for dut in (changed, same)]
            assert (torques_nm[0] == torques_nm[1]) == (sequence < 2), gain
            if sequence == 1:
                assert change(changed, gain, 0.125).outcome is Outcome.ACCEPTED


def test_a_shared_parameter_is_live_only_if_every_law_takes_it_live() -> None:
    fixed = replace(READING, name="fixed", parameters=(replace(PARAMETERS[0], live=False),))
    dut = DriveUnderTest(laws=[BOUNDED, READING]).running()
    assert flags(dut, "own_nm") == ParameterFlags.LIVE
    dut = DriveUnderTest(laws=[BOUNDED, READING, fixed]).running()
    assert flags(dut, "own_nm") == ParameterFlags(0)
    assert change(dut, "own_nm", 2.0).outcome is Outcome.WRONG_STATE


def test_a_live_parameter_of_another_law_is_set_too() -> None:
    dut = DriveUnderTest(laws=[PD, BOUNDED]).running()
    assert change(dut, "own_nm", 6.0).outcome is Outcome.ACCEPTED
    dut.send(Stop())
    dut.set("controller", ParameterValue.u32(1))
    assert dut.only(CommandResult, Arm(SESSION)).outcome is Outcome.INCONSISTENT
