"""`python -m lashloop.fmu`: an FMU for model exchange, or of FMI 1.0, as a plant of the bench, with the solver of FMPy.

It speaks the plant-process protocol of `docs/extend/plant.md` on standard input and output, as `lashloop-fmu` does for
FMI 2.0 and 3.0 for co-simulation. A scenario chooses it by `plant.command = ["python3", "-m", "lashloop.fmu"]`.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import sys
import tempfile
from typing import IO, Any, Protocol

VERSION = 1
DEFAULT_TOLERANCE = 1e-9
# The bench gives whole microseconds as sums of a few numbers.
SECOND_NS = 1_000_000_000


class FmuError(Exception):
    """What the FMU lacks or does wrong; the bench prints it."""


class _Stepper(Protocol):
    def hold(self, torque_nm: float, time_s: float, until_s: float) -> None: ...


class _NoInput:
    """FMPy's solver asks for inputs; a torque is held."""

    def apply(self, *_: Any, **__: Any) -> None: ...


class _ModelExchange:
    """An FMU for model exchange, integrated by CVode from event to event."""

    def __init__(self, fmu: Any, description: Any, torque: Any, tolerance: float) -> None:
        from fmpy.sundials import CVodeSolver

        self.fmu, self.torque = fmu, torque
        self.version = description.fmiVersion[0]
        self.needs_completed_step = description.modelExchange.needsCompletedIntegratorStep
        self.next_event_s: float | None = None
        self.update()
        self.solver = CVodeSolver(
            nx=description.numberOfContinuousStates,
            nz=description.numberOfEventIndicators,
            get_x=fmu.getContinuousStates,
            set_x=fmu.setContinuousStates,
            get_dx=fmu.getContinuousStateDerivatives if self.version == "3" else fmu.getDerivatives,
            get_z=fmu.getEventIndicators,
            get_nominals=fmu.getNominalContinuousStates if self.version == "1" else fmu.getNominalsOfContinuousStates,
            set_time=fmu.setTime,
            input=_NoInput(),
            startTime=0.0,
            relativeTolerance=tolerance,
            maxNumSteps=100_000,
        )

    def update(self) -> None:
        """Handles an event."""
        again = True
        while again:
            if self.version == "1":
                converged, _, _, terminates, has_next, next_s = self.fmu.eventUpdate()
                again = not converged
            else:
                update = self.fmu.newDiscreteStates if self.version == "2" else self.fmu.updateDiscreteStates
                again, terminates, _, _, has_next, next_s = update()
            if terminates:
                raise FmuError("the FMU ends the simulation; its model does so")
        self.next_event_s = next_s if has_next else None
        if self.version != "1":
            self.fmu.enterContinuousTimeMode()

    def event(self, time_s: float) -> None:
        if self.version != "1":
            self.fmu.enterEventMode()
        self.update()
        self.solver.reset(time_s)

    def hold(self, torque_nm: float, time_s: float, until_s: float) -> None:
        """Sets a torque, which is an event, and integrates."""
        if self.version != "1":
            self.fmu.enterEventMode()
        _set(self.fmu, self.version, self.torque, torque_nm)
        self.update()
        self.solver.reset(time_s)
        while time_s < until_s:
            goal_s = until_s if self.next_event_s is None else min(until_s, self.next_event_s)
            is_time_event = self.next_event_s is not None and goal_s == self.next_event_s
            is_state_event, _, time_s = self.solver.step(time_s, goal_s)
            self.fmu.setTime(time_s)
            is_step_event = False
            if self.needs_completed_step:
                completed = self.fmu.completedIntegratorStep()
                if self.version == "1":
                    is_step_event = bool(completed)
                else:
                    is_step_event, terminates = bool(completed[0]), bool(completed[1])
                    if terminates:
                        raise FmuError(f"the FMU ends the simulation at t = {time_s} s; its model does so")
            if is_state_event or is_step_event or (is_time_event and time_s >= goal_s):
                self.event(time_s)


