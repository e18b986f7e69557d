"""Drives and hosts on real pseudo-terminals."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import pytest

from lashloop.control import ControlInput, ControlLaw, ControlOutput
from lashloop.control.cascade import PD
from lashloop.drive import BackgroundDrive, Drive, serve
from lashloop.enums import FaultCode, State
from lashloop.frames import FROM_DRIVE, decode, encode
from lashloop.host import DriveFaultError, Host
from lashloop.link import DescriptorLink, LinkClosedError, LinkError, open_port, send_all
from lashloop.messages import Hello, Identity
from support import PATIENT, SOON_S, python_drive

if TYPE_CHECKING:
    from collections.abc import Iterator


@pytest.fixture
def served() -> Iterator[BackgroundDrive]:
    """The drive of the package."""
    with BackgroundDrive(Drive([PD])) as served:
        yield served
    assert served.error is None


def test_a_run_over_a_pseudo_terminal_has_no_losses(served: BackgroundDrive) -> None:
    with Host.open(served.path) as host:
        host.set("watchdog_us", 5_000_000)
        host.arm()
        host.start()
        for _ in range(500):
            assert host.torque(motor_counts=0, load_counts=0, reference_rad=1.0) != 0.0
        report = host.stop()
        assert (report.messages, report.damaged, report.refused) == (501, 0, 0)
        assert (host.lost, host.counters.damaged, host.counters.refused) == (0, 0, 0)


def test_hosts_may_connect_one_after_the_other(served: BackgroundDrive) -> None:
    for _ in range(3):
        with Host.open(served.path) as host:
            assert host.identity.state is State.IDLE


def test_a_port_in_use_is_rejected(served: BackgroundDrive) -> None:
    with Host.open(served.path), pytest.raises(LinkError, match=f"the port {served.path} can't be opened"):
        open_port(served.path)


def test_a_partial_frame_of_an_earlier_host_does_no_harm(served: BackgroundDrive) -> None:
    line = open_port(served.path)
    send_all(line, encode(Hello.of(1))[:-1], SOON_S)
    line.close()
    with Host.open(served.path) as host:
        assert host.identity.session != 1


def test_without_samples_the_watchdog_trips_and_is_reported(served: BackgroundDrive) -> None:
    with Host.open(served.path) as host:
        host.set("watchdog_us", 100_000)
        host.arm()
        host.start()
        host.torque(motor_counts=0, load_counts=0, reference_rad=1.0)
        deadline = time.monotonic() + SOON_S
        while served.drive.state is State.RUNNING and time.monotonic() < deadline:
            time.sleep(0.005)
        assert served.drive.torque_nm == 0.0
        with pytest.raises(DriveFaultError) as it:
            host.torque(motor_counts=0, load_counts=0, reference_rad=1.0)
        assert it.value.fault.message.code is FaultCode.WATCHDOG
        assert 0.1 < it.value.fault.message.value < SOON_S


def test_a_host_that_does_not_read_can_t_keep_the_watchdog_from_tripping(served: BackgroundDrive) -> None:
    with Host.open(served.path) as host:
        host.set("watchdog_us", 200_000)
        host.arm()
        host.start()
        # Far more requests than the buffer of a terminal holds answers.
        hellos = encode(Hello.of(host.identity.session)) * 100
        line = host._line._link
        deadline = time.monotonic() + SOON_S
        while served.drive.state is State.RUNNING and time.monotonic() < deadline:
            line.write(hellos, 0.01)
        assert served.drive.state is State.FAULTED
        assert served.drive.torque_nm == 0.0


class Broken:
    """A law with an error."""

    def step(self, sample: ControlInput) -> ControlOutput:
        """Divide by zero at the third sample."""
        return ControlOutput(1.0 / (2 - sample.motor_counts))


def test_a_law_that_raises_ends_the_drive_with_a_panic_report() -> None:
    law = ControlLaw(name="broken", build=lambda _: Broken())
    with BackgroundDrive(Drive([law])) as served, Host.open(served.path) as host:
        host.set("watchdog_us", 5_000_000)
        host.arm()
        host.start()
        for counts in range(2):
            host.torque(motor_counts=counts, load_counts=0, reference_rad=0.0)
        with pytest.raises(DriveFaultError, match="latched Panic") as it:
            host.torque(motor_counts=2, load_counts=0, reference_rad=0.0)
    assert isinstance(served.error, ZeroDivisionError)
    line = Broken.step.__code__.co_firstlineno + 2
    assert it.value.fault.message.detail == line
    assert it.value.fault.message.device_time_us is not None


def test_a_drive_on_a_failed_link_ends_with_an_error() -> None:
    far_end, near_end = os.openpty()
    line = DescriptorLink(far_end, "the terminal")
    os.close(near_end)
    with pytest.raises(LinkError, match="the link the terminal has failed"):
        serve(line, Drive([PD]))
    line.close()


PRINTING = """
from lashloop.control.cascade import PD
from lashloop.drive import Drive, serve
from lashloop.link import StandardStreams
print("before", flush=True)
streams = StandardStreams()
print("after", flush=True)
serve(streams, Drive([PD]))
"""


def test_prints_of_a_drive_on_standard_streams_do_not_disturb_the_link() -> None:
    ended = subprocess.run(
        [sys.executable, "-c", PRINTING], input=encode(Hello.of(1), 7), capture_output=True, timeout=SOON_S, check=True
    )
    noise, _, frame = ended.stdout.partition(b"\n")
    assert (noise, ended.stderr) == (b"before", b"after\n")
    item = decode(frame, FROM_DRIVE)
    assert isinstance(item.message, Identity)
    assert (item.number, item.message.session) == (7, 1)


def test_a_drive_whose_host_closes_the_link_ends_without_an_error() -> None:
    host, drive = socket.socketpair()
    line = DescriptorLink(drive.detach(), "the socket")
    host.send(encode(Hello.of(1)))
    host.shutdown(socket.SHUT_WR)
    serve(line, Drive([PD]))
    assert len(host.recv(100)) == 59
    host.close()
    with pytest.raises(LinkClosedError, match="the link the socket has failed: its far end has closed"):
        line.write(b"\0", 0.0)
    line.close()


def test_a_killed_drive_is_a_link_error() -> None:
    with python_drive() as program, Host.open(program.path, limits=PATIENT) as host:
        host.set("watchdog_us", 5_000_000)
        host.arm()
        host.start()
        host.torque(motor_counts=0, load_counts=0, reference_rad=1.0)
        program.signal(signal.SIGKILL)
        program.ended()
        with pytest.raises(LinkError, match=f"the link {program.path} has failed"):
            host.torque(motor_counts=0, load_counts=0, reference_rad=1.0)


def test_a_drive_answers_more_than_1000_samples_per_second() -> None:
    with python_drive() as program, Host.open(program.path, limits=PATIENT) as host:
        host.set("watchdog_us", 5_000_000)
        host.arm()
        host.start()
        # The best of several, because other load only adds time.
        times_s = []
        for _ in range(5):
            start = time.monotonic()
            for _ in range(500):
                host.torque(motor_counts=0, load_counts=0, reference_rad=1.0)
            times_s.append(time.monotonic() - start)
    assert min(times_s) < 0.5, f"500 samples took {times_s} s"
