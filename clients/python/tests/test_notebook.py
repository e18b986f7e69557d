"""The example notebook runs from its first cell to its last, and stores no outputs."""

from __future__ import annotations

import ast
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

from lashloop.program import VARIABLE
from support import WORKSPACE, program

NOTEBOOK = WORKSPACE / "clients/python/examples/first-run.ipynb"
LIMIT_S = 100


@pytest.fixture(scope="module")
def executed() -> Any:
    """The notebook with the outputs of a run."""
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv(VARIABLE, str(program()))
        resources = {"metadata": {"path": str(NOTEBOOK.parent)}}
        NotebookClient(notebook, timeout=LIMIT_S, kernel_name="python3", resources=resources).execute()
    return notebook


def output(notebook: Any, start: str) -> str:
    """Text that the cell with this start has printed or returned."""
    (cell,) = (it for it in notebook.cells if it.cell_type == "code" and start in it.source)
    return "".join(it.get("text", "") or it.data["text/plain"] for it in cell.outputs)


def figures(notebook: Any) -> list[str]:
    """The figures of the notebook, as PNG."""
    outputs = (output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs)
    return [it.data["image/png"] for it in outputs if "image/png" in it.get("data", {})]


def test_the_notebook_gets_the_numbers_of_the_paper(executed: Any) -> None:
    verdict, static_error_rad = output(executed, "print(record.verdict").split("\n")[0].split()
    assert verdict == "PASS"
    assert abs(float(static_error_rad)) < 0.01
    # (3 F_c / N0 + 2 j0) / 13 for the friction of the scenario.
    errors = ast.literal_eval(output(executed, "frictions_nm = ["))
    assert errors[3.84] == pytest.approx(0.32, abs=0.002)
    assert errors[0.0] < errors[1.92] < errors[3.84]


def test_the_notebook_draws_each_figure_once(executed: Any) -> None:
    plots = sum("plot(" in cell.source for cell in executed.cells if cell.cell_type == "code")
    assert len(figures(executed)) == plots == 2


def test_the_notebook_stores_no_outputs() -> None:
    for cell in nbformat.read(NOTEBOOK, as_version=4).cells:
        if cell.cell_type == "code":
            assert (cell.outputs, cell.execution_count) == ([], None)
