"""Diagrams of a record."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lashloop.errors import LashloopError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from lashloop.table import Table

_WIDTH_IN, _HEIGHT_IN = 8.0, 2.6
"""Size of one diagram, in inches."""


class PlotError(LashloopError):
    """Nothing can be drawn."""


def draw(
    trace: Table,
    units: Mapping[str, str],
    columns: Sequence[str],
    from_s: float | None,
    to_s: float | None,
    axes: Axes | None,
) -> Figure:
    """See `Record.plot`."""
    if not columns:
        raise PlotError(f"no column to draw; the record has {', '.join(trace)}")
    times_s = trace["time_s"]
    inside = (times_s >= (times_s[0] if from_s is None else from_s)) & (
        times_s <= (times_s[-1] if to_s is None else to_s)
    )
    if not inside.any():
        raise PlotError(f"no step from {from_s} s to {to_s} s; the run is from {times_s[0]} s to {times_s[-1]} s")
    values = {name: trace[name][inside] for name in columns}
    drawn = list(dict.fromkeys(units[name] for name in columns))
    all_axes = [axes] * len(drawn) if axes is not None else _diagrams(len(drawn))
    for unit, diagram in zip(drawn, all_axes, strict=True):
        for name in (it for it in columns if units[it] == unit):
            # A torque is held for a period, and telemetry until the next.
            diagram.plot(times_s[inside], values[name], label=name, drawstyle="steps-post", linewidth=1.0)
        diagram.legend(loc="best", fontsize="small")
        diagram.grid(visible=True, alpha=0.3)
        diagram.set_ylabel(unit if axes is None else ", ".join(filter(None, drawn)))
    all_axes[-1].set_xlabel("time, s")
    figure = all_axes[0].get_figure(root=True)
    assert figure is not None
    return figure


def _diagrams(count: int) -> list[Axes]:
    try:
        # Imported here, because only a plot needs it.
        from matplotlib import pyplot as plt
    except ImportError as error:
        raise PlotError("a plot needs matplotlib: `pip install matplotlib`") from error
    size = (_WIDTH_IN, _HEIGHT_IN * count)
    _, axes = plt.subplots(count, 1, sharex=True, squeeze=False, figsize=size, layout="constrained")
    return list(axes[:, 0])
