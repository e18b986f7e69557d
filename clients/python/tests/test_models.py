"""Estimates as models of other simulators: each repeats the motions that it was estimated from."""

from __future__ import annotations

import functools
import math
import re
import subprocess
import sys
from typing import TYPE_CHECKING, Any, NamedTuple

import mujoco
import numpy as np
import pymoca.ast
import pymoca.parser
import pytest

import lashloop
from lashloop.table import Table
from support import WORKSPACE, program
from test_readers import export

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from numpy.typing import NDArray

MOTIONS = ("slow-reversal", "steps", "pulses-3")
# RMS error of the motor's position, as a fraction of its range: quantisation, and friction that each simulator smooths.
FRACTION = 0.02
SUBSTEPS = 4


class Motion(NamedTuple):
    """A recorded motion."""

    torque_nm: NDArray[np.float64]
    motor_rad: NDArray[np.float64]
    load_rad: NDArray[np.float64]


@pytest.fixture(scope="module")
def commissioned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A commissioning of the shaft of the paper's bench."""
    out = tmp_path_factory.mktemp("commission") / "run"
    limits = {"torque": 20, "motor-speed": 400, "load-speed": 10, "travel": 1.5}
    options = [f"--{name}-limit={value}" for name, value in limits.items()]
    words: list[str | Path] = [program(), "commission", "--device", "inproc", *options, "--yes", "--out", out]
    subprocess.run(words, capture_output=True, check=True)
    return out


@pytest.fixture(scope="module")
def model_of(commissioned: Path) -> Callable[[str], str]:
    """The model for a simulator."""

    @functools.cache
    def make(simulator: str) -> str:
        words: list[str | Path] = [program(), "identify", *(commissioned / name for name in MOTIONS), "--to", simulator]
        model: str = subprocess.run(words, capture_output=True, text=True, check=True).stdout
        return model

    return make


@pytest.fixture(params=MOTIONS)
def motion(request: pytest.FixtureRequest, commissioned: Path) -> Motion:
    table = Table.read(export(commissioned / request.param, "csv"))
    columns = ("torque_nm", "motor_position_rad", "load_position_rad")
    return Motion(*(np.asarray(table[name], dtype=float) for name in columns))


def assert_repeats(motion: Motion, positions: Iterable[tuple[float, float]]) -> None:
    """Checks the positions of a simulation after each step."""
    motor, load = np.array(list(positions)).T
    error = np.sqrt(np.mean((motor - motion.motor_rad[1:]) ** 2))
    assert error < FRACTION * np.ptp(motion.motor_rad)
    assert np.abs(load - motion.load_rad[1:]).max() < 0.012


def runge_kutta(rates: Callable[[NDArray[np.float64], float], NDArray[np.float64]], motion: Motion) -> Iterable[Any]:
    """The positions of motor and load, the first two states, after each step of a motion; the others start at 0."""
    state: NDArray[np.float64] = np.zeros(5)
    state[:2] = motion.motor_rad[0], motion.load_rad[0]
    h = 1e-3 / SUBSTEPS
    for torque_nm in motion.torque_nm[:-1]:
        for _ in range(SUBSTEPS):
            first = rates(state, torque_nm)
            second = rates(state + h / 2 * first, torque_nm)
            third = rates(state + h / 2 * second, torque_nm)
            fourth = rates(state + h * third, torque_nm)
            state = state + h / 6 * (first + 2 * second + 2 * third + fourth)
        yield state[:2]


def test_mujoco_repeats_the_motions(model_of: Callable[[str], str], motion: Motion) -> None:
    model = mujoco.MjModel.from_xml_string(model_of("mujoco"))
    data = mujoco.MjData(model)
    data.qpos[:] = motion.motor_rad[0], motion.load_rad[0]

    def positions() -> Iterable[tuple[float, float]]:
        for torque_nm in motion.torque_nm[:-1]:
            data.ctrl[0] = torque_nm
            mujoco.mj_step(model, data, nstep=round(1e-3 / model.opt.timestep))
            yield data.qpos[0], data.qpos[1]

    assert_repeats(motion, positions())


OPERATORS: dict[str, Callable[..., float]] = {
    "+": lambda *it: sum(it),
    "-": lambda *it: -it[0] if len(it) == 1 else it[0] - it[1],
    "*": lambda *it: math.prod(it),
    "/": lambda a, b: a / b,
    ">": lambda a, b: a > b,
    "<": lambda a, b: a < b,
    "tanh": math.tanh,
    "max": max,
    "min": min,
}


def evaluated(node: Any, values: dict[str, float]) -> float:
    """The value of an expression of Modelica."""
    if isinstance(node, pymoca.ast.Primary):
        return float(node.value)
    if isinstance(node, pymoca.ast.ComponentRef):
        return values[node.name]
    if isinstance(node, pymoca.ast.IfExpression):
        chosen = (at for at, condition in enumerate(node.conditions) if evaluated(condition, values))
        return evaluated(node.expressions[next(chosen, len(node.conditions))], values)
    return OPERATORS[str(node.operator)](*(evaluated(it, values) for it in node.operands))


def declared(symbol: Any) -> float:
    """The value in the declaration of a parameter."""
    modifications = {it.value.component.name: it.value.modifications[0] for it in symbol.class_modification.arguments}
    return evaluated(modifications["value"], {})


