"""Sources of C++ as the grammar can read them: what only a preprocessor understands becomes spaces.

Each byte stays at its place, so that lines and columns are those of the file.
"""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING, Final

from kg.extract.cpp.conditions import Macros, holds

if TYPE_CHECKING:
    from collections.abc import Callable

_CLASS_HEAD: Final = re.compile(rb"\b(class|struct)(\s+)([A-Z][A-Z0-9_]{3,})(\s+)(?=[A-Za-z_]\w*\s*(?:final\s*)?[:{])")
_EXPORTED: Final = (re.compile(rb"class\s+[A-Z][A-Z0-9_]{3,}\s"), re.compile(rb"struct\s+[A-Z][A-Z0-9_]{3,}\s"))
"""What every match of `_CLASS_HEAD` contains; a literal in front is found much faster."""
_VISIBILITY: Final = re.compile(rb"\b[A-Z][A-Z0-9_]*_(?:PUBLIC|LOCAL|EXPORT|API|VISIBILITY)(?=\s+[A-Za-z_~])")
"""Macros in front of a declaration that say whether a library exports it."""
_QT: Final = re.compile(
    rb"\bQ_(?:OBJECT|GADGET|SLOTS)\b|\bQ_SIGNALS\s*:|\b(?:public|protected|private)\s+slots(?=\s*:)"
)
_ALONE: Final = re.compile(
    rb"^[ \t]*[A-Z][A-Z0-9]*_[A-Z0-9_]+(?:[ \t]*(?=(?://[^\n]*)?\r?\n\s*[A-Za-z_~}#/])"
    rb"|(?P<declares>\s+)(?=(?:\w+::)*(\w+)::~?\2\s*\(|(?!const\b|volatile\b)[A-Za-z_][\w:]*(?:<[^;(){}]*>)?[\s*&]+[\w:~]+\s*\())",
    re.MULTILINE,
)
"""A macro on a line of its own, such as `EIGEN_MAKE_ALIGNED_OPERATOR_NEW`, or a part of an expression; or one that
stands before a declaration of a function with its type, such as `ROS_DEPRECATED`, or before that of a constructor."""
_LAST: Final = re.compile(
    rb"^[ \t]*[A-Z][A-Z0-9]*_[A-Z0-9_]+\((?:[^;{}()\n]|\([^;{}()\n]*\))*\)[ \t]*(?://[^\n]*)?\r?\n\s*[ \t](?=\})",
    re.MULTILINE,
)
"""A macro with arguments that ends a block, such as the members of a class, without a semicolon."""
_LISTED: Final = re.compile(
    rb"^[ \t]*[A-Z][A-Z0-9_]+(?:\([^;{}()\n]*\))?[ \t]*\r?\n(?P<undef>[ \t]*#[ \t]*undef[ \t]+\w+)", re.MULTILINE
)
"""A macro that lists calls of another one, which is defined for it just before and undefined just after."""
_NO_BLOCK: Final = re.compile(rb"(?:\benum\b[^;{}]*|=\s*|\breturn\s*|[,(]\s*)\{\Z")
"""The begin of a list in braces."""
_MACROS_ONLY: Final = re.compile(
    rb"\b(?:class|struct)\s+\w+[^;{}()]*\{(?P<body>\s*(?:[A-Z][A-Z0-9]*_[A-Z0-9_]+\s*\([^(){};]*\)\s*)+)\}"
)
"""A class whose body consists of calls of macros, without semicolons."""
_IN_A_ROW: Final = re.compile(rb"[A-Z][A-Z0-9_]+(?:[ \t]+[A-Z][A-Z0-9_]+)+(?=[ \t]*(?:[;,)}+\"]|<<))")
"""Macros in a row that end an expression, such as parts of a text."""
_BEFORE_ROW: Final = re.compile(rb"(?:[=(,+?:{<]|\breturn)\s*\Z")
_SPACE: Final = re.compile(rb"[ \t](?=[A-Z])")
_CONNECTED: Final = re.compile(rb"\b((?:SIGNAL|SLOT)\(\s*)(\w+\s*\([^()]*\))(?=\s*\))")
"""The signatures of signals and slots, which are no expressions."""
_DIRECTIVE: Final = re.compile(
    rb"^[ \t]*#[ \t]*(if|ifdef|ifndef|elif|else|endif|define|undef)\b(?:[^\n\\]|\\\r?\n|\\.)*", re.MULTILINE
)
_SET: Final = re.compile(rb"[ \t]*#[ \t]*\w+[ \t]+(\w+)(\(?)[ \t]*((?:[^\n/]|/(?![/*]))*)")
"""A macro that is defined or undefined, whether it has parameters, and its text without comments."""
_UNDEFINED: Final = re.compile(rb"[ \t]*#[ \t]*(?:ifndef[ \t]+|if[ \t]*![ \t]*defined[ \t]*\(?[ \t]*)(\w+)\b")
_DEFINED: Final = re.compile(rb"^[ \t]*#[ \t]*define[ \t]+(\w+)[ \t]*(?:/[/*].*)?\r?$", re.MULTILINE)
"""Macros without a value: guards of headers, which may look like flags for a version of ROS. Others are defaults."""
_HAS_INCLUDE: Final = b"__has_include"
_UNFINISHED: Final = re.compile(rb"(?:[,(=|?<]|&&|[^:]:)\Z")
"""The end of code that goes on in what follows, such as a list of arguments."""
_HEAD: Final = re.compile(rb"(?:\b(?:if|while|switch)\b[^;{}]*\)|\bfor\b[^{}]*\)|\belse)\Z")
"""The head of a statement whose body follows."""
_CONTINUED: Final = re.compile(rb"\s*(?:[,)?=|]|\.\w|&&|<<|:[^:]|else\b)")
"""The begin of code that goes on from what is before it."""
_LEFT_OUT: Final = re.compile(rb"/\*.*?\*/|//[^\n]*|^[ \t]*#[^\n]*", re.DOTALL | re.MULTILINE)
"""Comments and lines of the preprocessor."""
_NEAR: Final = 300
"""Bytes before and after a place that are searched for the code next to it."""
_VISIBLE: Final = re.compile(rb"[^\r\n]")


