"""Configurations as short records, for the expectations of cases."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from extract.workspaces import manifest, written

from kg.corpus.files import FilePath
from kg.corpus.reading import Reader
from kg.facts import LaunchDialect
from kg.launch.files.access import Files
from kg.launch.files.ros1.evaluate import evaluate

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.corpus.workspace import Workspace
    from kg.facts import LaunchConfiguration, LaunchParameter, Location, StartedNode

__all__ = ["CASES", "case_workspace", "configuration", "evaluated", "record"]

CASES = sorted((Path(__file__).parent / "cases").glob("*/expected.json"))


def case_workspace(root: Path, case: Path) -> Workspace:
    """Return the workspace of a case, with a package in each folder."""
    files = {str(path.relative_to(case)): path.read_bytes() for path in case.glob("*/**/*") if path.is_file()}
    manifests = {f"{folder.name}/package.xml": manifest(folder.name) for folder in case.iterdir() if folder.is_dir()}
    return written(root, {**files, **manifests})


def configuration(
    workspace: Workspace, path: str, given: Mapping[str, str], environment: Mapping[str, str]
) -> LaunchConfiguration:
    """Return the configuration evaluated from the launch file at `path` of the one source of a workspace."""
    (source,) = workspace.sources
    reader = Reader(workspace, source, source.packages[0])
    file = FilePath(source.repository.name, path)
    return evaluate(Files(reader), file, LaunchDialect.ROSLAUNCH, given, environment)


def evaluated(root: Path, files: Mapping[str, str], given: Mapping[str, str] | None = None) -> LaunchConfiguration:
    """Return the configuration of `demo/main.launch` of a package `demo` with these files."""
    tree = {f"demo/{path}": content for path, content in files.items()}
    workspace = written(root, {"demo/package.xml": manifest("demo"), **tree})
    return configuration(workspace, "demo/main.launch", given or {}, {})


def record(found: LaunchConfiguration) -> dict[str, Any]:
    """Return a configuration in the form of a case, without empty fields."""
    whole = {
        "arguments": [
            f"{one.name} = {json.dumps(one.value)}{' fixed' * one.fixed} {one.location}" for one in found.arguments
        ],
        "nodes": [_node(node) for node in found.nodes],
        "parameters": [_parameter(one) for one in found.parameters],
        "includes": [
            f"{one.written} {_place(one.location, one.chain)}{_tail(one.path and 'found', one.condition, one.reason)}"
            for one in found.includes
        ],
        "problems": [f"{one.kind} {_place(one.location, one.chain)}: {one.message}" for one in found.problems],
        "files": [path for _, path in found.files],
    }
    return {key: value for key, value in whole.items() if value}


def _place(location: Location, chain: tuple[Location, ...]) -> str:
    return " < ".join(map(str, (location, *reversed(chain))))


def _tail(*texts: str | None) -> str:
    return "".join(f" | {text}" for text in texts if text)


def _parameter(one: LaunchParameter) -> str:
    return f"{one.name}: {one.type} {one.value} {_place(one.location, one.chain)}{_tail(one.reason)}"


def _node(node: StartedNode) -> dict[str, Any]:
    whole = {
        "node": f"{node.namespace.rstrip('/')}/{node.name}",
        "starts": f"{node.kind} {node.package}/{node.executable}",
        "at": _place(node.location, node.chain),
        "plugin": node.plugin,
        "host": node.host,
        "condition": node.condition,
        "remaps": [f"{one.source} -> {one.target} {_place(one.location, one.chain)}" for one in node.remaps],
        "arguments": list(node.arguments),
        "settings": dict(node.settings),
    }
    return {key: value for key, value in whole.items() if value}
