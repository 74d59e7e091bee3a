"""Macros of a file: what they stand for, and lists of macro calls."""

from __future__ import annotations

import json
import re
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.extract.cpp.units import CppUnit
    from kg.symbolic.form import Function

CONTINUED: Final = re.compile(r"\\\r?\n")
"""The end of a line of a macro that goes on."""
_DEFINED_WITH_PARAMETERS: Final = re.compile(
    rb"^[ \t]*#[ \t]*define[ \t]+(\w+)\(([\w \t,]*)\)[ \t]+((?:[^\n\\]|\\\r?\n|\\.)*)", re.MULTILINE
)
_PLACES: Final = re.compile(r"(?:(?<!#)(?P<quoted>#)(?!#)\s*)?\b(?P<name>[A-Za-z_]\w*)")
"""A name in the text of a macro, which can be made a text."""
_PASTED: Final = re.compile(r"\s*##\s*")
_CALL: Final = re.compile(r"\s*([A-Za-z_]\w*)\s*\(")
_PART: Final = re.compile(r'"(?:[^"\\]|\\.)*"|[()\[\]{},]')
_LINE: Final = re.compile(rb"^[ \t]*(\w+)[ \t]*\(.*$", re.MULTILINE)
_MOST_NESTED: Final = 8
EXPORTS: Final = {
    "PLUGINLIB_EXPORT_CLASS": 0,
    "PLUGINLIB_DECLARE_CLASS": 2,
    "PLUGINLIB_REGISTER_CLASS": 1,
    "RCLCPP_COMPONENTS_REGISTER_NODE": 0,
    "CLASS_LOADER_REGISTER_CLASS": 0,
    **dict.fromkeys(
        (f"GZ_REGISTER_{kind}_PLUGIN" for kind in ("MODEL", "WORLD", "SENSOR", "SYSTEM", "VISUAL", "GUI")), 0
    ),
    **dict.fromkeys(("GZ_ADD_PLUGIN", "IGNITION_ADD_PLUGIN"), 0),
}
"""Macros that register a class, with the index of the class among their arguments."""
_DECLARES: Final = re.compile(rf"\b(?:{'|'.join(EXPORTS)})\b|\busing\s+[\w#]+\s*=".encode())
"""What macros register or declare that are expanded: classes, and other names of types."""
DECLARING: Final = re.compile(
    rf"^(?!(?:{'|'.join(EXPORTS)})\b)([A-Z][A-Z0-9_]+)\(.*\)[ \t]*;?[ \t]*\r?$".encode(), re.MULTILINE
)
"""A call of a macro that is a line of its own, outside of functions."""


@dataclass(slots=True, eq=False)
class Macro:
    """A macro; `parameters` is None for one without a parameter list."""

    unit: CppUnit
    name: str
    parameters: tuple[str, ...] | None
    text: str
    line: int
    earlier: Macro | None = None
    """The macro that the same file defined under the same name before."""
    functions: dict[tuple[int, tuple[str, ...]], Function] = field(default_factory=dict)
    """The macro as a function, by the line at which it was expanded, and the arguments if they became its text."""

    @property
    def is_list(self) -> bool:
        """Whether it may be calls of another macro in a row."""
        return self.text.endswith(")") and self.text.count("(") > 1 and ";" not in self.text

    @property
    def is_textual(self) -> bool:
        """Whether it makes texts or names of its arguments."""
        return self.parameters is not None and "#" in self.text

    def filled(self, given: tuple[str, ...]) -> str:
        """Return the text with arguments in the places of the parameters."""
        return _filled(self.parameters or (), self.text, given)


def _filled(parameters: tuple[str, ...], text: str, given: tuple[str, ...]) -> str:
    values = dict(zip(parameters, given, strict=False))

    def place(match: re.Match[str]) -> str:
        value = values.get(match["name"])
        if value is None:
            return match[0]
        return json.dumps(value) if match["quoted"] else value

    return _PASTED.sub("", _PLACES.sub(place, text))


