"""Runs by the `lashloop` program: records, settings, drives of this package, errors."""

from __future__ import annotations

import math
import os
import signal
import stat
import sys
import tempfile
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import tomli

import lashloop
from lashloop.control import ControlInput, ControlLaw, ControlOutput, f32
from lashloop.control import signal as declared
from lashloop.control.cascade import PD
from lashloop.drive import Drive
from lashloop.program import VARIABLE, find_program
from lashloop.runner import toml
from support import SOON_S, WORKSPACE, program

if TYPE_CHECKING:
    from collections.abc import Callable

SCENARIO = WORKSPACE / "scenarios/friction-before.toml"
SHORT = {"run.duration_s": 1.5}
COUNT_RAD = math.tau / 131_072


@pytest.fixture(autouse=True)
def _built(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, str(program()))


def test_a_run_returns_the_arrays_of_its_record() -> None:
    record = lashloop.run(SCENARIO, set=SHORT, device="inproc")
    np.testing.assert_allclose(record["time_s"], np.arange(1500) * 1e-3, atol=1e-12)
    # The drive's error is that of the plant at the time of the telemetry, within a count of the encoder.
    steps = np.rint(record["telemetry_time_s"] / 1e-3).astype(int)
    true_rad = (record["load_position_rad"] - record["reference_rad"])[steps]
    np.testing.assert_allclose(record["drive.load_error_rad"], true_rad, atol=COUNT_RAD)
    assert (record.units["drive.load_error_rad"], record.units["torque_nm"]) == ("rad", "N m")
    assert len(record.timing["step"]) == record.steps == 1500


def test_fail_is_a_verdict_and_no_error() -> None:
    record = lashloop.run(SCENARIO, set=SHORT, device="inproc")
    assert record.verdict is lashloop.Verdict.FAIL
    static_error_rad = record.metrics["static_error_rad"]
    assert static_error_rad is not None
    assert static_error_rad > 1.0
    assert record.metrics["settle_time_s"] is None
    assert record.metrics_without_value["settle_time_s"] == "never"
    assert "friction-before.toml on inproc" in repr(record)
    assert "1500 steps" in repr(record)


def test_settings_replace_values_of_the_scenario() -> None:
    settings = {
        **SHORT,
        "controller.name": "pd",
        "controller.parameters.k_p1": np.float32(2.0),
        "telemetry.every_steps": 1,
        "telemetry.signals": ["load_error_rad", "requested_torque_nm"],
    }
    record = lashloop.run(SCENARIO, set=settings, device="inproc")
    assert [it for it in record.columns if it.startswith("drive.")] == [
        "drive.requested_torque_nm",
        "drive.load_error_rad",
    ]
    np.testing.assert_array_equal(record["telemetry_time_s"], record["time_s"])
    # The first torque is -(K_P2 + N0) K_P1 theta_s; K_P1 is twice its default, and the scenario limits to 25 N m.
    assert record["drive.requested_torque_nm"][0] == pytest.approx(-13 * 2 * math.pi / 2, abs=1e-3)
    assert record["torque_nm"][0] == -25.0


def test_a_record_stays_in_out_and_nowhere_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    out = tmp_path / "out"
    kept = lashloop.run(SCENARIO, set=SHORT, device="inproc", out=out)
    again = lashloop.run(SCENARIO, set=SHORT, device="inproc")
    assert (kept.folder, again.folder) == (out, None)
    np.testing.assert_array_equal(lashloop.Record.read(out)["torque_nm"], again["torque_nm"])
    assert list(temporary.iterdir()) == []


def test_a_drive_of_this_package_has_the_torque_bits_of_the_firmware() -> None:
    firmware = lashloop.run(SCENARIO, set=SHORT, device="inproc")
    ours = lashloop.run(SCENARIO, set=SHORT, device=Drive([PD], board="here"))
    assert ours.summary["torque_sha256"] == firmware.summary["torque_sha256"]
    assert "here" in ours.summary["device"]
    for name in ("drive.load_error_rad", "drive.elastic_error_nm", "drive.measured_twist_rad"):
        np.testing.assert_array_equal(ours[name], firmware[name])


