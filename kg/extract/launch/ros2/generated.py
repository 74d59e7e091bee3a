"""Files that exist only while a launch file runs: other files with texts replaced, or with values rewritten.

Source: `nav2_common.launch.ReplaceString` and `RewrittenYaml`, which write temporary files and give their names. Here
they get the name of the file that they are made of, with a number; their lines are those of that file.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.context import HOLE, place
from kg.facts import LaunchProblemKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.corpus.files import FilePath
    from kg.extract.launch.expressions.values import Text
    from kg.extract.launch.ros2.actions import ParameterFile
    from kg.extract.launch.ros2.context import Context
    from kg.extract.launch.ros2.parameter_files import Entry

__all__ = ["Generated", "replaced_file", "rewritten_file"]

_MOST: Final = 1_000
_MOST_CHARACTERS: Final = 5_000_000


@dataclass(frozen=True, slots=True)
class Generated:
    """What was made of `file`: its text, or the parameters that a file of parameters has then."""

    file: FilePath
    content: bytes
    entries: tuple[Entry, ...] | None = None


def replaced_file(context: Context, source: Text, condition: Text, *pairs: Text) -> str:
    """Return the name of a file in which texts are replaced where a condition holds; `pairs` are old and new in turn.

    Each line is taken through all replacements in their order.
    """
    from kg.extract.launch.ros2.locate import read  # noqa: PLC0415  (which needs this module's users)
    from kg.extract.launch.ros2.substitute import perform, truth  # noqa: PLC0415  (the same)

    path, held = perform(context, source), truth(perform(context, condition))
    if held is False or HOLE in path:
        return path
    if held is None:
        return context.unresolved(f"whether texts of `{path}` are replaced is known only when it runs", path)
    found = read(context, path)
    if found is None:
        return HOLE
    texts = [perform(context, text) for text in pairs]
    replacements = list(zip(texts[::2], texts[1::2], strict=False))
    before = context.found.generated.get(path)
    entries = before.entries if before is not None else None
    content = _replaced(found[1].decode(), replacements)
    if content is None:
        context.problem(LaunchProblemKind.LIMIT, f"texts grow over {_MOST_CHARACTERS} characters", path)
        return HOLE
    made = tuple(_replaced_in(entry, replacements) for entry in entries) if entries is not None else None
    return _named(context, path, Generated(found[0], content.encode(), made))


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
            node, value = node.replace(old, new), value.replace(old, new)
            names = tuple(name.replace(old, new) for name in names)
    return replace(entry, node=node, value=value[:_MOST_CHARACTERS], names=names)


def rewritten_file(context: Context, source: ParameterFile) -> str:
    """Return the name of a file of parameters with what is rewritten in it."""
    from kg.extract.launch.ros2.locate import read  # noqa: PLC0415  (which needs this module's users)
    from kg.extract.launch.ros2.parameter_files import entries, rewritten  # noqa: PLC0415  (the same)
    from kg.extract.launch.ros2.substitute import perform  # noqa: PLC0415  (the same)

    path = perform(context, source.path)
    found = None if HOLE in path else read(context, path)
    if found is None:
        return HOLE
    file, content = found
    before = context.found.generated.get(path)
    try:
        listed = before.entries if before is not None and before.entries is not None else entries(content)
    except ValueError as error:
        line = error.args[1] if len(error.args) > 1 else 1
        where = place(context.files, file, line)
        context.problem(LaunchProblemKind.MALFORMED, f"`{file.path}` {error.args[0]}", file.path, where)
        return HOLE
    return _named(context, path, Generated(file, content, tuple(rewritten(context, listed, source))))


def _named(context: Context, path: str, made: Generated) -> str:
    """Keep what was made, once, and return its name."""
    known = context.found.generated
    same = next((name for name, other in known.items() if other == made), None)
    if same is not None:
        return same
    if len(known) >= _MOST:
        context.problem(LaunchProblemKind.LIMIT, f"more than {_MOST} files are made")
        return HOLE
    name = f"{path.partition('#')[0]}#{len(known) + 1}"
    known[name] = made
    return name
