"""The cascaded PD law: closed form, single precision, and the specification's example byte for byte."""

from __future__ import annotations

import contextlib
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lashloop.control import ControlInput, InconsistentError
from lashloop.control.cascade import PD, CascadedPd
from lashloop.control.sensing import Sensing
from lashloop.counts import wrapped, wrapping_difference
from lashloop.drive import Parameters
from lashloop.drive.description import DRIVE_SIGNALS
from lashloop.drive.parameters import DRIVE_PARAMETERS
from lashloop.enums import single
from lashloop.frames import FROM_DRIVE, FROM_HOST, UnknownKindError, decode, encode
from lashloop.sequence import nearest_step, of_step
from specified_drive import PARAMETERS, SIGNALS, Translation, has, parameter, signal_spec, specified_drive
from support import Clock, document

DEFAULTS = dict(Parameters([*DRIVE_PARAMETERS, *PD.parameters]))
COUNT_RAD = math.tau / 131_072


def at(motor: int, load: int, reference_rad: float = 0.0, periods: int = 1) -> ControlInput:
    """A sample."""
    return ControlInput(motor, load, reference_rad, 0.0, periods)


@given(st.integers(-(10**6), 10**6), st.integers(-(10**6), 10**6), st.floats(-100.0, 100.0, width=32))
def test_the_first_torque_is_the_closed_form_of_the_law(motor: int, load: int, reference_rad: float) -> None:
    # At the first sample all rates are zero: -k1 K z - K_P1 (theta_e - (N0 r - K_P2 (theta_s - r))).
    theta_e, theta_s = (motor + 0.5) * COUNT_RAD, (load + 0.5) * COUNT_RAD
    twist = theta_e - 3.0 * theta_s
    motor_error = theta_e - (3.0 * reference_rad - 10.0 * (theta_s - reference_rad))
    have = CascadedPd(DEFAULTS).step(at(motor, load, reference_rad))
    scale = abs(theta_e) + 13 * abs(theta_s) + 13 * abs(reference_rad) + 1.0
    assert have.torque_nm == pytest.approx(-twist - motor_error, abs=4e-7 * scale)
    assert have.signals["load_error_rad"] == pytest.approx(theta_s - reference_rad, abs=4e-7 * scale)
    assert have.signals["motor_error_rad"] == pytest.approx(motor_error, abs=4e-7 * scale)
    assert have.signals["elastic_error_nm"] == pytest.approx(twist, abs=4e-7 * scale)
    assert have.signals["dead_zone_estimate_rad"] == single(0.16)


def test_velocities_follow_a_step_with_the_exact_lag() -> None:
    sensing = Sensing(DEFAULTS)
    sensing.step(at(0, 0))
    for step in range(1, 11):
        it = sensing.step(at(10 * step, 0))
    # 10 ms at 400 rad/s are four time constants.
    wanted = 10 * COUNT_RAD / 1e-3 * (1 - math.exp(-4.0))
    assert float(it.motor_velocity_rad_s) == pytest.approx(wanted, rel=1e-5)


def test_the_rate_terms_are_those_of_the_law() -> None:
    law, sensing = CascadedPd(DEFAULTS), Sensing(DEFAULTS)
    for step in range(5):
        sample = at(30 * step, 10 * step, 1e-3 * step * step)
        have, it = law.step(sample), sensing.step(sample)
    velocity, acceleration = float(it.reference_velocity_rad_s), float(it.reference_acceleration_rad_s2)
    assert velocity == pytest.approx(7.0, rel=1e-3)
    assert acceleration == pytest.approx(2000.0, rel=1e-2)
    load_rate = float(it.load_velocity_rad_s) - velocity
    motor_error = float(it.motor_position_rad) - (
        3 * 0.016 - 10 * load_rate - 10 * (float(it.load_position_rad) - 0.016)
    )
    elastic_error = float(it.twist_rad) - (7.5 / 3 * acceleration + 16 / 3 * velocity)
    feed_forward = (9.72e-4 * 3 + 7.5 / 3) * acceleration + (4.3e-4 * 3 + 16 / 3) * velocity
    rate = float(it.motor_velocity_rad_s) - 3 * velocity
    assert have.torque_nm == pytest.approx(feed_forward - elastic_error - 0.01 * rate - motor_error, rel=1e-5)


def test_a_jump_of_the_reference_has_no_velocity() -> None:
    sensing = Sensing(DEFAULTS)
    rates = []
    for reference_rad in (0.0, 1.0, 1.01, 1.02, 1.03):
        it = sensing.step(at(0, 0, reference_rad))
        rates.append((round(float(it.reference_velocity_rad_s)), round(float(it.reference_acceleration_rad_s2))))
    assert rates == [(0, 0), (0, 0), (10, 0), (10, 0), (10, 0)]


