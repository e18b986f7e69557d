"""Host and drive of the Lashloop hardware-in-the-loop bench, and its runs from Python.

| module | is |
|---|---|
| `runner`, `program` | `run`: a scenario on a drive, by the `lashloop` program |
| `record`, `table`, `plot` | `Record`: a run as arrays with units, and its diagrams |
| `messages`, `enums`, `layout` | messages, lists of values, types of fields, written from `docs/protocol.md` |
| `frames`, `decoder` | frames: COBS, CRC, resynchronisation |
| `link` | serial ports and pseudo-terminals |
| `host` | the host's side of the protocol |
| `declarations` | parameters and signals of a law, each declared once |
| `drive` | a drive: state machine without I/O, and the loop that runs it on a link |
| `control` | control laws of a drive |
| `fmu` | `python -m lashloop.fmu`: FMUs for model exchange or of FMI 1.0 as plants |
"""

from lashloop.errors import LashloopError
from lashloop.plot import PlotError
from lashloop.program import ProgramNotFoundError, find_program
from lashloop.record import Record, Verdict
from lashloop.runner import DeviceError, ProgramError, RunTimeoutError, ScenarioError, run
from lashloop.table import RecordError, Table, UnknownColumnError

__all__ = [
    "DeviceError",
    "LashloopError",
    "PlotError",
    "ProgramError",
    "ProgramNotFoundError",
    "Record",
    "RecordError",
    "RunTimeoutError",
    "ScenarioError",
    "Table",
    "UnknownColumnError",
    "Verdict",
    "find_program",
    "run",
]