def calls_in(text: str) -> list[tuple[str, tuple[str, ...]]]:
    """Return the calls of a text that consists of calls in a row, each with its arguments; none for other texts."""
    calls: list[tuple[str, tuple[str, ...]]] = []
    place = 0
    while (call := _call_at(text, place)) is not None:
        name, arguments, place = call
        calls.append((name, arguments))
    return calls if not text[place:].strip() else []


def _call_at(text: str, place: int) -> tuple[str, tuple[str, ...], int] | None:
    """Return the call that begins at a place: its name, its arguments and where it ends; None if none does."""
    head = _CALL.match(text, place)
    if head is None:
        return None
    depth, begin, arguments = 1, head.end(), []
    for part in _PART.finditer(text, begin):
        depth += 1 if part[0] in "([{" else -1 if part[0] in ")]}" else 0
        if depth == 0 or (depth == 1 and part[0] == ","):
            arguments.append(text[begin : part.start()].strip())
            begin = part.end()
        if depth == 0:
            return head[1], tuple(arguments), begin
    return None


class Registrations:
    """The macros of a package that register classes by those of a framework, or declare types: `EXPORT(Scan)`.

    Their calls are replaced by what they stand for, on the same line, since they declare what other code names.
    """

    def __init__(self, sources: Iterable[bytes]) -> None:
        """Take the contents of files."""
        self._macros: dict[str, tuple[tuple[str, ...], str]] = {}
        for source in sources:
            if b"define" in source and _DECLARES.search(source) is not None:
                self._add(source)

    def _add(self, source: bytes) -> None:
        defined = {match[1]: match for match in _DEFINED_WITH_PARAMETERS.finditer(source)}
        found = {name for name, match in defined.items() if _DECLARES.search(match[3]) is not None}
        size = -1
        while len(found) > size:  # macros that call these
            size = len(found)
            found |= {name for name, match in defined.items() if not found.isdisjoint(re.findall(rb"\w+", match[3]))}
        for name in found:
            parameters = tuple(one.strip() for one in defined[name][2].decode().split(","))
            text = CONTINUED.sub(" ", defined[name][3].decode("utf-8", "replace"))
            self._macros[name.decode()] = parameters, text.strip()

    def expanded(self, source: bytes) -> bytes:
        """Return a file with the lines that only call such macros expanded; the same object if it has none."""
        if not any(name.encode() in source for name in self._macros):
            return source
        return _LINE.sub(self._line, source)

    def _line(self, match: re.Match[bytes]) -> bytes:
        before = match.string[max(match.start() - 3, 0) : match.start()]
        if match[1].decode() not in self._macros or before.rstrip(b"\r\n").endswith(b"\\"):
            return match[0]  # the latter is within a macro
        text = match[0].decode("utf-8", "replace").partition("//")[0].strip().removesuffix(";")
        return self._text(text, 0).encode() or match[0]

    def _text(self, text: str, depth: int) -> str:
        """Return what calls of such macros in a text stand for, each call followed by a semicolon."""
        pattern = "|".join(map(re.escape, self._macros))
        place, parts = 0, []
        for match in re.finditer(rf"\b(?:{pattern})\s*\(", text):
            if match.start() < place:
                continue
            call = _call_at(text, match.start())
            if call is None or depth > _MOST_NESTED:
                return ""
            name, given, end = call
            parameters, inner = self._macros[name]
            parts += [text[place : match.start()], self._text(_filled(parameters, inner, given), depth + 1)]
            place = end
        return "".join([*parts, text[place:], ";"])


def add_inner_macros(unit: CppUnit) -> None:
    """Add macros with parameters that bodies of functions or classes define, often several of one name."""
    found = list(_DEFINED_WITH_PARAMETERS.finditer(unit.source))
    often = Counter(match[1] for match in found)
    for match in found:
        name = match[1].decode()
        if often[match[1]] > 1 or name not in unit.macros:
            parameters = tuple(one.strip() for one in match[2].decode().split(","))
            text = CONTINUED.sub(" ", match[3].decode()).strip()
            line = unit.source.count(b"\n", 0, match.start()) + 1
            earlier = unit.macros.get(name)
            earlier = earlier if earlier is not None and earlier.line < line else None
            unit.macros[name] = Macro(unit, name, parameters, text, line, earlier)