def test_velocity_and_twist_are_exact_at_1000_rad() -> None:
    fine = DEFAULTS | {"motor_counts_per_rev": 2**20, "load_counts_per_rev": 2**20, "motor_filter_rad_s": 1e6}
    sensing = Sensing(fine | {"load_filter_rad_s": 1e6})
    load = 166_886_053
    sensing.step(at(3 * load + 6, load))
    it = sensing.step(at(3 * (load + 3) + 6, load + 3))
    count = math.tau / 2**20
    assert float(it.load_velocity_rad_s) == pytest.approx(3 * count / 1e-3, rel=1e-6)
    # Middles of counts: (n_e + 1/2) - 3 (n_s + 1/2) = 6 - 1.
    assert float(it.twist_rad) == pytest.approx(5 * count, rel=1e-6)


def test_positions_beyond_24_bits_keep_their_velocity() -> None:
    sensing = Sensing(DEFAULTS)
    sensing.step(at(2**31 - 2, 0))
    it = sensing.step(at(2**31 + 1, 0))
    assert float(it.motor_position_rad) == pytest.approx((2**31 + 1.5) * COUNT_RAD, rel=1e-7)
    assert float(it.motor_velocity_rad_s) == pytest.approx(3 * COUNT_RAD / 1e-3 * (1 - math.exp(-0.4)), rel=1e-5)


def test_everything_is_computed_in_single_precision() -> None:
    law = CascadedPd(DEFAULTS)
    for step in range(10):
        it = law.step(at(30 * step, 10 * step, 0.001 * step))
        for number in (it.torque_nm, *it.signals.values()):
            assert number == float(np.float32(number))


def test_resolutions_that_differ_too_much_are_named() -> None:
    far = {"motor_counts_per_rev": 2**24, "load_counts_per_rev": 4, "reduction_ratio": 10.0}
    with pytest.raises(InconsistentError, match="reduction_ratio does not go with the other parameters"):
        PD.build(DEFAULTS | far)


def test_gains_change_within_a_run_and_nothing_else_does() -> None:
    gains = {"k_p1": 2.0, "k_d1": 0.02, "k_p2": 5.0, "k_d2": 3.0, "k_1": 0.5}
    changed, before, after = CascadedPd(DEFAULTS), CascadedPd(DEFAULTS), CascadedPd(DEFAULTS | gains)
    for step in range(6):
        if step == 3:
            changed.update(DEFAULTS | gains | {"stiffness_nm_rad": 9.0})
        sample = at(30 * step, 10 * step, 1e-3 * step)
        torques_nm = [law.step(sample).torque_nm for law in (changed, before, after)]
        assert torques_nm[0] == torques_nm[1 if step < 3 else 2]
        assert torques_nm[1] != torques_nm[2]


@given(st.integers(-(2**23), 2**23 - 1), st.integers(-(2**23) + 1, 2**23 - 1))
def test_the_difference_of_two_readings_is_the_travel(before: int, moved: int) -> None:
    assert wrapping_difference(wrapped(before + moved), before) == moved


@given(st.integers(0, 2**40), st.integers(-(2**15), 2**15 - 1))
def test_a_step_is_recovered_from_its_sequence(step: int, ahead: int) -> None:
    meant = step + ahead
    assert nearest_step(of_step(meant), step) == (meant if meant >= 0 else None)


def test_the_law_has_parameters_and_signals_of_the_specification() -> None:
    ours = {spec.name: spec for spec in (*DRIVE_PARAMETERS, *PD.parameters)}
    theirs = {row[1]: parameter(row) for row in PARAMETERS if has("pd", row[7]) and row[1] != "controller"}
    assert ours == theirs
    signals = [signal_spec(row) for row in SIGNALS if has("pd", row[3])]
    assert [*DRIVE_SIGNALS, *PD.signals] == signals


def test_the_specification_s_example_is_reproduced_byte_for_byte() -> None:
    shown = [bytes.fromhex(line[7:]) for line in document().splitlines() if line.startswith("frame: ")]
    # The first reading is 0.
    drive = specified_drive(Clock(now_ns=-5_700, step_ns=5_700))
    translation = Translation(drive)
    assert drive.receive(b"\0") == b""
    answers: list[bytes] = []
    requests = 0
    for frame in shown:
        if frame[1] < 0x80:
            requests += 1
            assert answers == [], f"before request {requests}"
            ours = frame
            # The example of an unknown request is sent as it is.
            with contextlib.suppress(UnknownKindError):
                request = decode(frame, FROM_HOST)
                ours = encode(translation.request(request.message), request.number)
            sent = drive.receive(ours)
            items = [decode(it, FROM_DRIVE) for it in sent.split(b"\0")[:-1]]
            answers = [encode(translation.answer(it.message), it.number) for it in items]
        else:
            assert answers.pop(0) == frame
    assert answers == []
    assert requests >= 8
