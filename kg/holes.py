"""Names with unknown parts: `{}` stands for one, `{label}` for one that a variable, parameter or argument would give.

A label is an identifier, with an index where it is an argument or element: `~/{name}/plan`, `camera/{argv[1]}`.
Holes of one label in a name are the same unknown. A brace that belongs to the name itself is doubled (`{{`, `}}`).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Final, TypeGuard

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

__all__ = [
    "ANONYMOUS",
    "PARENT",
    "SUBSTITUTIONS",
    "Hole",
    "anonymous",
    "escape",
    "filled",
    "fits",
    "hole_of",
    "is_known",
    "is_partial",
    "known_letters",
    "label_of",
    "parse",
    "partition",
    "pattern",
    "substitute",
    "written",
]

ANONYMOUS: Final = "{}"
"""An unknown part without label."""
PARENT: Final = "parent_namespace"
"""The label of what is above the namespace of the node: `/robot` for a node in `/robot/local_costmap`."""
SUBSTITUTIONS: Final = frozenset({"node", "ns", "namespace", PARENT})
"""Labels that mean the name and the namespace of the node, as in names of ROS 2; no variable has them as its label."""
_LONGEST: Final = 40
_LABEL: Final = r"[A-Za-z]\w*(?:\[\d+\])?"
_PIECE: Final = re.compile(r"\{\{|\}\}|\{(" + _LABEL + r")?\}", re.ASCII)


@dataclass(frozen=True, slots=True)
class Hole:
    """An unknown part of a name or text; `label` is empty where nothing names it."""

    label: str = ""


@lru_cache(maxsize=16_384)
def parse(name: str) -> tuple[str | Hole, ...]:
    """Return the known parts and the holes of a name in order, no two known parts in a row."""
    parts: list[str | Hole] = []
    text, end = "", 0
    for piece in _PIECE.finditer(name):
        text, end = text + name[end : piece.start()], piece.end()
        if piece[0] in ("{{", "}}"):
            text += piece[0][0]
            continue
        parts += [text] if text else []
        parts.append(Hole(piece[1] or ""))
        text = ""
    text += name[end:]
    return (*parts, text) if text else tuple(parts)


def escape(text: str) -> str:
    """Return a known text as it is written in a name."""
    return text.replace("{", "{{").replace("}", "}}") if "{" in text or "}" in text else text


def written(parts: Iterable[str | Hole]) -> str:
    """Return the name of known parts and holes: what `parse` reads."""
    return "".join(escape(part) if isinstance(part, str) else f"{{{part.label}}}" for part in parts)


def is_partial(name: str) -> bool:
    """Check whether a part of a name is unknown."""
    return "{" in name and any(isinstance(part, Hole) for part in parse(name))


def is_known(name: str | None) -> TypeGuard[str]:
    """Check whether a name is known in full."""
    return name is not None and not is_partial(name)


def anonymous(name: str) -> str:
    """Return a name without labels: what names that differ in labels alone share."""
    return substitute(name, lambda _: ANONYMOUS)


def known_letters(name: str) -> int:
    """Return how many letters of a name are known."""
    return sum(len(part) for part in parse(name) if isinstance(part, str))


def substitute(name: str, value_of: Callable[[str], str | None]) -> str:
    """Return a name with values, themselves names, in its holes; a hole whose label has no value (None) stays."""
    if "{" not in name:
        return name

    def filled(piece: re.Match[str]) -> str:
        value = value_of(piece[1] or "") if piece[0] not in ("{{", "}}") else None
        return piece[0] if value is None else value

    return _PIECE.sub(filled, name)


def partition(name: str, hole: str = "") -> tuple[str, str, str]:
    """Return what is before the first holes in a row, these, and what is after them; all is before if it has none.

    If the name has the labelled `hole` (`{name}`), the first of these takes the place of the first holes in a row.
    """
    start = end = len(name)
    for piece in _PIECE.finditer(name) if "{" in name else ():
        if piece[0] in ("{{", "}}"):
            continue
        if piece[1] and piece[0] == hole:
            return name[: piece.start()], piece[0], name[piece.end() :]
        if start == len(name):
            start, end = piece.span()
        elif piece.start() == end:
            end = piece.end()
    return name[:start], name[start:end], name[end:]


def filled(name: str, value: str) -> str:
    """Return a name with one value in all its holes."""
    return substitute(name, lambda _: value)


@lru_cache(maxsize=16_384)
def pattern(name: str, unknown: str = r"[^/.]+") -> re.Pattern[str]:
    """Return what a name may be: `unknown` matches one hole or several in a row, holes of one label match the same."""
    found: list[str] = []
    groups: dict[str, int] = {}
    parts = parse(name)
    for index, part in enumerate(parts):
        if isinstance(part, str):
            found.append(re.escape(part))
            continue
        beside = [one for one in (*parts[index - 1 : index], *parts[index + 1 : index + 2]) if isinstance(one, Hole)]
        if index and isinstance(parts[index - 1], Hole):
            continue
        if not part.label or beside:
            found.append(unknown)
        elif part.label in groups:
            found.append(rf"(?:\{groups[part.label]})")
        else:
            groups[part.label] = len(groups) + 1
            found.append(f"({unknown})")
    return re.compile("".join(found), re.DOTALL)


def fits(name: str, concrete: str, unknown: str = r"[^/.]+") -> bool:
    """Check whether a known name is what a name with holes may be."""
    return pattern(name, unknown).fullmatch(concrete) is not None


@lru_cache(maxsize=16_384)
def label_of(source: str) -> str:
    """Return the label of an unknown part from what would give it: a variable, parameter (`~/a.b`) or `argv[1]`.

    It is empty where the label would say nothing: one letter, or a word that has another meaning in names.
    """
    if "--" in source:  # the spellings of an option: `argv[--topic|-t]`
        source = source.partition("[")[2].removesuffix("]").partition("|")[0]
    if source.startswith("port["):  # a port of a node of behavior trees
        source = source.removeprefix("port[").removesuffix("]")
    source = source.replace("[]", "")  # each element of a list
    index = re.search(r"\w(\[\d+\])$", source)
    end = index[1] if index is not None else ""
    bare = anonymous(source).removesuffix(end)
    words = re.sub(r"[^A-Za-z0-9]+", "_", bare).strip("_")[:_LONGEST].rstrip("_")
    return "" if len(words) == 1 or not words[:1].isalpha() or words in SUBSTITUTIONS else words + end


def hole_of(source: str) -> str:
    """Return the hole of an unknown part, with the label of what would give it."""
    return f"{{{label_of(source)}}}"