class Constant:
    """A law with a constant torque, which fails at a step."""

    def __init__(self, torque_nm: float, fails_at: float) -> None:
        """Set the torque and the step."""
        self._torque_nm, self._fails_at, self._step = torque_nm, fails_at, 0

    def step(self, sample: ControlInput) -> ControlOutput:
        """Return the torque."""
        del sample
        self._step += 1
        if self._step == self._fails_at:
            raise ArithmeticError("the law has failed")
        return ControlOutput(self._torque_nm, {"steps_done": float(self._step)})


def constant(fails_at: float = math.inf) -> Drive:
    """A drive with that law."""
    torque = f32("constant_nm", "N m", 0.5, -1.0, 1.0)
    law = ControlLaw(
        name="constant",
        parameters=(torque,),
        signals=(declared("steps_done", ""),),
        build=lambda parameters: Constant(parameters["constant_nm"], fails_at),
    )
    return Drive([law])


OWN = {"run.duration_s": 1.1, "controller.name": "constant", "controller.parameters": {"constant_nm": -0.25}}


def test_a_law_of_one_s_own_has_its_parameter_and_its_signal_in_the_record() -> None:
    record = lashloop.run(SCENARIO, set=OWN, device=constant())
    assert set(record["torque_nm"]) == {-0.25}
    np.testing.assert_array_equal(record["drive.steps_done"], np.arange(1100) // 10 * 10 + 1)
    assert record.units["drive.steps_done"] == ""


def test_an_error_of_a_law_is_raised_in_place_of_the_program_s_report() -> None:
    with pytest.raises(ArithmeticError, match="the law has failed"):
        lashloop.run(SCENARIO, set=OWN, device=constant(fails_at=7))


def test_a_wrong_scenario_is_an_error_with_the_text_of_the_program(tmp_path: Path) -> None:
    with pytest.raises(lashloop.ScenarioError, match="duration_s") as it:
        lashloop.run(SCENARIO, set={"run.duration": 1}, device="inproc")
    assert it.value.code == 2
    assert str(it.value).startswith("--set run.duration=1: ")
    with pytest.raises(lashloop.ScenarioError, match=r"no-such\.toml"):
        lashloop.run(tmp_path / "no-such.toml")
    with pytest.raises(lashloop.ScenarioError, match=r"no law of this name; it has constant"):
        lashloop.run(SCENARIO, set=SHORT | {"controller.name": "pd"}, device=constant())


def test_a_missing_drive_is_a_device_error_with_the_text_of_the_program() -> None:
    with pytest.raises(lashloop.DeviceError, match=r"^/dev/nothing: ") as it:
        lashloop.run(SCENARIO, device="/dev/nothing")
    assert it.value.code == 4


def script(path: Path, text: str) -> Path:
    """An executable Python program."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!{sys.executable}\n{text}")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


SLEEPER = """
import pathlib, signal, sys, time
out = pathlib.Path(sys.argv[-1])
def end(*_):
    (out / "ended").touch()
    sys.exit(0)
signal.signal(signal.SIGTERM, end)
signal.signal(signal.SIGINT, signal.SIG_IGN)
(out / "started").touch()
time.sleep(60)
"""


def test_a_run_beyond_its_time_is_ended_in_order(tmp_path: Path) -> None:
    sleeper = script(tmp_path / "sleeper", SLEEPER)
    with pytest.raises(lashloop.RunTimeoutError, match=r"friction-before.toml took more than 2 s and was ended: raise"):
        lashloop.run(SCENARIO, out=tmp_path, program=sleeper, timeout_s=2.0)
    assert (tmp_path / "ended").exists()


def test_an_interrupt_ends_the_program_in_order(tmp_path: Path) -> None:
    sleeper = script(tmp_path / "sleeper", SLEEPER)

    def interrupt() -> None:
        deadline = threading.Event()
        while not (tmp_path / "started").exists():
            deadline.wait(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        threading.Thread(target=interrupt, daemon=True).start()
        with pytest.raises(KeyboardInterrupt):
            lashloop.run(SCENARIO, out=tmp_path, program=sleeper, timeout_s=SOON_S)
    finally:
        signal.signal(signal.SIGINT, before)
    assert (tmp_path / "ended").exists()


def test_a_program_that_crashes_is_an_error_with_its_exit_code(tmp_path: Path) -> None:
    crashing = script(tmp_path / "crashing", "import sys; sys.exit('panicked')")
    with pytest.raises(lashloop.RecordError, match=r"record\.json: can't be read"):
        lashloop.run(SCENARIO, program=crashing)
    killed = script(tmp_path / "killed", "import os; os.kill(os.getpid(), 9)")
    with pytest.raises(lashloop.ProgramError, match="exit code -9 and no text") as it:
        lashloop.run(SCENARIO, program=killed)
    assert it.value.code == -9


@pytest.mark.parametrize(
    "value",
    [
        "",
        'a "b" \\ ü\n\t\x7f\x01',
        True,
        False,
        0,
        -3,
        2**40,
        0.1,
        1e-9,
        -1e300,
        [1, [2.5, "x"]],
        {"a b": {"c": 1}},
        [],
    ],
)
def test_settings_are_read_back_as_toml(value: Any) -> None:
    assert tomli.loads(f"key = {toml(value)}")["key"] == value


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (math.inf, "inf"),
        (-math.inf, "-inf"),
        (math.nan, "nan"),
        (np.float64(0.25), "0.25"),
        (np.int64(7), "7"),
        (np.bool_(True), "true"),
        (Path("a/b"), '"a/b"'),
        ((1, 2), "[1, 2]"),
        (np.array([0.5, 1.0]), "[0.5, 1.0]"),
    ],
)
def test_settings_may_be_numbers_of_numpy(value: Any, expected: str) -> None:
    assert toml(value) == expected


@pytest.mark.parametrize("value", [None, 1j, object(), b"bytes"])
def test_a_setting_that_toml_lacks_is_named(value: Any) -> None:
    with pytest.raises(TypeError, match="which a scenario can't have"):
        toml(value)


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Path]:
    """A place without any program; the function adds one."""
    monkeypatch.delenv(VARIABLE)
    monkeypatch.delenv("CARGO_TARGET_DIR", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.setattr("lashloop.program.__file__", str(tmp_path / "package/program.py"))
    work = tmp_path / "checkout/deep"
    work.mkdir(parents=True)
    monkeypatch.chdir(work)

    def add(place: str, age_s: float = 0.0) -> Path:
        path = script(tmp_path / place / "lashloop", "")
        stamp = path.stat().st_mtime - age_s
        os.utime(path, (stamp, stamp))
        return path

    return add


def test_the_program_is_found_in_the_documented_order(
    elsewhere: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(lashloop.ProgramNotFoundError, match="there is no program lashloop: build it with `cargo build"):
        find_program()
    old = elsewhere("checkout/target/release", age_s=100.0)
    assert find_program() == old
    newer = elsewhere("checkout/target/debug")
    assert find_program() == newer
    elsewhere("package/target/debug", age_s=50.0)
    assert find_program() == newer
    own = elsewhere("own-target/debug", age_s=-50.0)
    monkeypatch.setenv("CARGO_TARGET_DIR", str(own.parents[1]))
    assert find_program() == own
    installed = elsewhere("bin", age_s=1000.0)
    assert find_program() == installed
    monkeypatch.setenv(VARIABLE, str(old))
    assert find_program() == old
    monkeypatch.setenv(VARIABLE, "/nowhere/lashloop")
    with pytest.raises(lashloop.ProgramNotFoundError, match="LASHLOOP_BIN is /nowhere/lashloop, which isn't a file"):
        find_program()
