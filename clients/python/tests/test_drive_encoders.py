"""What a drive makes of encoders that are fast or wrap: section 7 of the specification."""

from __future__ import annotations

import math

import pytest

from lashloop.control import ControlInput, ControlLaw, ControlOutput
from lashloop.counts import wrapped
from lashloop.drive import Drive
from lashloop.messages import (
    Arm,
    CommandResult,
    DriveMessage,
    Log,
)
from lashloop.sequence import of_step
from lashloop.enums import FaultCode, Outcome, ParameterValue, State, single
from running import QUIET, SLOW, fault, place, running_at, torque
from support import SESSION, Bench, sample


@pytest.mark.parametrize("side", ["motor", "load"])
@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("periods", [1, 3])
def test_an_encoder_may_be_as_fast_as_its_limit_and_a_count_more_and_no_faster(
    side: str, way: int, periods: int
) -> None:
    # Both numbers are exact in single precision, so that "exactly the limit" means something.
    counts, per_count_rad_s = 1000 * periods, math.tau / (65_536 * 1e-3)
    limit = single(1000 * per_count_rad_s)
    code = FaultCode.MOTOR_ENCODER_JUMP if side == "motor" else FaultCode.LOAD_ENCODER_JUMP

    def moved(distance: int) -> list[DriveMessage]:
        bench = Bench().running(
            **QUIET,
            **{
                f"{side}_counts_per_rev": ParameterValue.u32(65_536),
                f"{side}_speed_limit_rad_s": ParameterValue.f32(limit),
            },
        )
        bench.say(sample(0))
        return bench.say(sample(periods, **{side: way * distance}))

    assert torque(moved(counts + 1)).status.state is State.RUNNING
    it = fault(moved(counts + periods + 1))
    assert (it.code, it.sequence, it.limit) == (code, periods, limit)
    assert it.value == pytest.approx(1001 * per_count_rad_s, rel=1e-6)


def test_an_encoder_that_wraps_has_not_jumped() -> None:
    bench = running_at()
    for sequence, counts in ((0, 2**23 - 1), (1, -(2**23)), (2, 2**23 - 1)):
        assert torque(bench.say(sample(sequence, motor=counts, load=counts))).status.state is State.RUNNING


@pytest.mark.parametrize(
    ("settings", "longest"),
    [
        ({}, 402),  # 1000 rad/s are 20,861 counts in a millisecond, of 2^23
        ({"motor_speed_limit_rad_s": ParameterValue.f32(500.0)}, 804),
        (SLOW, 1000),
        ({**SLOW, "load_counts_per_rev": ParameterValue.u32(2**24)}, 31),
    ],
)
def test_a_gap_is_no_longer_than_positions_can_be_told_apart(settings: dict[str, ParameterValue], longest: int) -> None:
    bench = Bench().running(**QUIET, **settings)
    bench.say(sample(0))
    assert place(bench, longest + 1) == "stray"
    assert place(bench, longest) == "after a gap"


@pytest.mark.parametrize("side", ["motor", "load"])
def test_encoders_that_no_period_tells_apart_are_refused_when_arming(side: str) -> None:
    bench = Bench().idle()
    bench.set(f"{side}_counts_per_rev", ParameterValue.u32(2**24))
    # 3142 rad/s are half a revolution in a millisecond, and half a revolution is 2^23 counts.
    bench.set(f"{side}_speed_limit_rad_s", ParameterValue.f32(3142.0))
    log, result = bench.say(Arm(SESSION))
    assert isinstance(log, Log)
    assert log.text == f"{side}_speed_limit_rad_s does not go with the others"
    assert isinstance(result, CommandResult)
    assert (result.outcome, result.state) == (Outcome.INCONSISTENT, State.IDLE)
    bench.set(f"{side}_speed_limit_rad_s", ParameterValue.f32(3141.0))
    result = bench.only(CommandResult, Arm(SESSION))
    assert result.outcome is Outcome.ACCEPTED


def test_a_law_is_told_positions_that_go_on_where_readings_wrap() -> None:
    seen: list[tuple[int, int]] = []

    class Listening:
        def step(self, sample: ControlInput) -> ControlOutput:
            seen.append((sample.motor_counts, sample.load_counts))
            return ControlOutput(0.0)

    bench = Bench()
    bench.drive = Drive([ControlLaw(1, (), lambda _: Listening())], clock_ns=bench.clock)
    bench.running(**QUIET)
    stands = [(20_000 * step, -2_000 * step) for step in range(10_000)]
    for step, (motor, load) in enumerate(stands):
        bench.say(sample(of_step(step), motor=wrapped(motor), load=wrapped(load)))
    assert seen == stands
    assert stands[-1][0] > 2**27
    assert stands[-1][1] < -(2**24)