class _CoSimulation:
    """An FMU of FMI 1.0 for co-simulation."""

    def __init__(self, fmu: Any, torque: Any) -> None:
        self.fmu, self.torque = fmu, torque

    def hold(self, torque_nm: float, time_s: float, until_s: float) -> None:
        _set(self.fmu, "1", self.torque, torque_nm)
        self.fmu.doStep(currentCommunicationPoint=time_s, communicationStepSize=until_s - time_s)


def _suffix(version: str, variable: Any) -> str:
    kind: str = variable.type
    if version == "3":
        return {"Real": "Float64", "Integer": "Int32", "Enumeration": "Int64"}.get(kind, kind)
    return "Integer" if kind == "Enumeration" else kind


def _set(fmu: Any, version: str, variable: Any, value: Any) -> None:
    getattr(fmu, f"set{_suffix(version, variable)}")([variable.valueReference], [value])


def _get(fmu: Any, version: str, variable: Any) -> float:
    return float(getattr(fmu, f"get{_suffix(version, variable)}")([variable.valueReference])[0])


class _Plant:
    """An FMU in motion."""

    def __init__(self, settings: dict[str, Any], folder: str) -> None:
        try:
            import fmpy
            from fmpy.simulation import apply_start_values, instantiate_fmu, settable_in_instantiated
        except ModuleNotFoundError as error:
            raise FmuError(f"python -m lashloop.fmu needs FMPy: pip install fmpy==0.3.32 ({error})") from error
        self.description = fmpy.read_model_description(settings["file"], validate=False)
        self.version: str = self.description.fmiVersion[0]
        exchange = self.description.modelExchange is not None
        if not exchange and self.version != "1":
            raise FmuError("the FMU is for co-simulation only: lashloop-fmu runs it, without plant.command")
        self.torque = self.variable("torque_input", settings["torque_input"], {"", "N.m", "N m", "N*m", "Nm"})
        if self.torque.causality != "input":
            raise FmuError(f"the FMU's variable {self.torque.name!r} isn't an input, which plant.torque_input needs")
        self.outputs = [self.variable(key, settings[key], {"", "rad"}) for key in ("motor_output", "load_output")]
        self.outputs += [self.variable("signals", name) for name in settings.get("signals", [])]
        folder = fmpy.extract(settings["file"], unzipdir=folder)
        kind = "ModelExchange" if exchange else "CoSimulation"
        self.fmu = instantiate_fmu(folder, self.description, fmi_type=kind, require_functions=False)
        start: dict[str, Any] = settings.get("start", {})
        for name in start:
            variable = self.variable(f"start.{name}", name)
            # Another name of the same variable has its reference.
            if (variable.valueReference, variable.type) == (self.torque.valueReference, self.torque.type):
                raise FmuError(f"plant.start.{name} is the torque input, which the bench sets; remove this start value")
        tolerance = settings.get("tolerance") or DEFAULT_TOLERANCE
        if self.version == "1":
            settable = None
            if exchange:
                self.fmu.setTime(0.0)
        else:
            settable = settable_in_instantiated
        rest = apply_start_values(self.fmu, self.description, dict(start), settable=settable)
        if rest:
            raise FmuError(f"plant.start.{next(iter(rest))} can't be set; the FMU calculates this variable")
        self.initialize(exchange, tolerance)
        for name, want in start.items():
            variable = self.variable(f"start.{name}", name)
            if variable.type == "String" or variable.initial == "approx":
                continue
            have = _get(self.fmu, self.version, variable)
            # NaN doesn't pass.
            if not abs(have - want) <= 1e-6 * abs(want):
                raise FmuError(f"the FMU's variable {name!r} is {have} after its start value of {want}; it ignores it")
        self.elapsed_ns = 0
        self.stepper: _Stepper = (
            _ModelExchange(self.fmu, self.description, self.torque, tolerance)
            if exchange
            else _CoSimulation(self.fmu, self.torque)
        )

    def initialize(self, exchange: bool, tolerance: float) -> None:
        if self.version == "1":
            if exchange:
                self.fmu.initialize(toleranceControlled=True, relativeTolerance=tolerance)
            else:
                self.fmu.initialize(tStart=0.0)
            return
        if self.version == "2":
            self.fmu.setupExperiment(tolerance=tolerance, startTime=0.0)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(tolerance=tolerance, startTime=0.0)
        _set(self.fmu, self.version, self.torque, 0.0)
        self.fmu.exitInitializationMode()

    def variable(self, key: str, name: str, units: set[str] | None = None) -> Any:
        """The variable that `plant.KEY` names."""
        import difflib

        variables = {it.name: it for it in self.description.modelVariables}
        if name not in variables:
            near = difflib.get_close_matches(name, variables) or ["no similar one"]
            raise FmuError(f"the FMU has no variable {name!r}, which plant.{key} names; it has {', '.join(near)}")
        found = variables[name]
        if units is not None and self.unit(found) not in units:
            unit = self.unit(found)
            raise FmuError(f"the FMU's variable {name!r} has the unit {unit}; plant.{key} needs {max(units)}")
        return found

    @staticmethod
    def unit(variable: Any) -> str:
        return variable.unit or (variable.declaredType and variable.declaredType.unit) or ""

    def signals(self) -> list[dict[str, str]]:
        return [{"name": it.name, "unit": self.unit(it)} for it in self.outputs[2:]]

    def state(self) -> dict[str, Any]:
        """Positions and values, as the protocol has them."""
        values = [_get(self.fmu, self.version, it) for it in self.outputs]
        for variable, value in zip(self.outputs, values, strict=True):
            if not math.isfinite(value):
                time_s = self.elapsed_ns / SECOND_NS
                raise FmuError(f"the FMU's variable {variable.name!r} is {value} at t = {time_s} s; check plant.start")
        return {"motor_position_rad": values[0], "load_position_rad": values[1], "values": values[2:]}

    def step(self, torque_nm: float, held_s: float) -> None:
        """Times are whole nanoseconds, divided once: sums drift."""
        start_ns = self.elapsed_ns
        self.elapsed_ns += round(held_s * SECOND_NS)
        self.stepper.hold(torque_nm, start_ns / SECOND_NS, self.elapsed_ns / SECOND_NS)

    def end(self) -> None:
        """Ends the FMU in the order that FMI demands. Its errors don't matter any more."""
        with contextlib.suppress(Exception):
            self.fmu.terminate()
        with contextlib.suppress(Exception):
            self.fmu.freeInstance()


