"""Fast encoders and wraparound: section 7 of the specification."""

from __future__ import annotations

import math

import pytest

from lashloop.control import ControlInput, ControlLaw, ControlOutput
from lashloop.counts import wrapped
from lashloop.enums import FaultCode, Outcome, ParameterValue, State, single
from lashloop.messages import Arm, CommandResult, DriveMessage
from lashloop.sequence import of_step
from running_drive import SLOW, classification, fault, running_at, torque
from support import SESSION, DriveUnderTest, sample


@pytest.mark.parametrize("side", ["motor", "load"])
@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("periods", [1, 3])
def test_the_speed_limit_allows_one_count_more(side: str, way: int, periods: int) -> None:
    # Both numbers are exact in single precision, so that the limit can be met exactly.
    counts, per_count_rad_s = 1000 * periods, math.tau / (65_536 * 1e-3)
    limit = single(1000 * per_count_rad_s)
    code = FaultCode.MOTOR_ENCODER_JUMP if side == "motor" else FaultCode.LOAD_ENCODER_JUMP

    def moved(distance: int) -> list[DriveMessage]:
        dut = DriveUnderTest().running(
            **{
                f"{side}_counts_per_rev": ParameterValue.u32(65_536),
                f"{side}_speed_limit_rad_s": ParameterValue.f32(limit),
            },
        )
        dut.send(sample(0))
        return dut.send(sample(periods, **{side: way * distance}))

    assert torque(moved(counts + 1)).status.state is State.RUNNING
    it = fault(moved(counts + periods + 1))
    assert (it.code, it.sequence, it.limit) == (code, periods, limit)
    assert it.value == pytest.approx(1001 * per_count_rad_s, rel=1e-6)


def test_a_wraparound_of_an_encoder_is_no_jump() -> None:
    dut = running_at()
    for sequence, counts in ((0, 2**23 - 1), (1, -(2**23)), (2, 2**23 - 1)):
        assert torque(dut.send(sample(sequence, motor=counts, load=counts))).status.state is State.RUNNING


@pytest.mark.parametrize(
    ("settings", "longest"),
    [
        ({}, 402),  # 1000 rad/s are 20,861 counts in a millisecond, of 2^23
        ({"motor_speed_limit_rad_s": ParameterValue.f32(500.0)}, 804),
        (SLOW, 1000),
        ({**SLOW, "load_counts_per_rev": ParameterValue.u32(2**24)}, 31),
    ],
)
def test_the_longest_gap_keeps_positions_unambiguous(settings: dict[str, ParameterValue], longest: int) -> None:
    dut = DriveUnderTest().running(**settings)
    dut.send(sample(0))
    assert classification(dut, longest + 1) == "stray"
    assert classification(dut, longest) == "after a gap"


@pytest.mark.parametrize("side", ["motor", "load"])
def test_arming_rejects_an_ambiguous_encoder(side: str) -> None:
    dut = DriveUnderTest().idle()
    dut.set(f"{side}_counts_per_rev", ParameterValue.u32(2**24))
    # 3142 rad/s are half a revolution in a millisecond, and half a revolution is 2^23 counts.
    dut.set(f"{side}_speed_limit_rad_s", ParameterValue.f32(3142.0))
    result = dut.only(CommandResult, Arm(SESSION))
    assert (result.outcome, result.state) == (Outcome.INCONSISTENT, State.IDLE)
    assert result.detail == dut.index(f"{side}_speed_limit_rad_s")
    dut.set(f"{side}_speed_limit_rad_s", ParameterValue.f32(3141.0))
    result = dut.only(CommandResult, Arm(SESSION))
    assert result.outcome is Outcome.ACCEPTED


def test_a_law_gets_positions_without_wraparound() -> None:
    seen: list[tuple[int, int]] = []

    class Listening:
        def step(self, sample: ControlInput) -> ControlOutput:
            seen.append((sample.motor_counts, sample.load_counts))
            return ControlOutput(0.0)

    dut = DriveUnderTest(laws=[ControlLaw(name="listening", build=lambda _: Listening())]).running()
    stands = [(20_000 * step, -2_000 * step) for step in range(10_000)]
    for step, (motor, load) in enumerate(stands):
        dut.send(sample(of_step(step), motor=wrapped(motor), load=wrapped(load)))
    assert seen == stands
    assert stands[-1][0] > 2**27
    assert stands[-1][1] < -(2**24)
