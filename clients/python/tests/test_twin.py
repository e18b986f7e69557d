"""The host with the Rust drive: the native twin as a process on a pseudo-terminal."""

from __future__ import annotations

import math

import pytest

from lashloop.control import ControlInput
from lashloop.control.cascade import PD
from lashloop.drive import Drive
from lashloop.enums import FaultCode, State, single
from lashloop.host import DriveFaultError, Host
from support import PATIENT, rust_twin

PERIOD_S = 1e-3
COUNTS_PER_REV = 131_072


class Plant:
    """Motor and load with a spring and a gap, integrated in small steps."""

    def __init__(self) -> None:
        """The load a quarter of a revolution from zero, the motor aligned, both at rest. Table 1 of the paper."""
        self.motor_rad, self.motor_rad_s = 1.5 * math.pi, 0.0
        self.load_rad, self.load_rad_s = 0.5 * math.pi, 0.0

    def counts(self) -> dict[str, int]:
        """Readings of the encoders."""
        per_rad = COUNTS_PER_REV / math.tau
        return {
            "motor_counts": math.floor(self.motor_rad * per_rad),
            "load_counts": math.floor(self.load_rad * per_rad),
        }

    def step(self, torque_nm: float) -> None:
        """Advance by one control period."""
        steps = 50
        for _ in range(steps):
            twist = self.motor_rad - 3.0 * self.load_rad
            spring_nm = math.copysign(max(abs(twist) - 0.16, 0.0), twist)
            motor = (torque_nm - spring_nm - 4.3e-4 * self.motor_rad_s) / 9.72e-4
            load = (3.0 * spring_nm - 16.0 * self.load_rad_s) / 7.5
            self.motor_rad_s += motor * PERIOD_S / steps
            self.load_rad_s += load * PERIOD_S / steps
            self.motor_rad += self.motor_rad_s * PERIOD_S / steps
            self.load_rad += self.load_rad_s * PERIOD_S / steps


def prepared(host: Host) -> Host:
    """A host in a run of the cascade."""
    host.reset()
    host.set("controller", "pd")
    host.set("torque_limit_nm", 25.0)
    host.set("watchdog_us", 20_000_000)
    host.subscribe()
    host.arm()
    host.start()
    return host


def test_a_closed_loop_with_the_twin_moves_the_load_to_the_reference() -> None:
    plant = Plant()
    law = PD.build(dict(Drive([PD]).parameters))
    with rust_twin() as twin, Host.open(twin.path, limits=PATIENT) as host:
        assert host.identity.board == "native-twin"
        prepared(host)
        applied_nm = 0.0
        before: dict[str, float] = {}
        for step in range(3000):
            counts = plant.counts()
            torque_nm = host.torque(**counts, reference_rad=0.0)
            if step == 0:
                # At rest and without twist, encoders read at the middle of their counts: -(K_P2 + N0) K_P1 theta_s,
                # apart from one count between the motor's middle and three times the load's.
                theta_e, theta_s = ((it + 0.5) * math.tau / COUNTS_PER_REV for it in counts.values())
                wanted_nm = -(theta_e - 3 * theta_s) - (theta_e + 10 * theta_s)
                assert torque_nm == pytest.approx(wanted_nm, abs=1e-5)
                assert torque_nm == pytest.approx(-13 * math.pi / 2, abs=1e-3)
            # The law of this package gives the same torque bit for bit.
            ours = law.step(ControlInput(**counts, reference_rad=0.0, applied_torque_nm=applied_nm, elapsed_periods=1))
            assert torque_nm == ours.torque_nm, f"sample {step}"
            telemetry = host.telemetry
            if telemetry is not None and telemetry.step == step - 1:
                # Received after the torque of its sample. The signals, too, are those of this package.
                assert {name: telemetry[name] for name in before} == before
            before = {name: single(value) for name, value in ours.signals.items()}
            applied_nm = torque_nm
            plant.step(torque_nm)
        report = host.stop()
        assert (report.messages, report.damaged, report.refused, report.overruns) == (3001, 0, 0, 0)
        assert host.lost == 0
        assert host.telemetry is not None
        assert host.telemetry.step == 2990
    # The load approaches zero slowly: less than half of its travel remains after 3 s, without overshoot.
    assert 0.0 < plant.load_rad < 0.25 * math.pi


def test_the_twin_describes_the_law_of_this_package_alike() -> None:
    with rust_twin() as twin, Host.open(twin.path, limits=PATIENT) as host:
        assert "pd" in host.laws
        assert host.parameters["controller"].choices == host.laws
        ours = {spec.name: spec for spec in Drive([PD]).parameters.specs if spec.name != "controller"}
        for name, spec in ours.items():
            it = host.parameters[name]
            assert "pd" in it.laws
            assert (it.unit, it.default, it.min, it.max, it.live, it.choices) == (
                spec.unit,
                spec.default,
                spec.min,
                spec.max,
                spec.live,
                spec.choices,
            )
        for declared in PD.signals:
            assert "pd" in host.signals[declared.name].laws
            assert host.signals[declared.name].unit == declared.unit


def test_the_twin_s_parameters_are_set_and_read_back() -> None:
    with rust_twin() as twin, Host.open(twin.path, limits=PATIENT) as host:
        assert host.set("k_p1", 2.5) == host.get("k_p1") == 2.5
        source = host.parameter("disturbing_torque_source")
        assert source.choices == ("model", "observed")
        assert "pd" not in source.laws
        assert source.text(host.set("disturbing_torque_source", "model")) == "model"


def test_an_encoder_jump_on_the_twin_reports_value_and_limit() -> None:
    with rust_twin() as twin, Host.open(twin.path, limits=PATIENT) as host:
        prepared(host)
        host.torque(motor_counts=0, load_counts=0, reference_rad=0.0)
        with pytest.raises(DriveFaultError) as it:
            host.torque(motor_counts=0, load_counts=50_000, reference_rad=0.0)
        fault = it.value.fault.message
        assert (fault.code, fault.sequence, fault.limit) == (FaultCode.LOAD_ENCODER_JUMP, 1, 100.0)
        # One count is subtracted, because a difference of one count may result from a negligible travel.
        assert fault.value == pytest.approx(49_999 * math.tau / COUNTS_PER_REV / PERIOD_S, rel=1e-6)
        host.clear_fault()
        assert host.emergency_stop().message.code is FaultCode.EMERGENCY_STOP
        host.clear_fault()
        host.arm()


def test_a_latched_fault_is_reported_to_the_next_host() -> None:
    with rust_twin() as twin:
        with Host.open(twin.path, limits=PATIENT) as host:
            host.emergency_stop()
        with Host.open(twin.path, limits=PATIENT) as host:
            assert host.identity.state is State.FAULTED
            assert host.fault is not None
            assert host.fault.message.code is FaultCode.EMERGENCY_STOP
