"""Samples and torques: section 7 of the specification."""

from __future__ import annotations

import math

import pytest

from lashloop.control import ControlInput, ControlLaw, ControlOutput, signal
from lashloop.enums import FaultCode, ParameterValue, TorqueFlags
from lashloop.frames import encode
from lashloop.messages import (
    EncoderSample,
    LineReport,
    Stop,
    Telemetry,
    TorqueAnswer,
)
from running_drive import SLOW, classification, fault, running_at, torque
from support import DriveUnderTest, sample, sealed, table

LAST = 2**16 - 2  # so that what follows wraps


def at_last() -> DriveUnderTest:
    """A running drive whose last sequence is `LAST`, reached by gaps to save time."""
    dut = DriveUnderTest()
    dut.running(**SLOW)
    for sequence in (*range(0, LAST - 1, 999), LAST - 1):
        assert classification(dut, sequence) == ("after a gap" if sequence else "taken")
    assert classification(dut, LAST) == "taken"
    return dut


@pytest.mark.parametrize(
    ("sequence", "is_"),
    [
        (LAST + 1, "taken"),
        (0, "after a gap"),
        ((LAST + 1000) % 2**16, "after a gap"),
        ((LAST + 1001) % 2**16, "stray"),
        (LAST, "repeated"),
        (LAST - 1, "stray"),
        ((LAST + 2**15) % 2**16, "stray"),
    ],
)
def test_a_sample_is_classified_by_its_sequence_modulo_2_16(sequence: int, is_: str) -> None:
    assert classification(at_last(), sequence) == is_


def test_the_tests_cover_the_table_of_sequences() -> None:
    rows = [row[:2] for row in table("## 7. Samples and torques")]
    assert rows == [
        ["0, none taken yet", "first"],
        ["last + 1", "next"],
        ["last + 2 to last + 1000", "after a gap"],
        ["last", "repeated"],
        ["any other", "stray"],
    ]


@pytest.mark.parametrize("sequence", [1, 5, 1000, 2**16 - 1])
def test_only_sequence_0_starts_a_run(sequence: int) -> None:
    dut = running_at()
    assert classification(dut, sequence) == "stray"
    assert classification(dut, 0) == "taken"


def test_a_repeated_sample_gets_the_same_answer_without_a_step() -> None:
    disturbed, quiet = running_at(), running_at()
    for sequence in range(20):
        it = sample(sequence, motor=3 * sequence, load=sequence)
        first = torque(disturbed.send(it))
        again = torque(disturbed.send(EncoderSample(sequence, 999, -999, math.nan)))
        assert again.torque_nm == first.torque_nm
        assert again.status.flags == first.status.flags | TorqueFlags.REPEATED
        assert first.torque_nm == torque(quiet.send(it)).torque_nm


def test_a_stray_sample_makes_no_step() -> None:
    disturbed, quiet = running_at(), running_at()
    for sequence in range(20):
        it = sample(sequence, motor=3 * sequence, load=sequence)
        assert torque(disturbed.send(it)).torque_nm == torque(quiet.send(it)).torque_nm
        assert classification(disturbed, (sequence + 2**15) % 2**16) == "stray"


def test_a_gap_is_flagged_once_and_velocities_span_it() -> None:
    every, gappy = running_at(), running_at()
    for sequence in range(61):
        it = sample(sequence, motor=12 * sequence, load=4 * sequence)
        wanted = torque(every.send(it))
        if sequence % 3 == 0:
            have = torque(gappy.send(it))
            assert (TorqueFlags.GAP in have.status.flags) == (sequence > 0)
            assert have.torque_nm == pytest.approx(wanted.torque_nm, rel=1e-5)


def test_the_torque_is_clamped_to_the_limit_and_flagged() -> None:
    free_nm = torque(DriveUnderTest().running().send(sample(0))).torque_nm
    assert abs(free_nm) == pytest.approx(13.0, abs=0.01)
    for limit_nm, wanted_nm, flags in ((5.0, 5.0, TorqueFlags.SATURATED), (20.0, free_nm, TorqueFlags(0))):
        dut = DriveUnderTest().running(torque_limit_nm=ParameterValue.f32(limit_nm))
        dut.subscribe(0)
        answer, telemetry = dut.send(sample(0))
        assert isinstance(answer, TorqueAnswer)
        assert (answer.torque_nm, answer.status.flags) == (math.copysign(wanted_nm, free_nm), flags)
        # Signal 0 is the torque before the limit.
        assert telemetry == Telemetry(0, (free_nm,))
        assert dut.drive.torque_nm == answer.torque_nm