def prepared(source: bytes, ros: int, absent: frozenset[str] = frozenset()) -> bytes:
    """Return a source of the same length as a package of ROS 1 or 2 compiles it without the macros in `absent`.

    It lacks macros that hide declarations, code for the other ROS, and the sides of `#if` that split a block or an
    expression.
    """
    if any(one.search(source) for one in _EXPORTED):
        source = _CLASS_HEAD.sub(lambda m: m[1] + m[2] + b" " * len(m[3]) + m[4], source)
    source = _VISIBILITY.sub(_unless_directive(_spaces), source)
    if b"undef" in source:
        source = _LISTED.sub(_with_semicolon, source)
    source = _ALONE.sub(_if_statement, source)
    source = _MACROS_ONLY.sub(lambda m: m[0].replace(m["body"], _VISIBLE.sub(b" ", m["body"])), source)
    source = _LAST.sub(_unless_directive(lambda m: m[0][:-1] + b";"), source)
    if b"Q_" in source or b" slots" in source:
        source = _QT.sub(_unless_directive(_of_qt), source)
    if b"SIGNAL(" in source or b"SLOT(" in source:
        source = _CONNECTED.sub(lambda m: m[1] + b"0" + _VISIBLE.sub(b" ", m[2])[1:], source)
    source = _IN_A_ROW.sub(_unless_directive(_joined), source)
    return _without_branches(source, ros, absent) if b"#if" in source or b"# if" in source else source


def _if_statement(match: re.Match[bytes]) -> bytes:
    """Return spaces for a macro that stands where a statement or declaration begins, else the macro."""
    before = _before(match.string, match.start())
    begins = before.endswith((b";", b"}", b":")) or (match["declares"] and (not before or before.endswith(b"{")))
    return _VISIBLE.sub(b" ", match[0]) if begins else match[0]


def _with_semicolon(match: re.Match[bytes]) -> bytes:
    """Return a macro that lists calls with the semicolon of a statement in place of the directive after it."""
    before = _before(match.string, match.start())
    if not before.endswith((b";", b"}", b":", b"{")) or _NO_BLOCK.search(before):
        return match[0]
    return match[0][: match.start("undef") - match.start()] + b";".ljust(len(match["undef"]))


def _joined(match: re.Match[bytes]) -> bytes:
    """Return macros in a row in an expression with signs between them, as the grammar reads only texts in a row."""
    line = match.string.rfind(b"\n", 0, match.start()) + 1
    return _SPACE.sub(b"+", match[0]) if _BEFORE_ROW.search(match.string[line : match.start()]) else match[0]


def _spaces(match: re.Match[bytes]) -> bytes:
    return b" " * len(match[0])


def _of_qt(match: re.Match[bytes]) -> bytes:
    """Return what a word of Qt means for declarations: signals begin a part of a class."""
    if match[0].startswith(b"Q_SIGNALS"):
        return b"public".ljust(len(match[0]) - 1) + b":"
    return match[0].replace(b"slots", b"     ") if match[0].endswith(b"slots") else _spaces(match)


def _unless_directive(change: Callable[[re.Match[bytes]], bytes]) -> Callable[[re.Match[bytes]], bytes]:
    """Return a change of matches that leaves those in lines of the preprocessor alone."""

    def changed(match: re.Match[bytes]) -> bytes:
        start = match.string.rfind(b"\n", 0, match.start()) + 1
        in_directive = match.string[start : match.start()].lstrip().startswith(b"#")
        return match[0] if in_directive else change(match)

    return changed


