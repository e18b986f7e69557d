"""Samples and torques: section 7 of the specification."""

from __future__ import annotations

import math

import pytest

from lashloop.control import ControlInput, ControlLaw, ControlOutput
from lashloop.drive import Drive
from lashloop.frames import encode
from lashloop.messages import (
    EncoderSample,
    LineReport,
    Stop,
    Telemetry,
    TorqueAnswer,
)
from lashloop.enums import FaultCode, ParameterValue, TorqueFlags
from running import QUIET, SLOW, fault, place, running_at, torque
from support import Bench, sample, table

LAST = 2**16 - 2  # so that what follows wraps


def at_last() -> Bench:
    """A running drive whose last sequence is `LAST`. It is brought there by gaps, to be there soon."""
    bench = Bench()
    bench.running(**QUIET, **SLOW)
    for sequence in (*range(0, LAST - 1, 999), LAST - 1):
        assert place(bench, sequence) == ("after a gap" if sequence else "taken")
    assert place(bench, LAST) == "taken"
    return bench


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
def test_where_a_sample_stands_is_told_by_its_sequence_modulo_2_to_the_16(sequence: int, is_: str) -> None:
    assert place(at_last(), sequence) == is_


def test_the_table_of_sequences_is_the_one_tested() -> None:
    rows = [row[:2] for row in table("## 7. Samples and torques")]
    assert rows == [
        ["0, none taken yet", "first"],
        ["last + 1", "next"],
        ["last + 2 to last + 1000", "after a gap"],
        ["last", "repeated"],
        ["any other", "stray"],
    ]


@pytest.mark.parametrize("sequence", [1, 5, 1000, 2**16 - 1])
def test_only_sequence_0_begins_a_run(sequence: int) -> None:
    bench = running_at()
    assert place(bench, sequence) == "stray"
    assert place(bench, 0) == "taken"


def test_a_repeated_sample_gets_the_same_answer_whatever_it_carries_and_makes_no_step() -> None:
    disturbed, quiet = running_at(), running_at()
    for sequence in range(20):
        it = sample(sequence, motor=3 * sequence, load=sequence)
        first = torque(disturbed.say(it))
        again = torque(disturbed.say(EncoderSample(sequence, 999, -999, math.nan)))
        assert again.torque_nm == first.torque_nm
        assert again.status.flags == first.status.flags | TorqueFlags.REPEATED
        assert first.torque_nm == torque(quiet.say(it)).torque_nm


def test_a_stray_sample_makes_no_step() -> None:
    disturbed, quiet = running_at(), running_at()
    for sequence in range(20):
        it = sample(sequence, motor=3 * sequence, load=sequence)
        assert torque(disturbed.say(it)).torque_nm == torque(quiet.say(it)).torque_nm
        assert place(disturbed, (sequence + 2**15) % 2**16) == "stray"


def test_a_gap_is_told_once_and_velocities_are_over_the_time_that_passed() -> None:
    every, gappy = running_at(), running_at()
    for sequence in range(61):
        it = sample(sequence, motor=12 * sequence, load=4 * sequence)
        wanted = torque(every.say(it))
        if sequence % 3 == 0:
            have = torque(gappy.say(it))
            assert (TorqueFlags.GAP in have.status.flags) == (sequence > 0)
            assert have.torque_nm == pytest.approx(wanted.torque_nm, rel=1e-5)


def test_the_torque_is_cut_to_the_limit_and_flagged() -> None:
    free_nm = torque(Bench().running(**QUIET).say(sample(0))).torque_nm
    assert abs(free_nm) == pytest.approx(13.0, abs=0.01)
    for limit_nm, wanted_nm, flags in ((5.0, 5.0, TorqueFlags.SATURATED), (20.0, free_nm, TorqueFlags(0))):
        bench = Bench().running(torque_limit_nm=ParameterValue.f32(limit_nm))
        answer, telemetry = bench.say(sample(0))
        assert isinstance(answer, TorqueAnswer)
        assert isinstance(telemetry, Telemetry)
        assert (answer.torque_nm, answer.status.flags) == (math.copysign(wanted_nm, free_nm), flags)
        assert telemetry.requested_torque_nm == free_nm
        assert bench.drive.torque_nm == answer.torque_nm


def test_telemetry_follows_every_n_th_sequence_and_can_be_changed_while_running() -> None:
    bench = Bench().running(telemetry_every=ParameterValue.u32(3))
    assert [len(bench.say(sample(it))) for it in range(7)] == [2, 1, 1, 2, 1, 1, 2]
    bench.set("telemetry_every", ParameterValue.u32(0))
    assert [len(bench.say(sample(it))) for it in range(7, 14)] == [1] * 7
    bench.set("telemetry_every", ParameterValue.u32(1))
    assert [len(bench.say(sample(it))) for it in range(14, 17)] == [2] * 3


