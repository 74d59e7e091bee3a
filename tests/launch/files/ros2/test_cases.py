"""Evaluation cases are files: `cases/<case>/` is a package, and `expected.json` has the results of its launch files.

`expected.json` maps launch files to their expected results: `nodes` in order, each with the keys under test; `problems`
as kind, subject and place, all of them; `includes`, `arguments` and `files` if given; `given` and `environment` are the
input of the evaluation.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from kg.corpus.files import FilePath
from kg.corpus.reading import Reader
from kg.corpus.workspace import Workspace, scan
from kg.facts import Repository
from kg.launch.files.access import Files
from kg.launch.files.ros2.execute import dialect_of, evaluate

if TYPE_CHECKING:
    from kg.facts import LaunchConfiguration, LaunchParameter, LaunchProblem, StartedNode

Record = dict[str, Any]

EXPECTED = {
    path.parent: json.loads(path.read_text())
    for path in sorted((Path(__file__).parent / "cases").glob("*/expected.json"))
}
CASES = [(case, file) for case, launches in EXPECTED.items() for file in launches]


def evaluated(case: Path, path: str, given: dict[str, str], environment: dict[str, str]) -> LaunchConfiguration:
    """Return the configuration of a launch file of a case."""
    source = scan(case, Repository(f"local/{case.name}", str(case)))
    files = Files(Reader(Workspace([source]), source, source.packages[0]))
    file = FilePath(source.repository.name, path)
    return evaluate(files, file, dialect_of(file, (case / path).read_bytes()), given, environment)


def node_record(node: StartedNode) -> Record:
    """Return a node in the notation of the cases."""
    return {
        "name": node.name,
        "namespace": node.namespace,
        "kind": node.kind.value,
        "package": node.package,
        "executable": node.executable,
        "plugin": node.plugin,
        "host": node.host,
        "condition": node.condition,
        "path": node.location.path,
        "line": node.location.line,
        "chain": [str(location) for location in node.chain],
        "remaps": [f"{remap.source} -> {remap.target}" for remap in node.remaps],
        "parameters": [_parameter_text(given) for given in node.parameters],
        "types": [given.type for given in node.parameters],
        "values": {given.name: given.value for given in node.parameters},
        "arguments": list(node.arguments),
        "settings": dict(node.settings),
    }


def _parameter_text(given: LaunchParameter) -> str:
    below = f"{given.node}: " if given.node else ""
    return f"{below}{given.name}: {given.value} @{given.location}"


def problem_text(problem: LaunchProblem) -> str:
    """Return a problem in the notation of the cases."""
    return f"{problem.kind.value} {problem.subject} {problem.location}"


@pytest.mark.parametrize(("case", "path"), CASES, ids=[f"{case.name}/{path}" for case, path in CASES])
def test_case(case: Path, path: str) -> None:
    """A launch file starts the expected nodes, with their names, remappings and parameters."""
    expected = EXPECTED[case][path]
    found = evaluated(case, path, expected.get("given", {}), expected.get("environment", {}))
    records = [
        {key: value for key, value in node_record(node).items() if key in wanted}
        for node, wanted in zip(found.nodes, expected["nodes"], strict=False)
    ]
    assert records == expected["nodes"]
    assert len(found.nodes) == len(records)
    assert [problem_text(problem) for problem in found.problems] == expected.get("problems", [])
    if "includes" in expected:
        assert [include.path for include in found.includes] == expected["includes"]
    if "arguments" in expected:
        assert {argument.name: argument.value for argument in found.arguments} == expected["arguments"]
    if "files" in expected:
        assert [path for _, path in found.files] == expected["files"]
