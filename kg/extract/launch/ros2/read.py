"""Launch files of ROS 2 as actions, whatever their dialect; each is parsed once."""

from __future__ import annotations

from hashlib import blake2b
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.frontend.xml import read_xml
from kg.extract.launch.ros2.frontend.yaml import read_yaml
from kg.extract.launch.ros2.locate import unreadable
from kg.facts import LaunchDialect, LaunchProblemKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.corpus.files import FilePath
    from kg.extract.launch.files import Files
    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.context import Context
    from kg.facts import LaunchProblem

__all__ = ["dialect_by_ending", "read_actions"]

Tree = tuple["Sequence[Action]", "tuple[LaunchProblem, ...]"]

_MOST_TREES: Final = 4_000
_MOST_BYTES: Final = 64 << 20
"""Read of launch files for one configuration, each time that one is included."""

_MARKUP: Final[dict[tuple[str, FilePath, LaunchDialect, bytes], Tree]] = {}
"""Files of XML and YAML by all that their trees depend on: the source that they are read for, their name, language
and the digest of their text."""

_PYTHON: Final[dict[Files, dict[FilePath, Tree]]] = {}
"""Files of Python, for the reader of files that was used last: what is read of them depends on others that they import.

The trees hold on to that reader, so no other is kept.
"""


def dialect_by_ending(file: FilePath) -> LaunchDialect:
    """Return the language of a file by its ending, as `AnyLaunchDescriptionSource` tells them apart."""
    ending = file.path.rpartition(".")[2]
    if ending == "py":
        return LaunchDialect.ROS2_PYTHON
    return LaunchDialect.ROS2_YAML if ending in ("yaml", "yml") else LaunchDialect.ROS2_XML


def read_actions(context: Context, file: FilePath, dialect: LaunchDialect) -> Sequence[Action]:
    """Return the actions of a launch file; none, and problems, for a file that cannot be read or does not parse."""
    content = context.files.read(file)
    if content is None:
        unreadable(context, file)
        return ()
    context.found.files.setdefault(file)
    context.found.bytes += len(content)
    if context.found.bytes > _MOST_BYTES:
        context.problem(LaunchProblemKind.LIMIT, f"more than {_MOST_BYTES} bytes of launch files are read")
        return ()
    actions, problems = (
        _python(context, file, content)
        if dialect is LaunchDialect.ROS2_PYTHON
        else _markup(context, file, content, dialect)
    )
    for problem in problems:
        context.problem(problem.kind, problem.message, problem.subject, problem.location)
    return actions


def _markup(context: Context, file: FilePath, content: bytes, dialect: LaunchDialect) -> Tree:
    key = context.files.reader.repository, file, dialect, blake2b(content, digest_size=16).digest()
    if key not in _MARKUP:
        problems: list[LaunchProblem] = []
        reader = read_yaml if dialect is LaunchDialect.ROS2_YAML else read_xml
        if len(_MARKUP) >= _MOST_TREES:
            _MARKUP.clear()
        _MARKUP[key] = reader(context.files, file, content, problems), tuple(problems)
    return _MARKUP[key]


def _python(context: Context, file: FilePath, content: bytes) -> Tree:
    from kg.extract.launch.ros2.python.read import read_python  # noqa: PLC0415  (only files of Python need it)

    if context.files not in _PYTHON:
        _PYTHON.clear()
    trees = _PYTHON.setdefault(context.files, {})
    if file not in trees:
        problems: list[LaunchProblem] = []
        trees[file] = read_python(context.files, file, content, problems), tuple(problems)
    return trees[file]
