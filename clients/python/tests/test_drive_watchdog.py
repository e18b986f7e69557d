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
    dut = running_at(0)
    dut.clock.pass_us(20_000)
    assert dut.drive.time_left_s == 0.0
    assert dut.decode(dut.drive.tick()) == []
    dut.clock.pass_us(0.1)
    (it,) = dut.decode(dut.drive.tick())
    assert isinstance(it, FaultReport)
    assert (it.code, it.sequence, it.limit) == (FaultCode.WATCHDOG, 0, single(0.02))
    assert it.value == pytest.approx(0.0200001, rel=1e-6)
    assert dut.drive.torque_nm == 0.0
    assert dut.drive.time_left_s is None
    assert dut.decode(dut.drive.tick()) == []


def test_a_late_sample_trips_the_watchdog() -> None:
    dut = running_at(0)
    dut.clock.pass_us(20_001)
    it = fault(dut.send(sample(1)))
    assert (it.code, it.sequence) == (FaultCode.WATCHDOG, 0)


def test_the_watchdog_runs_from_the_start() -> None:
    dut = DriveUnderTest().armed()
    dut.clock.pass_us(1e6)
    dut.send(Start(SESSION))
    dut.clock.pass_us(20_000)
    assert dut.drive.tick() == b""
    dut.clock.pass_us(1)
    assert dut.drive.tick() != b""


def test_only_accepted_samples_restart_the_watchdog() -> None:
    for message in (sample(0), sample(1001), Hello.of(SESSION), GetParameter(0)):
        dut = running_at(0)
        dut.clock.pass_us(15_000)
        dut.send(message)
        dut.clock.pass_us(5_001)
        assert dut.drive.tick() != b"", message
    dut = running_at(0)
    dut.clock.pass_us(15_000)
    dut.send(sample(1))
    dut.clock.pass_us(20_000)
    assert dut.drive.tick() == b""


@pytest.mark.parametrize("state", ["boot", "idle", "armed"])
def test_the_watchdog_is_off_while_not_running(state: str) -> None:
    dut = {"boot": DriveUnderTest(), "idle": DriveUnderTest().idle(), "armed": DriveUnderTest().armed()}[state]
    dut.clock.pass_us(1e9)
    assert dut.drive.time_left_s is None
    assert dut.drive.tick() == b""
