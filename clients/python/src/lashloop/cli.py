"""`python -m lashloop`: emulate a drive, or query one.

Exit codes are those of the bench: 0 for success, 2 for bad usage, 4 for a failure of device or link.
"""

from __future__ import annotations

import argparse
import os
import sys
from typing import TYPE_CHECKING

from serial.tools import list_ports

from lashloop.control.cascade import PD
from lashloop.drive import Drive, serve
from lashloop.errors import LashloopError
from lashloop.host import Host, ParameterRangeError, UnknownParameterError
from lashloop.link import DEFAULT_BAUD, PseudoTerminal, StandardStreams, open_port

if TYPE_CHECKING:
    from collections.abc import Sequence

    from lashloop.link import Link

_USAGE = 2
_DEVICE = 4
_INTERRUPTED = 130


def main(words: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    arguments = _parser().parse_args(words)
    try:
        arguments.run(arguments)
    except (UnknownParameterError, ParameterRangeError) as error:
        return _report(error, _USAGE)
    except LashloopError as error:
        return _report(error, _DEVICE)
    except KeyboardInterrupt:
        return _INTERRUPTED
    except BrokenPipeError:
        # The reader has closed the pipe; Python must write nothing when it closes its output.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0


def _report(error: Exception, code: int) -> int:
    print(f"lashloop: {error}", file=sys.stderr)
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m lashloop",
        description="Host and drive of the Lashloop bench, over serial ports and pseudo-terminals.",
        epilog="Exit codes: 0 success, 2 bad usage, 4 failure of device or link.",
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    drive = commands.add_parser(
        "drive",
        help="emulate a drive until killed",
        description="Emulate a drive with the cascaded PD law until killed. Without options the drive opens a "
        "pseudo-terminal and prints its path on standard output, for `lashloop run SCENARIO --device PATH`. With "
        '--stdio the bench starts the drive: `lashloop run SCENARIO --device "exec:python -m lashloop drive --stdio"`.',
    )
    _add_port(drive, required=False, meaning="serial port to the host; default: a new pseudo-terminal")
    drive.add_argument("--stdio", action="store_true", help="serve standard input and output, until the host closes it")
    drive.set_defaults(run=_drive)

    ports = commands.add_parser("ports", help="list the serial ports", description="List the serial ports.")
    ports.set_defaults(run=_ports)

    identify = commands.add_parser(
        "identify", help="print the identity of a drive", description="Open a session and print the identity."
    )
    _add_port(identify)
    identify.set_defaults(run=_identify)

    signals = commands.add_parser(
        "signals",
        help="list the signals of a drive",
        description="Print every signal with its unit and the laws that have it.",
    )
    _add_port(signals)
    signals.set_defaults(run=_signals)

    parameters = commands.add_parser(
        "parameters",
        help="list or set the parameters of a drive",
        description="Print every parameter with value, default, range and unit, or choices; NAME=VALUE sets it first. "
        "The values hold until a reset of the drive, which `lashloop run` sends before a run.",
    )
    _add_port(parameters)
    parameters.add_argument(
        "settings", nargs="*", type=_setting, metavar="NAME=VALUE", help="torque_limit_nm=5, controller=pd"
    )
    parameters.set_defaults(run=_parameters)
    return parser


def _add_port(
    parser: argparse.ArgumentParser, *, required: bool = True, meaning: str = "serial port to the drive"
) -> None:
    parser.add_argument("--port", required=required, metavar="TTY", help=meaning)
    parser.add_argument(
        "--baud",
        type=_baud,
        default=DEFAULT_BAUD,
        metavar="N",
        help="bit rate of a serial port, in bit/s (%(default)s)",
    )


def _baud(text: str) -> int:
    if not text.isdecimal() or not 1200 <= int(text) <= 12_000_000:
        raise argparse.ArgumentTypeError(f"{text} is not a number from 1200 to 12000000")
    return int(text)


def _setting(text: str) -> tuple[str, float | str]:
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"{text} isn't a setting; expected NAME=VALUE")
    try:
        return name, float(value)
    except ValueError:
        # A choice by its name.
        return name, value


def _drive(arguments: argparse.Namespace) -> None:
    line = _drive_line(arguments)
    if isinstance(line, PseudoTerminal):
        # The parent process waits for this line, so it is flushed.
        print(line.path, flush=True)
        if sys.stderr.isatty():
            hint = "The drive is ready. In another shell: lashloop run SCENARIO.toml --device"
            print(f"{hint} {line.path}", file=sys.stderr)
    serve(line, Drive([PD]))


def _drive_line(arguments: argparse.Namespace) -> Link:
    if arguments.stdio:
        return StandardStreams()
    return open_port(arguments.port, arguments.baud) if arguments.port else PseudoTerminal()


def _ports(_: argparse.Namespace) -> None:
    ports = sorted(list_ports.comports())
    for port in ports:
        usb = "not on USB" if port.vid is None else f"USB {port.vid:04x}:{port.pid:04x}  {port.description}"
        print(f"{port.device:<16} {usb}")
    if not ports:
        print(
            "No serial port found. Without a board, `python -m lashloop drive` emulates a drive on a pseudo-terminal."
        )


def _identify(arguments: argparse.Namespace) -> None:
    with Host.open(arguments.port, arguments.baud) as host:
        identity = host.identity
        dirty = ", built from changed or unknown sources" if identity.dirty else ""
        print(f"board                 {identity.board}")
        print(f"firmware              {identity.firmware}, build {identity.build_id:08x}{dirty}")
        print(f"protocol version      {identity.protocol_version}.{identity.minor_version}")
        print(f"capabilities          {identity.capabilities}")
        print(f"state                 {identity.state}")
        if host.fault is not None:
            print(f"fault                 {host.fault}")
        print(f"control period        {identity.period_us} us")
        print(f"motor encoder         {identity.motor_counts_per_rev} counts/rev")
        print(f"load encoder          {identity.load_counts_per_rev} counts/rev")
        print(f"control laws          {', '.join(host.laws)}")
        print(f"signals               {identity.signal_count}")
        print(f"parameters            {identity.parameter_count}")


def _signals(arguments: argparse.Namespace) -> None:
    with Host.open(arguments.port, arguments.baud) as host:
        print(f"{'name':<32} {'unit':<10} laws")
        for it in host.signals.values():
            print(f"{it.name:<32} {it.unit:<10} {_laws(it.laws, host)}")


def _parameters(arguments: argparse.Namespace) -> None:
    with Host.open(arguments.port, arguments.baud) as host:
        # All values are checked before the first is set, so that a typing error changes nothing.
        for name, value in arguments.settings:
            host.parameter(name).value(value)
        for name, value in arguments.settings:
            host.set(name, value)
        print(f"{'name':<28} {'value':>12} {'default':>12}  {'live':<4} {'allowed':<32} laws")
        for it in host.parameters.values():
            live = "yes" if it.live else "no"
            value, default = it.text(host.get(it.name)), it.text(it.default.value)
            print(f"{it.name:<28} {value:>12} {default:>12}  {live:<4} {it.allowed:<32} {_laws(it.laws, host)}")


def _laws(names: Sequence[str], host: Host) -> str:
    return "all" if len(names) == len(host.laws) else ", ".join(names)
