"""The GitHub Action: its steps run as a runner runs them, in a scratch checkout, with a stand-in for GitHub's `gh`."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import pytest
import yaml
from forks import programs
from repository import ROOT

if TYPE_CHECKING:
    from pathlib import Path

ACTION: Final[dict[str, Any]] = yaml.safe_load((ROOT / "action.yml").read_text("utf-8"))
STEPS: Final[list[dict[str, Any]]] = ACTION["runs"]["steps"]
_EXPRESSION: Final = re.compile(r"\$\{\{(.*?)\}\}")
_NAME: Final = re.compile(r"\b(?:inputs|steps|github|runner)(?:\.[\w-]+)+")
_LAUNCH: Final = '<launch>\n  <include file="$(find bringup)/launch/missing.launch"/>\n</launch>\n'
_PACKAGE: Final = "<package><name>bringup</name><version>1.0.0</version></package>\n"


@dataclass
class Runner:
    """Runs the shell steps of the action; `calls` are the arguments passed to `gh`."""

    folder: Path
    inputs: dict[str, str]
    github: dict[str, str] = field(default_factory=dict)
    outputs: dict[str, str] = field(default_factory=dict)
    printed: str = ""

    def value(self, text: str) -> str:
        """Replace the expressions of a text with their values."""
        return _EXPRESSION.sub(lambda found: str(self.evaluated(found[1])), text)

    def evaluated(self, expression: str) -> object:
        """Evaluate an expression of GitHub: names, strings in single quotes, `==` and `&&`."""
        defaults = {name: one.get("default", "") for name, one in ACTION["inputs"].items()}
        inputs = {f"inputs.{name}": value for name, value in {**defaults, **self.inputs}.items()}
        names = {**inputs, **self.github, **self.outputs}
        python = _NAME.sub(lambda found: repr(names.get(found[0], "")), expression).replace("&&", " and ")
        return eval(python.strip(), {"__builtins__": {}})  # noqa: S307 - the text of action.yml

    def run(self, *ids: str) -> int:
        """Run the steps with these ids and return the exit code of the first that fails, else 0."""
        temporary = self.folder / "temporary"
        for name in ("summary", "output"):
            (temporary / name).write_text("", "utf-8")
        for step in STEPS:
            wanted = "if" not in step or self.evaluated(_EXPRESSION.sub(r"\1", step["if"]))
            if step.get("id") not in ids or not wanted:
                continue
            environment = {
                **os.environ,
                **{name: self.value(value) for name, value in step.get("env", {}).items()},
                "PATH": f"{self.folder / 'programs'}{os.pathsep}{os.environ['PATH']}",
                "RUNNER_TEMP": str(temporary),
                "GITHUB_OUTPUT": str(temporary / "output"),
                "GITHUB_STEP_SUMMARY": str(temporary / "summary"),
                "GITHUB_REPOSITORY": "robots/rover",
                "XDG_CACHE_HOME": str(temporary / "cache"),
                "GH_CALLS": str(temporary / "calls"),
            }
            command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]]
            checkout = self.folder / "checkout"
            ran = subprocess.run(
                command, cwd=checkout, env=environment, capture_output=True, text=True, check=False, timeout=600
            )
            self.printed += ran.stdout + ran.stderr
            lines = (temporary / "output").read_text("utf-8").splitlines()
            pairs = [line.split("=", 1) for line in lines]
            self.outputs |= {f"steps.{step['id']}.outputs.{name}": value for name, value in pairs}
            if ran.returncode:
                return ran.returncode
        return 0

    def summary(self) -> str:
        """Return the job summary written by the action."""
        return (self.folder / "temporary" / "summary").read_text("utf-8")

    def calls(self) -> list[list[str]]:
        """Return the calls of `gh`."""
        return [json.loads(line) for line in (self.folder / "temporary" / "calls").read_text("utf-8").splitlines()]


@pytest.fixture
def runner(tmp_path: Path) -> Runner:
    """Return a runner whose checkout has a launch file with an error; kg is that of these tests."""
    launch = tmp_path / "checkout" / "src" / "bringup" / "launch"
    launch.mkdir(parents=True)
    (launch / "all.launch").write_text(_LAUNCH, "utf-8")
    (launch.parent / "package.xml").write_text(_PACKAGE, "utf-8")
    others, own = tmp_path / "programs", tmp_path / "temporary" / "kg" / "bin"
    for folder in (others, own):
        folder.mkdir(parents=True)
    (own / "kg").symlink_to(programs() / "kg")
    write = 'import json, os, sys; open(os.environ["GH_CALLS"], "a").write(json.dumps(sys.argv[1:]) + "\\n")'
    noted = f'{shlex.quote(sys.executable)} -c {shlex.quote(write)} "$@"'
    _program(others / "gh", f'{noted}\n[ -z "$EARLIER" ] || echo "$EARLIER"')
    return Runner(tmp_path, {"paths": "src"})


def _program(path: Path, script: str) -> None:
    path.write_text(f"#!/usr/bin/env bash\n{script}\n", "utf-8")
    path.chmod(0o755)


def test_findings_are_annotated_and_fail_the_last_step(runner: Runner) -> None:
    """The line to fix is annotated, and summary, output, SARIF and exit code report the finding."""
    runner.inputs["sarif"] = "lint results.sarif"
    assert runner.run("lint", "judge") == 1
    assert "::error file=src/bringup/launch/all.launch,line=2,col=1,title=KG412::" in runner.printed
    assert "file not found: package://bringup/launch/missing.launch" in runner.summary()
    assert runner.outputs["steps.lint.outputs.findings"] == "true"
    results = json.loads((runner.folder / "checkout/lint results.sarif").read_text("utf-8"))["runs"][0]["results"]
    assert [one["ruleId"] for one in results] == ["KG412"]


def test_a_workspace_without_findings_passes(runner: Runner) -> None:
    """Without findings nothing is annotated and the summary has one sentence; further arguments reach `kg lint`."""
    runner.inputs["arguments"] = "--code\nKG401\n"
    assert runner.run("lint", "judge") == 0
    assert "::" not in runner.printed
    assert "No findings." in runner.summary()
    assert runner.outputs["steps.lint.outputs.findings"] == "false"


def test_findings_can_be_reported_without_failing(runner: Runner) -> None:
    """With `fail: false` the action passes despite findings."""
    runner.outputs["steps.lint.outputs.findings"] = "true"
    assert runner.run("judge") == 1
    runner.inputs["fail"] = "false"
    assert runner.run("judge") == 0


def test_an_error_of_kg_fails_the_lint_step(runner: Runner) -> None:
    """A missing baseline is an error, not a finding: it is shown, and no output is set."""
    runner.inputs |= {"baseline": "nothing.json", "fail": "false"}
    assert runner.run("lint", "judge") == 2
    assert "nothing.json" in runner.printed
    assert not runner.outputs


@pytest.mark.parametrize(
    ("earlier", "method", "address"),
    [
        ("", "POST", "repos/robots/rover/issues/7/comments"),
        ("11\n12", "PATCH", "repos/robots/rover/issues/comments/11"),
    ],
)
def test_a_pull_request_gets_one_comment(
    runner: Runner, monkeypatch: pytest.MonkeyPatch, earlier: str, method: str, address: str
) -> None:
    """The comment with the findings is created once; later runs update it."""
    monkeypatch.setenv("EARLIER", earlier)
    runner.inputs["comment"] = "true"
    runner.github["github.event.pull_request.number"] = "7"
    assert runner.run("comment") == 0
    body = runner.folder / "temporary" / "kg-lint.md"
    assert runner.calls()[1] == ["api", "--silent", "--method", method, address, "--field", f"body=@{body}"]


def test_a_push_gets_no_comment(runner: Runner) -> None:
    """Without a pull request there is no comment, and `gh` is not called."""
    runner.inputs["comment"] = "true"
    assert runner.run("comment") == 0
    assert not (runner.folder / "temporary" / "calls").exists()


def test_inputs_reach_the_shell_as_variables_alone() -> None:
    """No script contains an expression, so text of a pull request cannot become a command."""
    assert not [step["id"] for step in STEPS if "${{" in step.get("run", "")]


def test_every_input_is_documented() -> None:
    """The table of docs/lint.md lists each input with its default."""
    rows = re.findall(r"^\| `([\w-]+)` \| (.*?) ?\|", (ROOT / "docs" / "lint.md").read_text("utf-8"), re.MULTILINE)
    documented = {name: default.strip("`") for name, default in rows}
    defaults = {name: str(one["default"]) for name, one in ACTION["inputs"].items()}
    assert documented == {**defaults, "token": "that of the job"}


@pytest.mark.skipif(not shutil.which("shellcheck"), reason="shellcheck is not installed")
@pytest.mark.parametrize("step", [step for step in STEPS if "run" in step], ids=lambda step: str(step["id"]))
def test_shellcheck_finds_nothing(step: dict[str, Any]) -> None:
    """ShellCheck accepts the scripts."""
    ran = subprocess.run(
        ["shellcheck", "--shell=bash", "-"], input=step["run"], capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stdout


@pytest.mark.slow
@pytest.mark.skipif(not os.environ.get("KG_TEST_DEEP"), reason="installs everything: KG_TEST_DEEP=1 runs it")
def test_the_action_installs_kg_from_its_own_folder(runner: Runner) -> None:
    """The first step creates an environment with the runner's Python and the `kg` of the action's commit."""
    shutil.rmtree(runner.folder / "temporary" / "kg")
    runner.outputs["steps.python.outputs.python-path"] = sys.executable
    runner.github["github.action_path"] = str(ROOT)
    assert runner.run("install", "lint", "judge") == 1
    assert "kg 0." in runner.printed
    assert "title=KG412" in runner.printed