@pytest.mark.parametrize("reference_rad", [math.nan, math.inf, -math.inf])
def test_a_reference_that_is_not_finite_is_a_fault(reference_rad: float) -> None:
    it = fault(running_at(0, 1).send(sample(2, reference_rad=reference_rad)))
    assert (it.code, it.sequence, it.limit) == (FaultCode.REFERENCE_NOT_FINITE, 2, 0.0)
    assert str(it.value) == str(reference_rad)


class Wild:
    """A law whose torque is given by the test."""

    wants_nm = 0.0

    def step(self, sample: ControlInput) -> ControlOutput:
        """Return the torque."""
        del sample
        return ControlOutput(self.wants_nm, {"load_error_rad": 1e300})


@pytest.mark.parametrize("wants_nm", [math.nan, math.inf, -math.inf, 1e39])
def test_a_torque_that_is_not_finite_is_a_fault(wants_nm: float) -> None:
    wild = Wild()
    law = ControlLaw(name="wild", signals=(signal("load_error_rad", "rad"),), build=lambda _: wild)
    dut = DriveUnderTest(laws=[law]).running()
    dut.subscribe(1)
    assert dut.send(sample(0))[-1] == Telemetry(0, (math.inf,))
    wild.wants_nm = wants_nm
    it = fault(dut.send(sample(1)))
    assert (it.code, it.limit) == (FaultCode.TORQUE_NOT_FINITE, 20.0)
    assert dut.drive.torque_nm == 0.0


def test_a_law_gets_applied_torque_and_elapsed_periods() -> None:
    seen: list[ControlInput] = []

    class Listening:
        def step(self, sample: ControlInput) -> ControlOutput:
            seen.append(sample)
            return ControlOutput(100.0)

    dut = DriveUnderTest(laws=[ControlLaw(name="listening", build=lambda _: Listening())]).running()
    for sequence in (0, 1, 4):
        dut.send(sample(sequence, motor=sequence, load=-sequence))
    assert seen == [
        ControlInput(0, 0, 1.0, 0.0, 1),
        ControlInput(1, -1, 1.0, 20.0, 1),
        ControlInput(4, -4, 1.0, 20.0, 3),
    ]


def test_limits_of_a_run_are_those_at_its_start() -> None:
    dut = DriveUnderTest().armed()
    # Parameters that are not live can't be set while running, so the limits of a run are constant.
    for name in ("torque_limit_nm", "watchdog_us", "motor_speed_limit_rad_s", "load_speed_limit_rad_s"):
        assert not dut.drive.parameters.specs[dut.index(name)].live


def test_the_compute_time_is_device_time_and_saturates() -> None:
    for step_ns, wanted in ((5_730, 57), (6_553_500, 65_535), (7_000_000, 65_535)):
        dut = running_at()
        dut.clock.step_ns = step_ns
        assert torque(dut.send(sample(0))).compute_tenths_us == wanted


def test_the_line_report_counts_per_run_including_the_stop() -> None:
    dut = DriveUnderTest().idle()
    noise = b"\x05\x05\0" + b"\x55" * 100 + b"\0" + encode(LineReport(0, 0, 0, 0)) + sealed(b"\x7f\x05")
    dut.drive.receive(noise)
    dut.drive.note_overruns(5)
    dut = dut.running()
    dut.send(sample(0))
    dut.drive.receive(noise + b"\0\0\0")
    dut.drive.note_overruns(3)
    report, _ = dut.send(Stop())
    # A request of an unknown kind is a message, and a message of a drive is refused.
    assert report == LineReport(messages=3, damaged=2, refused=1, overruns=3, device_time_us=0)
    dut.running()
    report, _ = dut.send(Stop())
    assert report == LineReport(messages=1, damaged=0, refused=0, overruns=0, device_time_us=0)


def test_a_damaged_sample_changes_nothing_and_is_not_answered() -> None:
    dut = running_at(0)
    frame = bytearray(encode(sample(1)))
    for bit in range(8 * (len(frame) - 1)):
        frame[bit // 8] ^= 1 << bit % 8
        assert dut.drive.receive(bytes(frame)) == b""
        frame[bit // 8] ^= 1 << bit % 8
    assert classification(dut, 1) == "taken"


def test_a_new_start_resets_the_law() -> None:
    dut = DriveUnderTest()
    runs = []
    for _ in range(2):
        dut.running()
        samples = [sample(it, motor=3 * it, load=it) for it in range(30)]
        runs.append([torque(dut.send(it)).torque_nm for it in samples])
        dut.send(Stop())
    assert runs[0] == runs[1]
