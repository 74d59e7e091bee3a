"""Files that exist only while a launch file runs: other files with texts replaced, or with values rewritten.

Source: `nav2_common.launch.ReplaceString` and `RewrittenYaml`, which write temporary files and give their names. Here
they get the name of the file that they are made of, with a number; their lines are those of that file.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.context import HOLE
from kg.extract.launch.ros2.locate import read
from kg.extract.launch.ros2.parameter_files import Rewriting, read_parameters
from kg.extract.launch.ros2.values import truth
from kg.facts import LaunchProblemKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.corpus.files import FilePath
    from kg.extract.launch.ros2.actions import ParameterFile
    from kg.extract.launch.ros2.context import Context
    from kg.extract.launch.ros2.parameter_files import Entry
    from kg.extract.launch.ros2.texts import Text

__all__ = ["Generated", "replaced_file", "rewritten_file"]

_MOST: Final = 1_000
_MOST_CHARACTERS: Final = 5_000_000


@dataclass(frozen=True, slots=True)
class Generated:
    """What was made of `file`: its text, or the parameters that a file of parameters has then; `recipe` tells how."""

    file: FilePath
    content: bytes
    entries: tuple[Entry, ...] | None
    recipe: tuple[object, ...]


def replaced_file(context: Context, source: Text, condition: Text, *pairs: Text) -> str:
    """Return the name of a file in which texts are replaced where a condition holds; `pairs` are old and new in turn.

    Each line is taken through all replacements in their order.
    """
    path, held = context.perform(source), truth(context.perform(condition))
    if held is False or HOLE in path:
        return path
    if held is None:
        return context.unresolved(f"whether texts of `{path}` are replaced is known only when it runs", path)
    found = read(context, path)
    if found is None:
        return HOLE
    texts = [context.perform(text) for text in pairs]
    known = _made(context, (path, *texts))
    if known is not None:
        return known
    replacements = list(zip(texts[::2], texts[1::2], strict=False))
    before = context.found.generated.get(path)
    entries = before.entries if before is not None else None
    content = _replaced(found[1].decode(), replacements)
    if content is None:
        context.problem(LaunchProblemKind.LIMIT, f"texts grow over {_MOST_CHARACTERS} characters", path)
        return HOLE
    made = tuple(_replaced_in(entry, replacements) for entry in entries) if entries is not None else None
    return _named(context, path, Generated(found[0], content.encode("utf-8", "replace"), made, (path, *texts)))


def _replaced(text: str, replacements: Sequence[tuple[str, str]]) -> str | None:
    for old, new in replacements:
        if not old:
            continue
        if len(text) + text.count(old) * len(new) > _MOST_CHARACTERS:
            return None
        text = text.replace(old, new)
    return text


def _replaced_in(entry: Entry, replacements: Sequence[tuple[str, str]]) -> Entry:
    node, value, names = entry.node, entry.value, entry.names
    for old, new in replacements:
        if old:
            node, value = node and node.replace(old, new), value.replace(old, new)
            names = tuple(name.replace(old, new) for name in names)
    return replace(entry, node=node, value=value[:_MOST_CHARACTERS], names=names)


def rewritten_file(context: Context, source: ParameterFile) -> str:
    """Return the name of a file of parameters with what is rewritten in it."""
    path = context.perform(source.path)
    found = read(context, path)
    if found is None:
        return HOLE
    rewriting = Rewriting(
        {context.perform(old): context.perform(new) for old, new in source.keys},
        {context.perform(name): context.perform(value) for name, value in source.rewrites},
        {context.perform(old): context.perform(new) for old, new in source.values},
        context.perform(source.root) if source.root is not None else "",
        source.location,
    )
    known = _made(context, (path, rewriting))
    if known is not None:
        return known
    listed = read_parameters(context, path)
    if listed is None:
        return HOLE
    return _named(context, path, Generated(*found, rewriting.applied(listed[1]), (path, rewriting)))


def _made(context: Context, recipe: tuple[object, ...]) -> str | None:
    """Return the name of what was made in the same way before."""
    return next((name for name, other in context.found.generated.items() if other.recipe == recipe), None)


def _named(context: Context, path: str, made: Generated) -> str:
    """Keep what was made, and return its name."""
    known = context.found.generated
    if len(known) >= _MOST:
        context.problem(LaunchProblemKind.LIMIT, f"more than {_MOST} files are made")
        return HOLE
    name = f"{path.partition('#')[0]}#{len(known) + 1}"
    known[name] = made
    return name
