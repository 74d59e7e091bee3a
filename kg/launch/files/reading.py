"""Which launch files a package has, which language each is in, and its evaluation."""

from __future__ import annotations

import re
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath, PackageFolder
from kg.facts import FileKind, LaunchConfiguration, LaunchDialect, LaunchProblem, LaunchProblemKind, Location
from kg.launch.files.access import Files
from kg.launch.files.ros1.evaluate import evaluate as evaluate_roslaunch
from kg.launch.files.ros2.execute import dialect_of
from kg.launch.files.ros2.execute import evaluate as evaluate_ros2

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.corpus.reading import Reader

_NOTHING: Final[Mapping[str, str]] = MappingProxyType({})
_ROS2: Final = 2
_TEMPLATES: Final = frozenset({"template", "templates"})
"""Folders of files that become launch files when something is filled in."""
_COMMENT: Final = re.compile(rb"<!--.*?-->", re.DOTALL)
_OF_ROS1: Final = re.compile(rb"""<(node|test)\b[^>]*\stype\s*=|\$\((find|arg)\s|<(rosparam|test|machine)\b""")
_OF_ROS2: Final = re.compile(
    rb"""<(node|test|executable)\b[^>]*\s(exec|cmd)\s*=|\$\((find-pkg-\w+|var|exec-in-pkg|find-exec)\s"""
    rb"""|<(let|set_parameter|push[-_]ros[-_]namespace|node_container|load_composable_node)\b"""
)
"""What only launch files of one version have."""
_LAUNCH: Final = re.compile(rb"<launch(?![\w.-])")
"""What each launch file in XML has, and other files of that ending do not: Eclipse's have `<launchConfiguration>`."""
_LAUNCH_KEY: Final = re.compile(rb"""^['"]?launch['"]?\s*:""", re.MULTILINE)
"""What tells a launch file in YAML from parameters in the same folder."""


def read_launches(
    reader: Reader, package: PackageFolder, ros: int, also: int | None = None
) -> tuple[LaunchConfiguration, ...]:
    """Return each launch file of `package`, evaluated with its default arguments; `ros` is the package's version.

    Templates are left out. Malformed files of the package are also problems KG415 of the `reader`. In a package
    that is `also` for another version of ROS, files of that version are not mistakes.
    """
    launches = (entry.path for entry in package.files if entry.kind is FileKind.LAUNCH)
    paths = sorted(path for path in launches if not _TEMPLATES & set(path.split("/")))
    files = Files(reader)
    read = [one for path in paths if (one := _configuration(files, path, ros)) is not None]
    if also is not None:
        read = [replace(one, problems=tuple(map(_undecided, one.problems))) for one in read]
    own = {entry.path for entry in package.files}
    for problem in (problem for one in read for problem in one.problems):
        where = problem.location
        if problem.kind is LaunchProblemKind.MALFORMED and where.repository is None and where.path in own:
            reader.problem("KG415", problem.message, where.path, where.line or None)
    return tuple(read)


def _undecided(problem: LaunchProblem) -> LaunchProblem:
    other = problem.kind is LaunchProblemKind.OTHER_VERSION
    return replace(problem, kind=LaunchProblemKind.UNRESOLVED) if other else problem


def read_configuration(
    reader: Reader,
    path: str,
    ros: int,
    given: Mapping[str, str] = _NOTHING,
    environment: Mapping[str, str] = _NOTHING,
) -> LaunchConfiguration | None:
    """Return the launch file at `path` of the reader's source, evaluated with arguments and environment variables.

    None for a file that is not a launch file after all. Errors are in `problems` of the result.
    """
    return _configuration(Files(reader), path, ros, given, environment)


def _configuration(
    files: Files,
    path: str,
    ros: int,
    given: Mapping[str, str] = _NOTHING,
    environment: Mapping[str, str] = _NOTHING,
) -> LaunchConfiguration | None:
    reader = files.reader
    file = FilePath(reader.repository, path)
    text = reader.read(file)
    dialect = _dialect_of(file, text or b"", ros)
    if text is None or dialect is None:
        return None
    if ros == _ROS2 and dialect is LaunchDialect.ROS2_XML and _is_only(text, _OF_ROS1, _OF_ROS2):
        problem = LaunchProblem(LaunchProblemKind.OTHER_VERSION, "the file is written for ROS 1", Location(path, 1))
        package = reader.package
        return LaunchConfiguration(
            reader.repository, package.name, path, 1, LaunchDialect.ROSLAUNCH, problems=(problem,), folder=package.path
        )
    evaluate = evaluate_roslaunch if dialect is LaunchDialect.ROSLAUNCH else evaluate_ros2
    configuration = evaluate(files, file, dialect, given, environment)
    return replace(configuration, package=reader.package.name, folder=reader.package.path)


def _dialect_of(file: FilePath, text: bytes, ros: int) -> LaunchDialect | None:
    """Return the language of a launch file by its ending, its content and its package's version of ROS."""
    dialect = dialect_of(file, text)
    if dialect is LaunchDialect.ROS2_PYTHON:
        test = file.path.rpartition("/")[2].startswith("test_")  # often calls the function of another file
        wanted = b"def generate_" if test else b"generate_launch_description"
        return dialect if wanted in text else None
    if dialect is LaunchDialect.ROS2_XML:
        if not _LAUNCH.search(text):
            return None
        return dialect if ros == _ROS2 or _is_only(text, _OF_ROS2, _OF_ROS1) else LaunchDialect.ROSLAUNCH
    named = re.search(r"\.launch\.ya?ml$", file.path)
    return dialect if named or (ros == _ROS2 and _LAUNCH_KEY.search(text)) else None


def _is_only(text: bytes, own: re.Pattern[bytes], other: re.Pattern[bytes]) -> bool:
    """Return whether a launch file in XML has parts that only one version of ROS reads, and none of the other's."""
    plain = _COMMENT.sub(b"", text)
    return own.search(plain) is not None and other.search(plain) is None
