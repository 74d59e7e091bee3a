"""Which parts of its message the code of a publisher leaves empty, and which it sets.

The types are those of `ontology/message-parts.toml`. All messages of the type that the code creates have to begin
empty, and nothing else may fill them: no function gets one, and none is assigned as a whole. A part counts as set where
the code names it, unless it sets it to zero, or sets the covariance that means that it is not measured (REP 145).
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Final

from kg.facts import Role
from kg.resources import table_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kg.extract.codetext import CodeText
    from kg.facts import Interface, NodeType

_SELF: Final = r"(?:self\.|this->)?"
_PUBLISHED: Final = re.compile(rf"\w+\s*(?:\.|->)\s*publish\s*\(\s*(?:std::move\()?\s*[&*]?{_SELF}(\w+)\s*\)")
"""A publisher that publishes a variable."""
_ZERO: Final = re.compile(r"\.covariance\b|(?:\.\w+)*(?:\[\w+\])?\s*=\s*-?0(?:\.0*)?f?\s*[;\n]")
"""What follows a part that is set to zero, or of which only the covariance is set."""
_MINUS_ONE: Final = re.compile(r"[{\[]?\s*-\s*1(?:\.0*)?f?\s*(?:[,}\]].*)?")
_WHOLE: Final = re.compile(rf"\s*=(?!=)\s*(?={_SELF}(\w+)\s*[;\n])?(.*)", re.DOTALL)
"""What a variable is assigned: another variable, and the text of it."""
_PASSED_AFTER: Final = re.compile(r"\s*(?:(?:\.|->)get\(\s*\))?\s*[,)]")
_PASSED_BEFORE: Final = re.compile(rf"[(,]\s*[&*]?{_SELF}\Z")
_SENT: Final = re.compile(rf"\b(?:publish|sendTransform|info|move)\(\s*[&*]?(?:std::move\(\s*)?{_SELF}\Z")
"""Calls that do not change the message that they get."""
_SET: Final = re.compile(r"(?:\s*(?:\.|->)\s*\w+(?:\(\w*\))?|\[[^\[\]]*\])*\s*(?:\+?=(?!=)|<<|[,)])")
"""What follows a part that is set: fields of it, and an assignment, or the end of an argument."""
_LOOKED_AT: Final = 200
"""Characters around a name that show what is done with it."""


def unset_parts(
    end: Interface,
    node: NodeType,
    file: CodeText,
    uses: list[tuple[CodeText, int]] | None,
    with_word: Callable[[str], Iterator[CodeText]],
) -> tuple[str, ...]:
    """Return the parts of its message that the code of a publisher leaves empty, if it sets another.

    `file` creates it, `uses` are the places that use it, `with_word` returns the files of its package with a word. A
    node that also receives such messages has to publish none but those that it creates.
    """
    parts = _parts().get(end.type or "", ())
    if not parts:
        return ()
    short = (end.type or "").rpartition("/")[2]
    read = [file, *(one for one in with_word(short) if one is not file and _is_named(one, file))]
    patterns = _creations(short, python=file.python)
    empty = {match[1] for one in read for pattern in patterns for match in pattern.finditer(one.code)}
    received = any(one.role is Role.SUBSCRIBES and one.type == end.type for one in node.interfaces)
    if received and not (uses and all(_published(one, at) in empty for one, at in uses)):
        return ()
    if not empty or any(_is_filled_elsewhere(name, short, empty, one) for name in empty for one in read):
        return ()
    holders = rf"\b(?:{'|'.join(sorted(empty))})\s*(?:\.|->)\s*"
    filled = {part for part in parts for one in read if _sets(part, holders, one)}
    missing = {part for part in parts for one in read if _declares_missing(part, holders, one)}
    return tuple(part for part in parts if part not in filled or part in missing) if filled else ()


def set_parts(end: Interface, file: CodeText) -> tuple[str, ...]:
    """Return the parts of its message that the file that creates a publisher sets, in any message of its type."""
    return tuple(part for part in _parts().get(end.type or "", ()) if _is_set(part, file))


def _is_set(part: str, file: CodeText) -> bool:
    """Check whether a file assigns a part of a message, passes it to code that may, or gives it as an argument."""
    named = re.finditer(rf"(?:\.|->)\s*{part}\b", file.code)
    if any(_SET.match(file.code, one.end()) and not _ZERO.match(file.code, one.end()) for one in named):
        return True
    return file.python and re.search(rf"\b{part}\s*=(?!=)\s*\w", file.code) is not None


def _is_named(other: CodeText, file: CodeText) -> bool:
    """Check whether a file may include or import another."""
    return other.python == file.python and PurePosixPath(other.path).stem in file.code


def _published(file: CodeText, at: int) -> str | None:
    """Return the variable that is published at a place."""
    match = _PUBLISHED.match(file.code, at)
    return match[1] if match is not None else None


@cache
def _creations(short: str, *, python: bool) -> tuple[re.Pattern[str], ...]:
    """Return the patterns of variables that begin as an empty message of a type."""
    if python:
        return (re.compile(rf"\b(\w+)\s*=\s*(?:\w+\.)*{short}\(\s*\)"),)
    kind = rf"\b{short}(?:_<[^<>;]*>)?"
    scoped = rf"(?:\w+::)*{kind}"
    creation = rf"(?:new\s+{scoped}|std::make_(?:shared|unique)<{scoped}>|{scoped})\s*[({{]\s*[)}}]"
    declared = rf"{kind}(?:::(?:Shared|Unique)?Ptr)?\s+(\w+)\s*(?:;|\{{\s*\}})"
    return re.compile(declared), re.compile(rf"\b(\w+)\s*[=(]\s*{creation}")


def _is_filled_elsewhere(name: str, short: str, empty: set[str], file: CodeText) -> bool:
    """Check whether a message is assigned as a whole, except from one that begins `empty`, or passed to other code."""
    for start in file.places(name):
        end = start + len(name)
        after, before = file.code[end : end + _LOOKED_AT], file.code[max(0, start - _LOOKED_AT) : start]
        given = _WHOLE.match(after)
        if given is not None and given[1] not in empty and not re.match(rf"new\s|[\w.:<>]*\b{short}\b", given[2]):
            return True
        if _PASSED_AFTER.match(after) and _PASSED_BEFORE.search(before) and not _SENT.search(before):
            return True
    return False


def _sets(part: str, holders: str, file: CodeText) -> bool:
    """Check whether a file names a part of a message otherwise than to set it to zero."""
    named = re.finditer(rf"{holders}{part}\b", file.code)
    return any(not _ZERO.match(file.code, one.end()) for one in named)


def _declares_missing(part: str, holders: str, file: CodeText) -> bool:
    """Check whether a file gives the covariance of a part the value that means that the part is not measured."""
    first = r"(?:\[\s*0\s*\]|\.at\(\s*0\s*\))?"
    given = re.findall(rf"{holders}{part}_covariance\s*{first}\s*=\s*([^;\n]+)", file.code)
    return bool(given) and all(_MINUS_ONE.fullmatch(value.strip()) for value in given)


@cache
def _parts() -> dict[str, tuple[str, ...]]:
    """Return the parts of messages that code may leave empty, by type."""
    return {kind: tuple(parts) for kind, parts in table_of("ontology", "message-parts.toml").items()}
