"""Compares configurations with those that roslaunch loads from the same files."""

from __future__ import annotations

import json
import posixpath
import re
import shlex
import subprocess
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml
from patience import patient

from kg.facts import LaunchProblemKind
from kg.holes import ANONYMOUS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.corpus.workspace import Workspace
    from kg.facts import LaunchConfiguration, StartedNode

__all__ = ["Job", "ask", "differences", "job", "reason_to_skip"]

PYTHON = "/usr/bin/python3"
NOTHING = "what a command prints or a file of an unknown package holds"
SCRIPT = Path(__file__).with_name("oracle_roslaunch.py")
REFUSED = frozenset(LaunchProblemKind) - {LaunchProblemKind.UNRESOLVED, LaunchProblemKind.UNKNOWN_PACKAGE}
SPECIAL = re.compile(r"(?:[~/A-Za-z{}]|__?)[\w/{}]*:=.*", re.DOTALL)


@cache
def reason_to_skip() -> str | None:
    """Return why roslaunch is unavailable, or None."""
    try:
        command = [PYTHON, "-c", "import roslaunch"]
        found = subprocess.run(command, capture_output=True, timeout=patient(60), check=False)
    except OSError as error:
        return f"{PYTHON}: {error.strerror}"
    return "roslaunch is not installed for the system's Python" if found.returncode else None


@dataclass(frozen=True)
class Job:
    """A request to roslaunch: a launch file with its arguments, and the folders of the packages."""

    file: str
    args: list[str]
    environment: dict[str, str]
    packages: dict[str, str]


def job(workspace: Workspace, found: LaunchConfiguration, environment: Mapping[str, str]) -> Job:
    """Return the request for the file of a configuration."""
    source = workspace.source(found.repository)
    assert source is not None
    folders: dict[str, str] = {}
    for one in workspace.sources:
        for package in one.packages:
            folders.setdefault(package.name, posixpath.normpath(f"{one.root}/{package.path}"))
    arguments = [f"{name}:={value}" for name, value in found.given]
    return Job(f"{source.root}/{found.path}", arguments, dict(environment), folders)


def ask(jobs: list[Job]) -> list[dict[str, Any]]:
    """Return the results of roslaunch for files, with `package://NAME` for the folders of packages."""
    lines = "\n".join(json.dumps(asdict(one)) for one in jobs)
    command = [PYTHON, str(SCRIPT)]
    done = subprocess.run(command, input=lines, capture_output=True, text=True, check=True, env={})
    answers = zip(jobs, done.stdout.splitlines(), strict=True)
    return [json.loads(_as_packages(line, one.packages)) for one, line in answers]


def _as_packages(text: str, folders: Mapping[str, str]) -> str:
    """Return a text with `package://NAME` for the folders of packages."""
    for name, folder in sorted(folders.items(), key=lambda item: -len(item[1])):
        text = re.sub(rf"{re.escape(folder)}(?![\w-])", f"package://{name}", text)
    return text.replace("/unknown/", "package://")


def differences(ours: LaunchConfiguration, theirs: Mapping[str, Any]) -> list[str]:
    """Describe the differences between roslaunch and our configuration."""
    refused = [f"{one.location}: {one.message}" for one in ours.problems if one.kind in REFUSED]
    names = [f"{node.namespace.rstrip('/')}/{node.name}" for node in ours.nodes if node.kind != "test"]
    twice = sorted({name for name in names if names.count(name) > 1})
    if "error" in theirs:
        waits = any(one.value is None for one in ours.arguments)
        waits = waits or any(ANONYMOUS in one.namespace for one in ours.nodes)
        return [] if refused or twice or waits else [f"only roslaunch refuses it: {theirs['error']}"]
    if refused or twice:
        return [f"only roslaunch takes it: {(refused or twice)[0]}"]
    found = [*_node_differences(ours, theirs), *_parameter_differences(ours, theirs)]
    return [one for one in found if one]


def _node_differences(ours: LaunchConfiguration, theirs: Mapping[str, Any]) -> Iterable[str]:
    mine = sorted(map(_ours, ours.nodes), key=_identity)
    other = sorted(map(_theirs, theirs["nodes"]), key=_identity)
    if list(map(_identity, mine)) != list(map(_identity, other)):
        yield f"nodes {list(map(_identity, mine))} are {list(map(_identity, other))}"
        return
    for one, two in zip(mine, other, strict=True):
        for key in one:
            if one[key] != two[key]:
                yield f"{_identity(one)} {key}: {one[key]} is {two[key]}"


def _identity(node: Mapping[str, Any]) -> tuple[str, ...]:
    return (node["namespace"], node["name"], node["package"], node["type"])


def _ours(node: StartedNode) -> dict[str, Any]:
    """Return a node in the form of roslaunch; remappings of `args` are included in the others."""
    return {
        "name": node.name,
        "namespace": f"{node.namespace.rstrip('/')}/",
        "package": node.package,
        "type": node.executable,
        "remaps": [[remap.source, remap.target] for remap in reversed(node.remaps)],
        "env": [[name[4:], value] for name, value in node.settings if name.startswith("env ")],
        "machine": dict(node.settings).get("machine"),
        "args": list(node.arguments),
    }


def _theirs(node: Mapping[str, Any]) -> dict[str, Any]:
    """Return a node of roslaunch, with the content of its `args` applied."""
    words = shlex.split(node["args"])
    mappings = [word.split(":=", 1) for word in words if SPECIAL.fullmatch(word)]
    return {
        **node,
        "args": [word for word in words if not SPECIAL.fullmatch(word)],
        "remaps": [*(pair for pair in mappings if not pair[0].startswith("_")), *node["remaps"]],
    }


def _started(node: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters that a node of roslaunch takes from its `args`."""
    mappings = [word.partition(":=") for word in shlex.split(node["args"]) if SPECIAL.fullmatch(word)]
    return {
        f"{node['namespace']}{node['name']}/{name[1:]}": yaml.safe_load(value)
        for name, _, value in mappings
        if name.startswith("_") and not name.startswith("__")
    }


def _parameter_differences(ours: LaunchConfiguration, theirs: Mapping[str, Any]) -> Iterable[str]:
    mine = {one.name: one for one in ours.parameters}
    other = dict(theirs["parameters"])
    for node in theirs["nodes"]:
        other.update(_started(node))
    for name in sorted({*mine, *other}):
        if name not in mine or name not in other:
            yield f"{name} is only {'in ours' if name in mine else 'in theirs'}"
            continue
        value = other[name]
        written = mine[name].value
        known = written is not None and value != NOTHING
        if known and json.loads(json.dumps(yaml.safe_load(written or ""))) != value:
            yield f"{name}: {written} is {value!r}"