def serve(lines: IO[str], output: IO[str]) -> None:
    """Serves one run, to the end of its lines."""

    def send(message: dict[str, Any]) -> None:
        output.write(json.dumps(message, allow_nan=False) + "\n")
        output.flush()

    first = lines.readline()
    if not first:
        return
    try:
        with contextlib.ExitStack() as stack:
            hello = json.loads(first)
            if hello.get("lashloop_plant") != VERSION:
                raise FmuError(f"the bench has version {hello.get('lashloop_plant')} of the protocol, not {VERSION}")
            settings = hello["settings"]
            # The bench gives a folder and removes it.
            folder = settings.get("unpack_into") or stack.enter_context(tempfile.TemporaryDirectory())
            plant = _Plant(settings, folder)
            send({"lashloop_plant": VERSION, "signals": plant.signals()} | plant.state())
            for line in lines:
                held = json.loads(line)
                plant.step(held["torque_nm"], held["dt_s"])
                send(plant.state())
            plant.end()
    # What FMPy raises has many types; each of them ends the run with its text.
    except Exception as error:
        text = str(error) if isinstance(error, FmuError) else f"{type(error).__name__}: {error}"
        send({"error": text})


def main() -> None:
    """Serves standard input."""
    # Standard output is for the protocol alone: what the FMU prints goes to standard error.
    output = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    serve(sys.stdin, output)


if __name__ == "__main__":
    main()
