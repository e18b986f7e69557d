"""`python -m lashloop` as a user runs it."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

from lashloop.host import Host
from support import PARAMETER_COUNT, PATIENT, SIGNAL_COUNT, SOON_S, Program, python_drive


def run(*words: str) -> tuple[int, str, str]:
    """Run the command and return exit code, standard output and standard error."""
    ended = subprocess.run(
        [sys.executable, "-m", "lashloop", *words], capture_output=True, text=True, timeout=SOON_S, check=False
    )
    return ended.returncode, ended.stdout, ended.stderr


def test_a_drive_prints_its_path_and_reports_its_identity() -> None:
    with python_drive() as program:
        code, output, _ = run("identify", "--port", program.path)
        assert code == 0
        rows = (line.split("  ", maxsplit=1) for line in output.splitlines())
        lines = {name: text.strip() for name, text in rows}
        assert lines == {
            "board": "python",
            "firmware": "0.1.0, build 00000000, built from changed or unknown sources",
            "protocol version": "1.0",
            "capabilities": "device time",
            "state": "Idle",
            "control period": "1000 us",
            "motor encoder": "131072 counts/rev",
            "load encoder": "131072 counts/rev",
            "control laws": "pd",
            "signals": str(SIGNAL_COUNT),
            "parameters": str(PARAMETER_COUNT),
        }


def test_identify_names_a_latched_fault() -> None:
    with python_drive() as program:
        with Host.open(program.path, limits=PATIENT) as host:
            host.emergency_stop()
        code, output, _ = run("identify", "--port", program.path)
    assert code == 0
    assert "fault                 EmergencyStop (sequence 0)\n" in output


def test_parameters_are_listed_set_and_retained() -> None:
    with python_drive() as program:
        code, output, _ = run("parameters", "--port", program.path, "torque_limit_nm=2.5", "controller=pd")
        assert code == 0
        for text in (output, run("parameters", "--port", program.path)[1]):
            rows = {line.split()[0]: line.split()[1:] for line in text.splitlines()}
            assert len(rows) == 1 + PARAMETER_COUNT
            assert rows["torque_limit_nm"] == ["2.5", "20", "no", "0", "to", "1000", "N", "m", "all"]
            assert rows["controller"] == ["pd", "pd", "no", "pd", "all"]
            assert rows["k_d1"][0] == "0.01"


@pytest.mark.parametrize(
    ("setting", "output"),
    [
        ("torque_limit=5", "lashloop: the drive has no parameter torque_limit; did you mean torque_limit_nm"),
        ("torque_limit_nm=2000", "lashloop: torque_limit_nm = 2000.0: the drive accepts 0 to 1000 N m\n"),
        ("torque_limit_nm", "torque_limit_nm isn't a setting; expected NAME=VALUE\n"),
        ("torque_limit_nm=", "torque_limit_nm= isn't a setting; expected NAME=VALUE\n"),
        ("torque_limit_nm=five", "lashloop: torque_limit_nm = 'five': the drive accepts 0 to 1000 N m\n"),
        ("controller=merzouki", "lashloop: controller = 'merzouki': the drive accepts pd\n"),
    ],
)
def test_invalid_settings_are_named_and_set_nothing(setting: str, output: str) -> None:
    with python_drive() as program:
        code, _, error = run("parameters", "--port", program.path, "k_p1=2", setting)
        assert code == 2
        assert output in error
        _, text, _ = run("parameters", "--port", program.path)
        assert next(line.split()[1] for line in text.splitlines() if line.startswith("k_p1 ")) == "1"


def test_signals_are_listed_with_unit_and_laws() -> None:
    with python_drive() as program:
        code, output, _ = run("signals", "--port", program.path)
    assert code == 0
    rows = [line.split() for line in output.splitlines()]
    assert rows[:2] == [["name", "unit", "laws"], ["requested_torque_nm", "N", "m", "all"]]
    assert ["load_error_rad", "rad", "all"] in rows
    assert len(rows) == 1 + SIGNAL_COUNT


def test_a_missing_port_is_named() -> None:
    for command in ("identify", "parameters", "signals", "drive"):
        code, output, error = run(command, "--port", "/dev/nothing")
        assert (code, output) == (4, "")
        assert error.startswith("lashloop: the port /dev/nothing can't be opened: ")


def test_a_hung_drive_times_out() -> None:
    with python_drive() as program:
        program.signal(signal.SIGSTOP)
        code, _, error = run("identify", "--port", program.path)
        assert code == 4
        assert error == "lashloop: the drive was silent for 2.5 s after Hello (no good frame received, 0 bad ones)\n"


def test_an_interrupted_drive_ends_without_a_traceback() -> None:
    # Restores the default handler: a test run in the background inherits ignored interrupts.
    as_from_a_shell = (
        "import runpy, signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
        "runpy.run_module('lashloop', run_name='__main__', alter_sys=True)"
    )
    with Program([sys.executable, "-c", as_from_a_shell, "drive"]) as program:
        program.signal(signal.SIGINT)
        assert program.ended() == (130, "")


@pytest.mark.parametrize("words", [[], ["fly"], ["identify"], ["drive", "--baud", "9"], ["drive", "--baud", "fast"]])
def test_bad_usage_prints_the_usage(words: list[str]) -> None:
    code, output, error = run(*words)
    assert (code, output) == (2, "")
    assert error.startswith("usage: python -m lashloop")


def test_every_command_has_help_and_ports_prints_a_line() -> None:
    for command in ("drive", "ports", "identify", "parameters", "signals"):
        code, output, _ = run(command, "--help")
        assert code == 0
        assert output.startswith(f"usage: python -m lashloop {command}")
        assert command in run("--help")[1]
    code, output, _ = run("ports")
    assert code == 0
    assert output


def test_a_closed_output_pipe_is_no_error() -> None:
    with python_drive() as program:
        words = [sys.executable, "-m", "lashloop", "parameters", "--port", program.path]
        pipe = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert pipe.stdout is not None
        assert pipe.stderr is not None
        pipe.stdout.close()
        assert pipe.stderr.read() == ""
        pipe.stderr.close()
        assert pipe.wait(SOON_S) == 0