@pytest.mark.parametrize("reference_rad", [math.nan, math.inf, -math.inf])
def test_a_reference_that_is_no_number_is_a_fault(reference_rad: float) -> None:
    it = fault(running_at(0, 1).say(sample(2, reference_rad=reference_rad)))
    assert (it.code, it.sequence, it.limit) == (FaultCode.REFERENCE_NOT_FINITE, 2, 0.0)
    assert str(it.value) == str(reference_rad)


class Wild:
    """A law that asks for what it is told."""

    wants_nm = 0.0

    def step(self, sample: ControlInput) -> ControlOutput:
        """Ask."""
        del sample
        return ControlOutput(self.wants_nm, load_error_rad=1e300)


@pytest.mark.parametrize("wants_nm", [math.nan, math.inf, -math.inf, 1e39])
def test_a_torque_that_is_no_number_of_single_precision_is_a_fault(wants_nm: float) -> None:
    wild = Wild()
    bench = Bench()
    bench.drive = Drive([ControlLaw(1, (), lambda _: wild)], clock_ns=bench.clock)
    bench.running()
    telemetry = bench.say(sample(0))[-1]
    assert isinstance(telemetry, Telemetry)
    assert telemetry.load_error_rad == math.inf
    wild.wants_nm = wants_nm
    it = fault(bench.say(sample(1)))
    assert (it.code, it.limit) == (FaultCode.TORQUE_NOT_FINITE, 20.0)
    assert bench.drive.torque_nm == 0.0


def test_a_law_is_told_the_torque_that_was_applied_and_the_periods_that_passed() -> None:
    seen: list[ControlInput] = []

    class Listening:
        def step(self, sample: ControlInput) -> ControlOutput:
            seen.append(sample)
            return ControlOutput(100.0)

    bench = Bench()
    bench.drive = Drive([ControlLaw(1, (), lambda _: Listening())], clock_ns=bench.clock)
    bench.running(**QUIET)
    for sequence in (0, 1, 4):
        bench.say(sample(sequence, motor=sequence, load=-sequence))
    assert seen == [
        ControlInput(0, 0, 1.0, 0.0, 1),
        ControlInput(1, -1, 1.0, 20.0, 1),
        ControlInput(4, -4, 1.0, 20.0, 3),
    ]


def test_limits_are_those_at_the_start() -> None:
    bench = Bench().armed()
    # What is not live can't be set any more, so nothing can change a run's limits.
    for name in ("torque_limit_nm", "watchdog_us", "motor_speed_limit_rad_s", "load_speed_limit_rad_s"):
        assert not bench.drive.parameters.specs[bench.index(name)].live


def test_the_time_of_an_answer_is_device_time_and_stays_at_its_largest_value() -> None:
    for step_ns, wanted in ((5_730, 57), (6_553_500, 65_535), (7_000_000, 65_535)):
        bench = running_at()
        bench.clock.step_ns = step_ns
        assert torque(bench.say(sample(0))).compute_tenths_us == wanted


def test_the_line_report_counts_each_run_anew_and_the_stop_as_the_last() -> None:
    bench = Bench().idle()
    noise = b"\x05\x05\0" + b"\x55" * 100 + b"\0" + encode(LineReport(0, 0, 0, 0))
    bench.drive.receive(noise)
    bench.drive.note_overruns(5)
    bench = bench.running(**QUIET)
    bench.say(sample(0))
    bench.drive.receive(noise + b"\0\0\0")
    bench.drive.note_overruns(3)
    report, _ = bench.say(Stop())
    assert report == LineReport(messages=2, damaged=2, refused=1, overruns=3)
    bench.running(**QUIET)
    report, _ = bench.say(Stop())
    assert report == LineReport(messages=1, damaged=0, refused=0, overruns=0)


def test_a_damaged_sample_changes_nothing_and_is_not_answered() -> None:
    bench = running_at(0)
    frame = bytearray(encode(sample(1)))
    for bit in range(8 * (len(frame) - 1)):
        frame[bit // 8] ^= 1 << bit % 8
        assert bench.drive.receive(bytes(frame)) == b""
        frame[bit // 8] ^= 1 << bit % 8
    assert place(bench, 1) == "taken"


def test_a_new_start_begins_anew() -> None:
    bench = Bench()
    runs = []
    for _ in range(2):
        bench.running(**QUIET)
        samples = [sample(it, motor=3 * it, load=it) for it in range(30)]
        runs.append([torque(bench.say(it)).torque_nm for it in samples])
        bench.say(Stop())
    assert runs[0] == runs[1]
