"""Names with unknown parts: `{}` is an unknown part, `{label}` the value of a variable, parameter or argument.

A label is an identifier, with an index for an argument or element: `~/{name}/plan`, `camera/{argv[1]}`. Holes with the
same label in a name are the same unknown. Literal braces are doubled (`{{`, `}}`).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, TypeGuard

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
"""An unknown part without a label."""
PARENT: Final = "parent_namespace"
"""Label of the parent of the node's namespace: `/robot` for a node in `/robot/local_costmap`."""
SUBSTITUTIONS: Final = frozenset({"node", "ns", "namespace", PARENT})
"""Labels for the name and the namespace of the node, as in names of ROS 2; variables never use them."""
_LONGEST: Final = 40
_LABEL: Final = r"[A-Za-z]\w*(?:\[\d+\])?"
_PIECE: Final = re.compile(r"\{\{|\}\}|\{(" + _LABEL + r")?\}", re.ASCII)


@dataclass(frozen=True, slots=True)
class Hole:
    """An unknown part of a name or text; `label` may be empty."""

    label: str = ""


@lru_cache(maxsize=16_384)
def parse(name: str) -> tuple[str | Hole, ...]:
    """Return the known parts and the holes of a name in order; adjacent known parts are joined."""
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
    """Return a known text with its braces escaped."""
    return text.replace("{", "{{").replace("}", "}}") if "{" in text or "}" in text else text


def written(parts: Iterable[str | Hole]) -> str:
    """Return the name with these parts, the inverse of `parse`."""
    return "".join(escape(part) if isinstance(part, str) else f"{{{part.label}}}" for part in parts)


def is_partial(name: str) -> bool:
    """Check whether a part of a name is unknown."""
    return "{" in name and any(isinstance(part, Hole) for part in parse(name))


def is_known(name: str | None) -> TypeGuard[str]:
    """Check whether a name is known in full."""
    return name is not None and not is_partial(name)


def anonymous(name: str) -> str:
    """Return a name without the labels of its holes."""
    return substitute(name, lambda _: ANONYMOUS)


def known_letters(name: str) -> int:
    """Return the number of known letters of a name."""
    return sum(len(part) for part in parse(name) if isinstance(part, str))


def substitute(name: str, value_of: Callable[[str], str | None]) -> str:
    """Return a name with its holes replaced by values, themselves names.

    Holes whose label has no value (None) remain.
    """
    if "{" not in name:
        return name

    def filled(piece: re.Match[str]) -> str:
        value = value_of(piece[1] or "") if piece[0] not in ("{{", "}}") else None
        return piece[0] if value is None else value

    return _PIECE.sub(filled, name)


def partition(name: str, hole: str = "") -> tuple[str, str, str]:
    """Split a name at its first run of holes into the parts before, in and after it; without holes, all is before.

    If the name contains the labelled `hole` (`{name}`), it is split there instead.
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
    """Return a name with the same value in all its holes."""
    return substitute(name, lambda _: value)


@lru_cache(maxsize=16_384)
def pattern(name: str, unknown: str = r"[^/.]+") -> re.Pattern[str]:
    """Return the pattern of possible names: `unknown` matches a run of holes.

    Holes with the same label match equal text.
    """
    parts_of_pattern: list[str] = []
    groups: dict[str, int] = {}
    parts = parse(name)
    for index, part in enumerate(parts):
        if isinstance(part, str):
            parts_of_pattern.append(re.escape(part))
            continue
        neighbours = [
            one for one in (*parts[index - 1 : index], *parts[index + 1 : index + 2]) if isinstance(one, Hole)
        ]
        if index and isinstance(parts[index - 1], Hole):
            continue
        if not part.label or neighbours:
            parts_of_pattern.append(unknown)
        elif part.label in groups:
            parts_of_pattern.append(rf"(?:\{groups[part.label]})")
        else:
            groups[part.label] = len(groups) + 1
            parts_of_pattern.append(f"({unknown})")
    return re.compile("".join(parts_of_pattern), re.DOTALL)


def fits(name: str, concrete: str, unknown: str = r"[^/.]+") -> bool:
    """Check whether a known name is a possible value of a name with holes."""
    return pattern(name, unknown).fullmatch(concrete) is not None


@lru_cache(maxsize=16_384)
def label_of(source: str) -> str:
    """Return the label for an unknown part from its source: a variable, parameter (`~/a.b`) or `argv[1]`.

    It is empty if the label would be meaningless: a single letter, or a word with another meaning in names.
    """
    if "--" in source:  # an option with its spellings: `argv[--topic|-t]`
        source = source.partition("[")[2].removesuffix("]").partition("|")[0]
    if source.startswith("port["):  # a port of a node in a behavior tree
        source = source.removeprefix("port[").removesuffix("]")
    source = source.replace("[]", "")  # each element of a list
    index = re.search(r"\w(\[\d+\])$", source)
    end = index[1] if index is not None else ""
    bare = anonymous(source).removesuffix(end)
    words = re.sub(r"[^A-Za-z0-9]+", "_", bare).strip("_")[:_LONGEST].rstrip("_")
    return "" if len(words) == 1 or not words[:1].isalpha() or words in SUBSTITUTIONS else words + end


def hole_of(source: str) -> str:
    """Return the hole for an unknown part, labelled by its source."""
    return f"{{{label_of(source)}}}"
