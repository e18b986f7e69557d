"""All safety functions between a control law and the motor.

Only the state `Running` allows torque. A fault sets the torque to zero at once and stays latched until cleared. Time is
device time in nanoseconds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from lashloop.enums import FaultCode, Outcome, State, single
from lashloop.messages import FaultReport

if TYPE_CHECKING:
    from lashloop.drive.parameters import Parameters


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of a run: the parameters at its start."""

    torque_nm: float = 0.0
    motor_speed_rad_s: float = 0.0
    load_speed_rad_s: float = 0.0
    watchdog_ns: int = 0


class FaultError(Exception):
    """A safety rule is violated; the run ends with this report."""

    def __init__(self, report: FaultReport) -> None:
        """Carry the report."""
        super().__init__(report)
        self.report = report


class Safety:
    """State, fault and torque of a drive."""

    def __init__(self) -> None:
        """Start as after power-up."""
        self.state = State.BOOT
        self.fault: FaultReport | None = None
        self.torque_nm = 0.0
        self.last_sequence: int | None = None
        self._limits = Limits()
        self._last_sample_at_ns = 0

    def open_session(self) -> None:
        """Leave `Boot` or end a run; a latched fault stays."""
        if self.state is not State.FAULTED:
            self._rest(State.IDLE)

    def arm(self) -> Outcome:
        """Wait for the start."""
        return self._advance(State.IDLE, State.ARMED)

    def start(self, parameters: Parameters, now_ns: int) -> Outcome:
        """Allow torque, within the limits now in force."""
        outcome = self._advance(State.ARMED, State.RUNNING)
        if outcome is Outcome.ACCEPTED:
            self._limits = Limits(
                torque_nm=parameters["torque_limit_nm"],
                motor_speed_rad_s=parameters["motor_speed_limit_rad_s"],
                load_speed_rad_s=parameters["load_speed_limit_rad_s"],
                watchdog_ns=int(parameters["watchdog_us"]) * 1000,
            )
            self._last_sample_at_ns = now_ns
            self.last_sequence = None
        return outcome

    def stop(self) -> Outcome:
        """Leave `Armed` or `Running`; accepted in `Idle` without effect."""
        if self.state in (State.BOOT, State.FAULTED):
            return Outcome.WRONG_STATE
        self._rest(State.IDLE)
        return Outcome.ACCEPTED

    def clear_fault(self, *, has_session: bool) -> Outcome:
        """Return to `Idle`, or to `Boot` without a session."""
        outcome = self._advance(State.FAULTED, State.IDLE if has_session else State.BOOT)
        if outcome is Outcome.ACCEPTED:
            self.fault = None
        return outcome

    def latch(self, fault: FaultReport) -> None:
        """Set the torque to zero and keep the first fault; later ones are usually its consequence."""
        self._rest(State.FAULTED)
        if self.fault is None:
            self.fault = fault

    def emergency_stop(self) -> FaultReport:
        """Return the report of an emergency stop."""
        return self._report(FaultCode.EMERGENCY_STOP, 0.0, 0.0)

    @property
    def watchdog_deadline_ns(self) -> int | None:
        """Device time at which the watchdog trips without a new sample; None while not running."""
        if self.state is not State.RUNNING:
            return None
        return self._last_sample_at_ns + self._limits.watchdog_ns

    def check_watchdog(self, now_ns: int) -> None:
        """Raise `FaultError` after more than the watchdog time without a new sample."""
        silence_ns = now_ns - self._last_sample_at_ns
        if self.state is State.RUNNING and silence_ns > self._limits.watchdog_ns:
            limit_s = self._limits.watchdog_ns * 1e-9
            raise FaultError(self._report(FaultCode.WATCHDOG, silence_ns * 1e-9, limit_s))

    def note_sample(self, sequence: int, now_ns: int) -> None:
        """Restart the watchdog time at a new sample."""
        self.last_sequence = sequence
        self._last_sample_at_ns = now_ns

    def check_reference(self, reference_rad: float) -> None:
        """Raise `FaultError` for a reference that is not finite."""
        if not math.isfinite(reference_rad):
            raise FaultError(self._report(FaultCode.REFERENCE_NOT_FINITE, reference_rad, 0.0))

    def check_speeds(self, motor_rad_s: float, load_rad_s: float) -> None:
        """Raise `FaultError` for a speed beyond the mechanics: the encoder is broken, unplugged or miscounts."""
        for code, speed_rad_s, limit in (
            (FaultCode.MOTOR_ENCODER_JUMP, motor_rad_s, self._limits.motor_speed_rad_s),
            (FaultCode.LOAD_ENCODER_JUMP, load_rad_s, self._limits.load_speed_rad_s),
        ):
            # Written so that NaN does not pass.
            if not single(speed_rad_s) <= limit:
                raise FaultError(self._report(code, speed_rad_s, limit))

    def allow(self, requested_nm: float) -> bool:
        """Apply the torque within its limit and return whether it was clamped. No other code sets a torque."""
        limit = self._limits.torque_nm
        if not math.isfinite(requested_nm):
            raise FaultError(self._report(FaultCode.TORQUE_NOT_FINITE, requested_nm, limit))
        self.torque_nm = min(max(requested_nm, -limit), limit)
        return self.torque_nm != requested_nm

    def _advance(self, before: State, after: State) -> Outcome:
        if self.state is not before:
            return Outcome.WRONG_STATE
        self.state = after
        return Outcome.ACCEPTED

    def _rest(self, state: State) -> None:
        self.torque_nm = 0.0
        self.state = state

    def _report(self, code: FaultCode, value: float, limit: float) -> FaultReport:
        return FaultReport(code, self.last_sequence or 0, single(value), single(limit), 0)