def test_modelica_repeats_the_motions(model_of: Callable[[str], str], motion: Motion) -> None:
    drive = pymoca.parser.parse(model_of("modelica")).classes["Drive"]
    parameters = {name: declared(it) for name, it in drive.symbols.items() if "parameter" in it.prefixes}
    assert parameters["j0"] == pytest.approx(0.16, rel=1e-3)
    states = ("motor_position_rad", "load_position_rad", "w_m", "w_s", "motor_torque_nm")

    def rates(state: NDArray[np.float64], torque_nm: float) -> NDArray[np.float64]:
        values = parameters | dict(zip(states, state, strict=True)) | {"torque_nm": torque_nm}
        derivatives = {}
        for equation in drive.equations:
            right = evaluated(equation.right, values)
            if isinstance(equation.left, pymoca.ast.ComponentRef):
                values[equation.left.name] = right
                continue
            # der(x), or a product whose last factor it is.
            *factors, last = equation.left.operands if equation.left.operator == "*" else [equation.left]
            for factor in [it for outer in factors for it in flat(outer)]:
                right /= evaluated(factor, values)
            derivatives[last.operands[0].name] = right
        return np.array([derivatives[name] for name in states])

    assert_repeats(motion, runge_kutta(rates, motion))


def flat(node: Any) -> list[Any]:
    """The factors of a product."""
    is_product = isinstance(node, pymoca.ast.Expression) and node.operator == "*"
    return [it for operand in node.operands for it in flat(operand)] if is_product else [node]


class Block(NamedTuple):
    """A block of a diagram."""

    kind: str
    parameters: dict[str, str]
    inputs: dict[int, str]


def diagram(script: str) -> tuple[dict[str, float], dict[str, Block]]:
    """Variables and blocks of a script; each input has one line."""
    variables = {name: float(value) for name, value in re.findall(r"^(\w+) = ([^;]+);", script, re.MULTILINE)}
    blocks = {}
    for kind, name, rest in re.findall(r"add_block\('simulink/[^/]+/([^']+)', 'drive/(\w+)'(.*)\);", script):
        words = re.findall(r"'([^']*)'", rest)
        blocks[name] = Block(kind, dict(zip(words[::2], words[1::2], strict=True)), {})
    for source, target, port in re.findall(r"add_line\('drive', '(\w+)/1', '(\w+)/(\d)'", script):
        assert int(port) not in blocks[target].inputs, f"two lines to {target}/{port}"
        blocks[target].inputs[int(port)] = source
    for name, block in blocks.items():
        inputs = {"In1": 0, "Constant": 0, "Switch": 3}.get(block.kind, 1)
        inputs = len(block.parameters.get("Inputs", " " * inputs))
        assert sorted(block.inputs) == list(range(1, inputs + 1)), name
    return variables, blocks


def test_the_diagram_of_simulink_repeats_the_motions(model_of: Callable[[str], str], motion: Motion) -> None:
    variables, blocks = diagram(model_of("simulink-script"))
    states = ("motor_position", "load_position", "motor_velocity", "load_velocity", "lag")
    assert {name for name, it in blocks.items() if it.kind in ("Integrator", "Transfer Fcn")} == set(states)

    numbers = {
        (id(block), name): float(eval(text, {}, dict(variables)))
        for block in blocks.values()
        for name, text in block.parameters.items()
        if name in ("Gain", "gain", "offset", "LowerValue", "UpperValue", "Value")
    }

    def number(block: Block, name: str) -> float:
        return numbers[id(block), name]

    assert blocks["lag"].parameters == {"Numerator": "1", "Denominator": "[1e-3*T_i 1]"}
    lag_s = 1e-3 * variables["T_i"]

    def rates(state: NDArray[np.float64], torque_nm: float) -> NDArray[np.float64]:
        known: dict[str, float] = dict(zip(states, state.tolist(), strict=True)) | {"torque_nm": torque_nm}

        def output(name: str) -> float:
            if name not in known:
                block = blocks[name]
                known[name] = computed(block, [output(block.inputs[port]) for port in sorted(block.inputs)])
            return known[name]

        def computed(block: Block, inputs: list[float]) -> float:
            match block.kind:
                case "Gain":
                    return number(block, "Gain") * inputs[0]
                case "Add":
                    return sum(
                        it if sign == "+" else -it for sign, it in zip(block.parameters["Inputs"], inputs, strict=True)
                    )
                case "Dead Zone":
                    low, high = number(block, "LowerValue"), number(block, "UpperValue")
                    return max(inputs[0] - high, 0.0) + min(inputs[0] - low, 0.0)
                case "Coulomb & Viscous Friction":
                    # Its step is smoothed here, for a solver without events.
                    return number(block, "gain") * inputs[0] + number(block, "offset") * math.tanh(inputs[0] / 0.01)
                case "Constant":
                    return number(block, "Value")
                case "Switch":
                    return inputs[0] if inputs[1] != 0 else inputs[2]
                case other:
                    raise AssertionError(other)

        rates = [output(blocks[name].inputs[1]) for name in states[:4]]
        return np.array([*rates, (torque_nm - known["lag"]) / lag_s])

    assert_repeats(motion, runge_kutta(rates, motion))


def test_the_example_settles_as_the_plant_that_it_was_estimated_from(tmp_path: Path) -> None:
    example = WORKSPACE / "examples/plant-process/mujoco.toml"
    settings = {"run.duration_s": 12.0, "expect": []}
    scenarios = {
        "mujoco": (example, {"plant.command": [sys.executable, "mujoco_plant.py"]}),
        "built-in": (WORKSPACE / "scenarios/shaft-merzouki.toml", {}),
    }
    settled = {}
    for name, (scenario, command) in scenarios.items():
        record = lashloop.run(scenario, set=settings | command, device="inproc", out=tmp_path / name, program=program())
        settled[name] = record.metrics["settle_time_s"]
    assert settled["mujoco"] == pytest.approx(settled["built-in"], rel=0.02)
