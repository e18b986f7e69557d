"""The watchdog of a drive: section 8 of the specification."""

from __future__ import annotations

import pytest

from lashloop.enums import FaultCode, single
from lashloop.messages import (
    FaultReport,
    GetParameter,
    Hello,
    Start,
)
from running_drive import fault, running_at
from support import SESSION, DriveUnderTest, sample


def test_the_watchdog_trips_only_after_its_time() -> None:
    bench = running_at(0)
    bench.clock.pass_us(20_000)
    assert bench.drive.time_left_s == 0.0
    assert bench.decode(bench.drive.tick()) == []
    bench.clock.pass_us(0.1)
    (it,) = bench.decode(bench.drive.tick())
    assert isinstance(it, FaultReport)
    assert (it.code, it.sequence, it.limit) == (FaultCode.WATCHDOG, 0, single(0.02))
    assert it.value == pytest.approx(0.0200001, rel=1e-6)
    assert bench.drive.torque_nm == 0.0
    assert bench.drive.time_left_s is None
    assert bench.decode(bench.drive.tick()) == []


def test_a_late_sample_trips_the_watchdog() -> None:
    bench = running_at(0)
    bench.clock.pass_us(20_001)
    it = fault(bench.send(sample(1)))
    assert (it.code, it.sequence) == (FaultCode.WATCHDOG, 0)


def test_the_watchdog_runs_from_the_start() -> None:
    bench = DriveUnderTest().armed()
    bench.clock.pass_us(1e6)
    bench.send(Start(SESSION))
    bench.clock.pass_us(20_000)
    assert bench.drive.tick() == b""
    bench.clock.pass_us(1)
    assert bench.drive.tick() != b""


def test_only_accepted_samples_restart_the_watchdog() -> None:
    for message in (sample(0), sample(1001), Hello(1, SESSION), GetParameter(0)):
        bench = running_at(0)
        bench.clock.pass_us(15_000)
        bench.send(message)
        bench.clock.pass_us(5_001)
        assert bench.drive.tick() != b"", message
    bench = running_at(0)
    bench.clock.pass_us(15_000)
    bench.send(sample(1))
    bench.clock.pass_us(20_000)
    assert bench.drive.tick() == b""


@pytest.mark.parametrize("state", ["boot", "idle", "armed"])
def test_the_watchdog_is_off_while_not_running(state: str) -> None:
    bench = {"boot": DriveUnderTest(), "idle": DriveUnderTest().idle(), "armed": DriveUnderTest().armed()}[state]
    bench.clock.pass_us(1e9)
    assert bench.drive.time_left_s is None
    assert bench.drive.tick() == b""
