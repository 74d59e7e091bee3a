"""Loads launch files with roslaunch itself and prints the result: run by the Python that has roslaunch.

Reads one job as JSON a line from standard input: `file`, `args` (`x:=y`), `environment`, `packages` (folders by name).
Writes one result a line. Nothing is executed: commands of parameters are replaced by None, and unknown packages are
empty ones below `/unknown`.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
import types
import xml.dom.minidom
from typing import Any

import rosgraph.names  # type: ignore[import-not-found]  # only where roslaunch is
import roslaunch.config  # type: ignore[import-not-found]  # only where roslaunch is
import roslaunch.loader  # type: ignore[import-not-found]  # only where roslaunch is
import roslaunch.xmlloader  # type: ignore[import-not-found]  # only where roslaunch is
import rosparam  # type: ignore[import-not-found]  # noqa: F401  (registers the angles of YAML)
from roslaunch import substitution_args

UNKNOWN = "/unknown/"
NOTHING = "what a command prints or a file of an unknown package holds"


class Packages:
    """Stand-in for rospkg's index of packages."""

    def __init__(self, folders: dict[str, str]) -> None:
        self.folders = folders

    def get_path(self, name: str) -> str:
        """Return the folder of a package."""
        return self.folders.get(name, UNKNOWN + name)

    def get_custom_cache(self, _: str, default: object) -> object:
        """Return an empty cache."""
        return default

    def set_custom_cache(self, _: str, __: object) -> None:
        """Cache nothing."""


class Loader(roslaunch.xmlloader.XmlLoader):  # type: ignore[misc]  # its base has no types
    """roslaunch's loader, which treats files of unknown packages as empty and executes nothing."""

    def _parse_launch(self, filename: str, verbose: object) -> Any:
        if filename.startswith(UNKNOWN):
            return xml.dom.minidom.Document().createElement("launch")
        return super()._parse_launch(filename, verbose)

    def load_rosparam(self, *arguments: Any, **rest: Any) -> None:
        """Load parameters."""
        _, _, command, _, file, _ = arguments
        if not (command == "load" and file and file.startswith(UNKNOWN)):
            super().load_rosparam(*arguments, **rest)

    def param_value(self, verbose: object, name: str, ptype: str, *sources: Any) -> Any:
        """Return the value of a parameter."""
        value, textfile, binfile, command = sources
        words = (command or "").split()
        if words[:1] == ["cat"] and len(words) == 2:
            return self.param_value(verbose, name, ptype, None, words[1], None, None)
        if command is not None or any(one and one.startswith(UNKNOWN) for one in (textfile, binfile)):
            return NOTHING
        return super().param_value(verbose, name, ptype, value, textfile, binfile, command)


def _unused(context: Any) -> None:
    if not context.filename.startswith(UNKNOWN):
        _check_unused(context)


_check_unused = roslaunch.loader.post_process_include_args
roslaunch.loader.post_process_include_args = _unused
rosgraph.names.anonymous_name = lambda name: f"{name}_{{}}"
catkin = types.ModuleType("catkin")
finder = types.ModuleType("catkin.find_in_workspaces")
finder.find_in_workspaces = lambda *_, **__: []  # type: ignore[attr-defined]  # a module made here
sys.modules.update({"catkin": catkin, "catkin.find_in_workspaces": finder})


def _leaves(name: str, value: Any) -> list[tuple[str, Any]]:
    if not isinstance(value, dict):
        return [(name, value)]
    return [leaf for key, inner in value.items() for leaf in _leaves(rosgraph.names.ns_join(name, key), inner)]


def _run(job: dict[str, Any]) -> dict[str, Any]:
    substitution_args._rospack = Packages(job["packages"])
    os.environ.clear()
    os.environ.update(job["environment"])
    config = roslaunch.config.ROSLaunchConfig()
    loader = Loader()
    loader.ignore_unset_args = False
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            loader.load(job["file"], config, argv=job["args"], verbose=False)
    except Exception as error:  # noqa: BLE001 - all that roslaunch raises is one thing here: it refuses the file
        return {"error": f"{type(error).__name__}: {error}"}
    nodes = [
        {
            "name": node.name,
            "namespace": node.namespace,
            "package": node.package,
            "type": node.type,
            "args": node.args,
            "remaps": [list(remap) for remap in node.remap_args],
            "env": [list(pair) for pair in node.env_args],
            "machine": node.machine_name,
        }
        for node in [*config.nodes, *config.tests]
    ]
    parameters = dict(leaf for one in config.params.values() for leaf in _leaves(one.key, one.value))
    return {"nodes": nodes, "parameters": parameters, "files": config.roslaunch_files}


def main() -> None:
    """Answer jobs until there are no more."""
    for line in sys.stdin:
        result = _run(json.loads(line))
        sys.stdout.write(json.dumps(result, default=lambda _: NOTHING) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
