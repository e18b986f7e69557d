"""The recipes for clusters in `docs/cluster`: their schemas, and their commands on this machine, shard by shard."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from support import SOON_S
from support import program as lashloop_program

ROOT = Path(__file__).parents[3]
RECIPES = ROOT / "docs" / "cluster"
# The schemas of the services are part of check-jsonschema.
SCHEMAS = {
    "github.yml": ["--builtin-schema", "vendor.github-workflows"],
    "gitlab.yml": ["--builtin-schema", "vendor.gitlab-ci", "--data-transform", "gitlab-ci"],
}
SHARDS = 4
# Of the 20 cases, to save time.
POINTS, CASES = 4, 8
Step = tuple[str, dict[str, str]]


def load(name: str) -> list[Any]:
    return list(YAML(typ="safe").load_all(RECIPES / name))


def github() -> tuple[list[Step], str]:
    """Return the command of each shard with its environment, and that of the merge."""
    [recipe] = load("github.yml")
    jobs = recipe["jobs"]
    [shard] = [step for step in jobs["shards"]["steps"] if "run" in step]
    [merge] = [step for step in jobs["merge"]["steps"] if "run" in step]
    assert shard["env"] == {"SHARD": "${{ matrix.shard }}"}
    assert jobs["merge"]["needs"] == "shards"
    numbers = jobs["shards"]["strategy"]["matrix"]["shard"]
    return [(shard["run"], {"SHARD": str(number)}) for number in numbers], merge["run"]


def gitlab() -> tuple[list[Step], str]:
    [recipe] = load("gitlab.yml")
    [command] = recipe["shards"]["script"]
    [merge] = recipe["merge"]["script"]
    total = recipe["shards"]["parallel"]
    numbers = range(1, total + 1)
    return [(command, {"CI_NODE_INDEX": str(number), "CI_NODE_TOTAL": str(total)}) for number in numbers], merge


def kubernetes() -> tuple[list[Step], str]:
    shards, merge = (job["spec"] for job in load("kubernetes.yml"))
    assert shards["completionMode"] == "Indexed"
    assert shards["parallelism"] == shards["completions"]
    [container] = shards["template"]["spec"]["containers"]
    [merging] = merge["template"]["spec"]["containers"]
    for spec in shards, merge:
        pod = spec["template"]["spec"]
        [mount] = pod["containers"][0]["volumeMounts"]
        assert mount["mountPath"] == "/results"
        assert mount["name"] == pod["volumes"][0]["name"]
    commands = [shlex.join(words) for words in (container["command"] + container["args"], merging["command"])]
    run, merged = (command.replace("/results", "out") for command in commands)
    indices = range(shards["completions"])
    return [(run, {"JOB_COMPLETION_INDEX": str(index)}) for index in indices], merged


@pytest.mark.parametrize("name", SCHEMAS)
def test_a_recipe_has_the_keys_of_its_service(name: str) -> None:
    command = [sys.executable, "-m", "check_jsonschema", *SCHEMAS[name], str(RECIPES / name)]
    checked = subprocess.run(command, capture_output=True, text=True, timeout=SOON_S, check=False)
    assert checked.returncode == 0, checked.stdout + checked.stderr


@pytest.mark.parametrize("recipe", [github, gitlab, kubernetes])
def test_the_shards_of_a_recipe_merge_to_one_table(recipe: Any, tmp_path: Path) -> None:
    shards, merge = recipe()
    assert len(shards) == SHARDS
    for folder in "campaigns", "scenarios":
        (tmp_path / folder).symlink_to(ROOT / folder)
    path = f"{lashloop_program().parent}:{os.environ['PATH']}"
    steps: list[Step] = [(f"{command} --points {POINTS}", environment) for command, environment in shards]
    for command, environment in [*steps, (merge, {})]:
        ended = subprocess.run(
            ["bash", "-e", "-o", "pipefail", "-c", command],
            cwd=tmp_path,
            env=os.environ | {"PATH": path} | environment,
            capture_output=True,
            text=True,
            timeout=SOON_S,
            check=False,
        )
        assert ended.returncode == 0, f"{command}\n{ended.stdout}{ended.stderr}"
    rows = (tmp_path / "out" / "results.csv").read_text().splitlines()[1:]
    assert [int(row.split(",")[0]) for row in rows] == list(range(CASES))
