"""A run as Foxglove, Lichtblick and PlotJuggler watch it, by the client of `@foxglove/ws-protocol`."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from support import WORKSPACE, program
from test_readers import READERS, SETTINGS, Message, by_python

TOKEN = "0123456789abcdef"


def watched(out: Path, subprotocol: str) -> list[list[Any]]:
    """Runs a scenario, and returns what a client of the protocol prints."""
    settings = [f"--set={name}={json.dumps(value)}" for name, value in SETTINGS.items() if name != "fault"]
    settings += ["--set=fault=[{ kind = 'torque-gain', gain = 0.9, at_s = 0.3, for_s = 0.4 }]"]
    scenario = WORKSPACE / "scenarios/shaft-merzouki.toml"
    words: list[str | Path] = [program(), "run", scenario, *settings, "--device", "inproc", "--out", out]
    live = ["--live", f"--live-token={TOKEN}", "--live-wait", "60"]
    run = subprocess.Popen([*words, *live], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert run.stdout is not None
    url = run.stdout.readline().split()[1].replace("http://", "ws://")
    watch: list[str | Path] = [
        Path(sys.executable).parent / "node",
        Path(__file__).parent / "readers/watch_run.cjs",
        url,
        subprotocol,
    ]
    environment = os.environ | {"NODE_PATH": str(READERS / "node_modules")}
    ended = subprocess.run(watch, env=environment, capture_output=True, text=True, check=False, timeout=120)
    _, errors = run.communicate(timeout=120)
    assert run.returncode == 0, errors
    assert ended.returncode == 0, ended.stderr
    return [json.loads(line) for line in ended.stdout.splitlines()]


def plain(values: dict[str, Any]) -> dict[str, Any]:
    """The values, with a text for one that isn't a number."""
    return {name: "nan" if isinstance(it, float) and math.isnan(it) else it for name, it in values.items()}


@pytest.mark.parametrize("subprotocol", ["foxglove.sdk.v1", "foxglove.websocket.v1"])
def test_a_client_gets_every_message_of_the_record_and_the_verdict(tmp_path: Path, subprotocol: str) -> None:
    info, *lines = watched(tmp_path / "run", subprotocol)
    scenario = f"{WORKSPACE}/scenarios/shaft-merzouki.toml"
    assert info[:3] == ["serverInfo", f"lashloop: {scenario}", []]
    assert info[3]["scenario"] == scenario
    statuses = [line[1:] for line in lines if line[0] == "status"]
    assert [level for level, _ in statuses] == [1, 0], "a request that isn't served, and PASS"
    assert "subscribe and unsubscribe only" in statuses[0][1]
    assert statuses[1][1] == "PASS"

    live = [Message(topic, int(time), 0, values) for kind, topic, time, values in lines[1:-1] if kind == "message"]
    recorded = by_python(tmp_path / "run/run.mcap", is_reversed=False)
    # The run's start as the server has it is a moment before that of the record.
    starts = [next(it.log_ns for it in messages if it.topic == "/step") for messages in (live, recorded)]
    for topic in ("/step", "/drive", "/fault"):
        of_live, of_record = (
            [(it.log_ns - start, plain(it.values)) for it in messages if it.topic == topic]
            for messages, start in zip((live, recorded), starts, strict=True)
        )
        assert of_live == of_record, topic
    assert len(live) == len(recorded)
