"""Which launch files a package has, which language each is in, and its evaluation."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath
from kg.extract.launch.files import Files
from kg.extract.launch.ros1.evaluate import evaluate as evaluate_roslaunch
from kg.extract.launch.ros2.evaluate import evaluate as evaluate_ros2
from kg.extract.launch.ros2.read import dialect_by_ending
from kg.facts import FileKind, LaunchDialect, LaunchProblemKind

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.facts import LaunchConfiguration

__all__ = ["read_configuration", "read_launches"]

_NOTHING: Final[Mapping[str, str]] = MappingProxyType({})
_ROS2: Final = 2


def read_launches(reader: Reader, package: PackageFolder, ros: int) -> tuple[LaunchConfiguration, ...]:
    """Return each launch file of `package`, evaluated with its default arguments; `ros` is the package's version.

    What is malformed in files of the package is a problem KG415 of the `reader` too.
    """
    paths = sorted(entry.path for entry in package.files if entry.kind is FileKind.LAUNCH)
    found = [one for path in paths if (one := read_configuration(reader, path, ros)) is not None]
    own = {entry.path for entry in package.files}
    for problem in (problem for one in found for problem in one.problems):
        where = problem.location
        if problem.kind is LaunchProblemKind.MALFORMED and where.repository is None and where.path in own:
            reader.problem("KG415", problem.message, where.path, where.line or None)
    return tuple(found)


def read_configuration(
    reader: Reader,
    path: str,
    ros: int,
    given: Mapping[str, str] = _NOTHING,
    environment: Mapping[str, str] = _NOTHING,
) -> LaunchConfiguration | None:
    """Return the launch file at `path` of the reader's source, evaluated with arguments and environment variables.

    None for a file that is no launch file after all. What is wrong stands in `problems` of the result.
    """
    file = FilePath(reader.repository, path)
    text = reader.read(file)
    dialect = _dialect_of(file, text or b"", ros)
    if text is None or dialect is None:
        return None
    evaluate = evaluate_roslaunch if dialect is LaunchDialect.ROSLAUNCH else evaluate_ros2
    found = evaluate(Files(reader), file, dialect, given, environment)
    return replace(found, package=reader.package.name, folder=reader.package.path)


def _dialect_of(file: FilePath, text: bytes, ros: int) -> LaunchDialect | None:
    """Return the language of a launch file by its ending, its content and its package's version of ROS."""
    dialect = dialect_by_ending(file)
    if dialect is LaunchDialect.ROS2_PYTHON:
        return dialect if b"generate_launch_description" in text else None
    if dialect is LaunchDialect.ROS2_XML:
        if b"<launch" not in text:
            return None
        return dialect if ros == _ROS2 else LaunchDialect.ROSLAUNCH
    return dialect
