"""The recipes for build servers in `docs/ci`: their schemas, and their commands on this machine."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from support import SOON_S
from support import program as lashloop_program

ROOT = Path(__file__).parents[3]
RECIPES = ROOT / "docs" / "ci"
ACTION = ROOT / "action.yml"
# The schemas of the services are part of check-jsonschema.
SCHEMAS = {
    "github.yml": ["--builtin-schema", "vendor.github-workflows"],
    "gitlab.yml": ["--builtin-schema", "vendor.gitlab-ci", "--data-transform", "gitlab-ci"],
}

MAKEFILE = "all:\n\ttouch drive\n"


def load(name: str) -> Any:
    return YAML(typ="safe").load(RECIPES / name)


def check(schema: list[str], recipe: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "check_jsonschema", *schema, str(recipe)]
    return subprocess.run(command, capture_output=True, text=True, timeout=SOON_S, check=False)


def scripts(name: str) -> list[str]:
    """Return the shell commands of a recipe, one string for each shell."""
    recipe = load(name)
    if name == "github.yml":
        return [step["run"] for step in recipe["jobs"]["drive"]["steps"] if "run" in step]
    return ["\n".join(recipe["lashloop"]["before_script"] + recipe["lashloop"]["script"])]


@pytest.mark.parametrize("name", SCHEMAS)
def test_a_recipe_has_the_keys_of_its_service(name: str, tmp_path: Path) -> None:
    checked = check(SCHEMAS[name], RECIPES / name)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    wrong = tmp_path / name
    text = (RECIPES / name).read_text()
    wrong.write_text(text.replace("timeout-minutes:", "timeout-hours:").replace("expire_in:", "expires:"))
    assert wrong.read_text() != text
    assert check(SCHEMAS[name], wrong).returncode == 1, "a wrong key is found"


@pytest.mark.parametrize("name", SCHEMAS)
def test_the_commands_of_a_recipe_run_as_they_are(name: str, tmp_path: Path) -> None:
    url, digest = pack_program(tmp_path)
    project = make_project(tmp_path)
    environment = {"LASHLOOP_URL": url, "LASHLOOP_SHA256": digest, "DEVICE": "inproc", "CI_PROJECT_DIR": str(project)}
    run_steps([(script, environment) for script in scripts(name)], tmp_path)
    assert "<testsuites" in (project / "out" / "scenarios.xml").read_text()
    assert "<html" in (project / "out" / "index.html").read_text()


def test_the_action_has_the_keys_of_its_service(tmp_path: Path) -> None:
    schema = ["--builtin-schema", "vendor.github-actions"]
    checked = check(schema, ACTION)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    wrong = tmp_path / "action.yml"
    wrong.write_text(ACTION.read_text().replace("using: composite", "uses: composite"))
    assert check(schema, wrong).returncode == 1, "a wrong key is found"


def test_the_steps_of_the_action_run_as_they_are(tmp_path: Path) -> None:
    action = YAML(typ="safe").load(ACTION)
    inputs = {name: value.get("default") for name, value in action["inputs"].items()}
    inputs["url"], inputs["sha256"] = pack_program(tmp_path)
    inputs["device"] = "inproc"
    inputs["scenarios"] = "scenarios\nscenarios/commission.toml scenarios\n"
    project = make_project(tmp_path)

    def filled(text: str) -> str:
        for name, value in inputs.items():
            text = text.replace(f"${{{{ inputs.{name} }}}}", value)
        assert "${{" not in text, f"{text} has an input that the action doesn't declare"
        return text

    steps = action["runs"]["steps"]
    assert {step["shell"] for step in steps} == {"bash"}
    run_steps(
        [(step["run"], {name: filled(value) for name, value in step["env"].items()}) for step in steps],
        tmp_path,
    )
    out = project / inputs["out"]
    assert "<testsuites" in (out / "scenarios.xml").read_text()
    assert "<testsuites" in (out / "conformance.xml").read_text()
    assert "<html" in (out / "index.html").read_text()


def pack_program(tmp_path: Path) -> tuple[str, str]:
    """Return the address and the digest of an archive with the program."""
    archive = tmp_path / "archive.tar.gz"
    with tarfile.open(archive, "w:gz", compresslevel=1) as packed:
        packed.add(lashloop_program(), "lashloop-0/lashloop")
    return archive.as_uri(), sha256(archive.read_bytes()).hexdigest()


def make_project(tmp_path: Path) -> Path:
    """Return the folder of a user's project with a drive and a scenario."""
    project = tmp_path / "project"
    (project / "drive").mkdir(parents=True)
    (project / "drive" / "Makefile").write_text(MAKEFILE)
    (project / "scenarios").mkdir()
    shutil.copy(ROOT / "scenarios" / "commission.toml", project / "scenarios")
    return project


def run_steps(steps: list[tuple[str, dict[str, str]]], tmp_path: Path) -> None:
    """Run scripts in the project, each with its environment and the folders that those before it added to the path."""
    path_file = tmp_path / "path"
    path_file.write_text("")
    for script, environment in steps:
        added = ":".join(path_file.read_text().split())
        path = f"{added}:{os.environ['PATH']}" if added else os.environ["PATH"]
        own = {"HOME": str(tmp_path / "home"), "GITHUB_PATH": str(path_file), "PATH": path}
        ended = subprocess.run(
            ["bash", "-e", "-o", "pipefail", "-c", script],
            cwd=tmp_path / "project",
            env=os.environ | own | environment,
            capture_output=True,
            text=True,
            timeout=SOON_S,
            check=False,
        )
        assert ended.returncode == 0, f"{script}\n{ended.stdout}{ended.stderr}"


def test_the_hook_of_pre_commit_names_a_command_of_the_program() -> None:
    [repository] = load("pre-commit-config.yaml")["repos"]
    [hook] = repository["hooks"]
    command = [str(lashloop_program()), *hook["entry"].split()[1:]]
    assert subprocess.run(command, timeout=SOON_S, check=False, cwd=ROOT).returncode == 0
