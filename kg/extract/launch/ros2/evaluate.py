"""A ROS 2 launch file evaluated as the one that is started, with everything that it includes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.extract.launch.ros2.context import Context
from kg.extract.launch.ros2.descriptions import described
from kg.extract.launch.ros2.execute import run
from kg.extract.launch.ros2.parameters import without_others
from kg.extract.launch.ros2.read import read_actions
from kg.facts import LaunchConfiguration, LaunchProblemKind

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.corpus.files import FilePath
    from kg.extract.launch.files import Files
    from kg.facts import LaunchDialect

__all__ = ["evaluate"]


def evaluate(
    files: Files, file: FilePath, dialect: LaunchDialect, given: Mapping[str, str], environment: Mapping[str, str]
) -> LaunchConfiguration:
    """Return the configuration of a launch file with the arguments `given` and what is known of the environment.

    Nothing is run. What is wrong or cannot be known is among its problems; no file makes this raise.
    """
    context = Context(files, file, given, environment)
    try:
        run(context, read_actions(context, file, dialect))
    except RecursionError:
        context.problem(LaunchProblemKind.LIMIT, "something is nested too deep to be read")
    owner = files.reader.workspace.owner(file)
    found = context.found
    nodes = without_others(found.nodes)
    return LaunchConfiguration(
        repository=file.repository,
        package=owner.name if owner else "",
        path=file.path,
        ros=2,
        dialect=dialect,
        given=tuple(sorted(given.items())),
        arguments=tuple(found.arguments.values()),
        nodes=nodes,
        includes=tuple(found.includes),
        problems=tuple(found.problems),
        files=tuple((one.repository, one.path) for one in found.files),
        plugins=tuple(described(found, nodes)),
    )