class _Group:
    """An `#if` with its directives so far."""

    def __init__(self, first: re.Match[bytes], condition: bool | None) -> None:  # noqa: FBT001 - a truth of three values
        self.marks = [first]
        self.conditions = [condition]
        """Whether each side is compiled if none before it is; None if that is unknown."""
        self.guarded = False

    def compiled(self) -> bool | None:
        """Return whether the side that was begun last is compiled; None if that is unknown."""
        if self.guarded:
            return True
        if True in self.conditions[:-1] or self.conditions[-1] is False:
            return False
        return None if None in self.conditions else True


def _without_branches(source: bytes, ros: int, absent: frozenset[str]) -> bytes:
    """Return a source without the sides of `#if` that are not compiled, or that split a block or an expression.

    Not compiled is what is for the other ROS, and what the macros exclude that the file defines. Of the sides that
    split something the first is left that may be compiled. All sides of a test with `__has_include` are left; the
    grammar does not know the test itself.
    """
    result = bytearray(source)
    macros = Macros(ros, frozenset(_DEFINED.findall(source)), frozenset(name.encode() for name in absent))
    groups: list[_Group] = []
    before: re.Match[bytes] | None = None
    for directive in _DIRECTIVE.finditer(source):
        kind = directive[1]
        if kind in (b"define", b"undef"):
            _set_macro(directive, before, groups, macros)
        elif kind.startswith(b"if"):
            groups.append(_Group(directive, holds(directive[0], macros)))
        elif groups:
            groups[-1].marks.append(directive)
            if kind == b"endif":
                group = groups.pop()
                _keep_sides(result, group.marks, group.conditions)
            else:
                groups[-1].conditions.append(holds(directive[0], macros))
                groups[-1].guarded = False
        before = directive
    return bytes(result)


def _set_macro(
    directive: re.Match[bytes], before: re.Match[bytes] | None, groups: list[_Group], macros: Macros
) -> None:
    """Record what a `#define` or `#undef`, within groups and after another directive, says about a macro."""
    match = _SET.match(directive[0])
    if match is None:
        return
    name, text = match[1], None if directive[1] == b"undef" or match[2] else match[3].strip()
    guard = _UNDEFINED.match(before[0]) if before is not None and text == b"" else None
    if guard is not None and guard[1] == name and groups and len(groups[-1].marks) == 1:
        groups[-1].guarded = True
    compiled = [group.compiled() for group in groups]
    if False in compiled:
        return
    if None in compiled or match[2]:
        macros.texts.pop(name, None)
    else:
        macros.texts[name] = text


def _keep_sides(source: bytearray, marks: list[re.Match[bytes]], conditions: list[bool | None]) -> None:
    """Blank the sides of an `#if` that are not compiled, and its directives if the grammar cannot read them.

    `conditions` has for each side whether its condition holds, None if that is unknown.
    """
    sides = [(one.end(), other.start()) for one, other in pairwise(marks)]
    first = conditions.index(True) if True in conditions else len(conditions)
    live = [place for place, one in enumerate(conditions[: first + 1]) if one is not False]
    splits = any(_splits(source, *side) for side in sides) or _in_statement(source, marks, sides)
    if splits:
        live = live[:1]
    elif live == list(range(len(sides))) and not any(_HAS_INCLUDE in mark[0] for mark in marks):
        return
    for mark in marks:
        _blank(source, mark.start(), mark.end())
    for place, (start, end) in enumerate(sides):
        if place not in live:
            _blank(source, start, end)


def _splits(source: bytearray, start: int, end: int) -> bool:
    """Return whether a side opens other braces than it closes, or closes one that it has not opened."""
    if source.count(b"{", start, end) != source.count(b"}", start, end):
        return True
    return -1 < source.find(b"}", start, end) < source.find(b"{", start, end)


def _in_statement(source: bytearray, marks: list[re.Match[bytes]], sides: list[tuple[int, int]]) -> bool:
    """Return whether an `#if` is within a statement, an expression or a list of initialisers."""
    before = _before(source, marks[0].start())
    ends = (_before(source, end) for _, end in sides)
    if _UNFINISHED.search(before) or any(_HEAD.search(code) for code in (before, *ends)):
        return True
    after = (marks[-1].end(), len(source))
    begins = (source[begin : min(end, begin + _NEAR)] for begin, end in (*sides, after))
    return any(_CONTINUED.match(_LEFT_OUT.sub(b"", begin)) for begin in begins)


def _before(source: bytes | bytearray, place: int) -> bytes:
    """Return the end of the code before a place."""
    return _LEFT_OUT.sub(b"", source[max(0, place - _NEAR) : place]).rstrip()


def _blank(source: bytearray, start: int, end: int) -> None:
    source[start:end] = _VISIBLE.sub(b" ", bytes(source[start:end]))
