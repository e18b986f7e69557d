"""Everything that stands between a controller's opinion and the motor, in one place.

Only `Running` gives torque. A fault sets it to zero at once and stays until it is cleared. Time is device time in
nanoseconds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from lashloop.messages import FaultReport
from lashloop.enums import FaultCode, Outcome, State, single

if TYPE_CHECKING:
    from lashloop.drive.parameters import Parameters


@dataclass(frozen=True, slots=True)
class Limits:
    """What is allowed in a run: the parameters at its start."""

    torque_nm: float = 0.0
    motor_speed_rad_s: float = 0.0
    load_speed_rad_s: float = 0.0
    watchdog_ns: int = 0


class FaultError(Exception):
    """A rule is broken; the run ends with this report."""

    def __init__(self, report: FaultReport) -> None:
        """Carry the report."""
        super().__init__(report)
        self.report = report


class Safety:
    """State, fault and torque of a drive."""

    def __init__(self) -> None:
        """Begin as after power-up."""
        self.state = State.BOOT
        self.fault: FaultReport | None = None
        self.torque_nm = 0.0
        self.last_sequence: int | None = None
        self._limits = Limits()
        self._last_sample_at_ns = 0

    def greet(self) -> None:
        """End `Boot` or a run; a latched fault stays."""
        if self.state is not State.FAULTED:
            self._rest(State.IDLE)

    def arm(self) -> Outcome:
        """Wait for the start."""
        return self._advance(State.IDLE, State.ARMED)

    def start(self, parameters: Parameters, now_ns: int) -> Outcome:
        """Begin to give torque, within the limits that are in force now."""
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
        """End armed and running; where there is nothing to end nothing is wrong."""
        if self.state in (State.BOOT, State.FAULTED):
            return Outcome.WRONG_STATE
        self._rest(State.IDLE)
        return Outcome.ACCEPTED

    def clear_fault(self, *, greeted: bool) -> Outcome:
        """Go back to where a greeted drive rests, or to `Boot` if no host has greeted it yet."""
        outcome = self._advance(State.FAULTED, State.IDLE if greeted else State.BOOT)
        if outcome is Outcome.ACCEPTED:
            self.fault = None
        return outcome

    def latch(self, fault: FaultReport) -> None:
        """Take the torque away, and keep the first fault: what comes after it is usually its consequence."""
        self._rest(State.FAULTED)
        if self.fault is None:
            self.fault = fault

    def emergency_stop(self) -> FaultReport:
        """Give the report of an emergency stop."""
        return self._report(FaultCode.EMERGENCY_STOP, 0.0, 0.0)

    @property
    def watchdog_deadline_ns(self) -> int | None:
        """Device time up to which a running drive bears silence; None while it is not running."""
        if self.state is not State.RUNNING:
            return None
        return self._last_sample_at_ns + self._limits.watchdog_ns

    def check_watchdog(self, now_ns: int) -> None:
        """Without a new sample in time the host is gone or blind. A silence of exactly the limit is in time."""
        silence_ns = now_ns - self._last_sample_at_ns
        if self.state is State.RUNNING and silence_ns > self._limits.watchdog_ns:
            limit_s = self._limits.watchdog_ns * 1e-9
            raise FaultError(self._report(FaultCode.WATCHDOG, silence_ns * 1e-9, limit_s))

    def note_sample(self, sequence: int, now_ns: int) -> None:
        """Begin the watchdog's time anew: a new sample is taken."""
        self.last_sequence = sequence
        self._last_sample_at_ns = now_ns

    def check_reference(self, reference_rad: float) -> None:
        """Nothing can be done with a reference that is no number."""
        if not math.isfinite(reference_rad):
            raise FaultError(self._report(FaultCode.REFERENCE_NOT_FINITE, reference_rad, 0.0))

    def check_speeds(self, motor_rad_s: float, load_rad_s: float) -> None:
        """An encoder that is faster than the mechanics can be is broken, unplugged or miscounted."""
        for code, speed_rad_s, limit in (
            (FaultCode.MOTOR_ENCODER_JUMP, motor_rad_s, self._limits.motor_speed_rad_s),
            (FaultCode.LOAD_ENCODER_JUMP, load_rad_s, self._limits.load_speed_rad_s),
        ):
            # Written so that NaN does not pass.
            if not single(speed_rad_s) <= limit:
                raise FaultError(self._report(code, speed_rad_s, limit))

    def allow(self, requested_nm: float) -> bool:
        """Give the motor this torque as far as it is allowed, and say whether it was cut. The only way to a torque."""
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
