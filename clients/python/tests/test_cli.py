"""`python -m lashloop` as a user runs it."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

from lashloop.host import Host
from support import PARAMETER_COUNT, SOON_S, Program, python_drive


def run(*words: str) -> tuple[int, str, str]:
    """Run it to its end and give exit code, standard output and standard error."""
    ended = subprocess.run(
        [sys.executable, "-m", "lashloop", *words], capture_output=True, text=True, timeout=SOON_S, check=False
    )
    return ended.returncode, ended.stdout, ended.stderr


def test_a_drive_prints_its_path_and_says_who_it_is() -> None:
    with python_drive() as program:
        code, said, _ = run("identify", "--port", program.path)
        assert code == 0
        lines = dict(line.split(maxsplit=1) for line in said.splitlines() if not line.startswith(("control", "pro")))
        assert (lines["board"], lines["state"], lines["parameters"]) == (
            "python",
            "Idle",
            str(PARAMETER_COUNT),
        )
        assert "control laws          Pd\n" in said
        assert "protocol version      1\n" in said


def test_a_drive_with_a_fault_says_which() -> None:
    with python_drive() as program:
        with Host.open(program.path) as host:
            host.emergency_stop()
        code, said, _ = run("identify", "--port", program.path)
    assert code == 0
    assert "fault                 EmergencyStop (sequence 0)\n" in said


def test_parameters_are_listed_and_set_and_stay() -> None:
    with python_drive() as program:
        code, said, _ = run("parameters", "--port", program.path, "torque_limit_nm=2.5", "telemetry_every=7")
        assert code == 0
        for text in (said, run("parameters", "--port", program.path)[1]):
            rows = {line.split()[0]: line.split()[1:] for line in text.splitlines()}
            assert len(rows) == 1 + PARAMETER_COUNT
            assert rows["torque_limit_nm"] == ["2.5", "20", "no", "0", "to", "1000", "N", "m"]
            assert rows["telemetry_every"][:3] == ["7", "10", "yes"]
            assert rows["k_d1"][0] == "0.01"


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("torque_limit=5", "lashloop: the drive has no parameter torque_limit; did you mean torque_limit_nm"),
        ("torque_limit_nm=2000", "lashloop: torque_limit_nm = 2000.0: the drive takes 0 to 1000 N m\n"),
        ("torque_limit_nm", "torque_limit_nm is no setting; it must be NAME=NUMBER\n"),
        ("torque_limit_nm=five", "torque_limit_nm=five is no setting; it must be NAME=NUMBER\n"),
    ],
)
def test_mistakes_are_named_and_set_nothing(setting: str, said: str) -> None:
    with python_drive() as program:
        code, _, error = run("parameters", "--port", program.path, "k_p1=2", setting)
        assert code == 2
        assert said in error
        _, text, _ = run("parameters", "--port", program.path)
        assert next(line.split()[1] for line in text.splitlines() if line.startswith("k_p1 ")) == "1"


def test_a_port_that_is_not_there_is_named() -> None:
    for command in ("identify", "parameters", "drive"):
        code, said, error = run(command, "--port", "/dev/nothing")
        assert (code, said) == (4, "")
        assert error.startswith("lashloop: the port /dev/nothing can't be opened: ")


def test_a_drive_that_hangs_is_given_up() -> None:
    with python_drive() as program:
        program.signal(signal.SIGSTOP)
        code, _, error = run("identify", "--port", program.path)
        assert code == 4
        assert error == "lashloop: the drive was silent for 2.5 s after Hello (no good frame received, 0 bad ones)\n"


def test_an_interrupted_drive_ends_without_a_traceback() -> None:
    # As a shell starts it: whoever runs these tests in the background has interrupts ignored, and that is inherited.
    as_from_a_shell = (
        "import runpy, signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
        "runpy.run_module('lashloop', run_name='__main__', alter_sys=True)"
    )
    with Program([sys.executable, "-c", as_from_a_shell, "drive"]) as program:
        program.signal(signal.SIGINT)
        assert program.ended() == (130, "")


@pytest.mark.parametrize("words", [[], ["fly"], ["identify"], ["drive", "--baud", "9"], ["drive", "--baud", "fast"]])
def test_bad_usage_is_told_with_the_usage(words: list[str]) -> None:
    code, said, error = run(*words)
    assert (code, said) == (2, "")
    assert error.startswith("usage: python -m lashloop")


def test_every_command_has_help_and_ports_always_says_something() -> None:
    for command in ("drive", "ports", "identify", "parameters"):
        code, said, _ = run(command, "--help")
        assert code == 0
        assert said.startswith(f"usage: python -m lashloop {command}")
        assert command in run("--help")[1]
    code, said, _ = run("ports")
    assert code == 0
    assert said


def test_a_reader_that_has_read_enough_is_no_error() -> None:
    with python_drive() as program:
        words = [sys.executable, "-m", "lashloop", "parameters", "--port", program.path]
        pipe = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert pipe.stdout is not None
        assert pipe.stderr is not None
        pipe.stdout.close()
        assert pipe.stderr.read() == ""
        pipe.stderr.close()
        assert pipe.wait(SOON_S) == 0
