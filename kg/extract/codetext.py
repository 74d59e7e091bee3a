"""The code of a file as text, without comments and literals: where words, functions and calls are.

It serves questions about code that never runs in the interpretation, such as callbacks in which nothing is declared.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

_CPP_HIDDEN: Final = re.compile(r'//[^\n]*|/\*.*?\*/|(?<!include )"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.DOTALL)
"""Comments and literals, except for the paths of includes."""
_PYTHON_HIDDEN: Final = re.compile(
    r"#[^\n]*|\"\"\".*?\"\"\"|'''.*?'''|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.DOTALL
)
_VISIBLE: Final = re.compile(r"[^\n]")
_CPP_SUFFIXES: Final = (".c", ".cc", ".cpp", ".cxx", ".h", ".hh", ".hpp", ".hxx", ".inl", ".ipp", ".tpp")
_BRACE: Final = re.compile(r"[{}]")
_BRACKET: Final = re.compile(r"[()]")
_FUNCTION_HEAD: Final = re.compile(
    r"\b([A-Za-z_]\w*)\s*\((?:[^(){};]|\([^(){};]*\))*\)\s*(?:const|override|final|noexcept|\s)*(?::[^;{}]*)?\Z"
)
_NO_FUNCTION: Final = frozenset({"if", "for", "while", "switch", "catch", "return", "sizeof", "decltype"})
_HEAD_LENGTH: Final = 2_000
"""Characters before the body of a function in which its head begins."""
_DEF: Final = re.compile(r"^([ \t]*)(?:async\s+)?def\s+(\w+)", re.MULTILINE)
_END_OF_HEAD: Final = re.compile(r"\)[^()\n]*:")
_DEFINES: Final = re.compile(r"\bdef\s+\Z")
_LINE: Final = re.compile(r"^([ \t]*)\S", re.MULTILINE)


@dataclass(slots=True)
class Function:
    """A function in a file, from its head over the begin of its body to the end."""

    name: str
    start: int
    body: int
    end: int


class CodeText:
    """A file of C++ or Python; places are offsets in `code`, in which comments and literals are spaces."""

    def __init__(self, path: str, content: bytes) -> None:
        self.path = path
        self.python = not path.endswith(_CPP_SUFFIXES)
        hidden = _PYTHON_HIDDEN if self.python else _CPP_HIDDEN
        self.code = hidden.sub(lambda match: _VISIBLE.sub(" ", match[0]), content.decode("latin-1"))
        self._places: dict[str, list[int]] = {}
        self._calls: dict[int, tuple[int, int]] = {}

    def places(self, word: str) -> list[int]:
        """Return where a word begins; a search for a text takes a tenth of the time of one for a pattern."""
        places = self._places.get(word)
        if places is None:
            places = self._places[word] = []
            at = self.code.find(word)
            while at >= 0:
                end = at + len(word)
                if not _is_letter(self.code[at - 1 : at]) and not _is_letter(self.code[end : end + 1]):
                    places.append(at)
                at = self.code.find(word, end)
        return places

    def statement_before(self, at: int, most: int) -> str:
        """Return the text between the begin of a statement of C++ and a place, at most some characters."""
        begin = max(self.code.rfind(mark, max(0, at - most), at) for mark in ";{}") + 1
        return self.code[max(begin, at - most) : at]

    @cached_property
    def _lines(self) -> list[int]:
        return [0, *(match.end() for match in re.finditer("\n", self.code))]

    def line_start(self, line: int) -> int:
        """Return where a line begins; the end of the file for one that it lacks."""
        return self._lines[line - 1] if 0 < line <= len(self._lines) else len(self.code)

    def call(self, line: int) -> tuple[int, int]:
        """Return the begin of a line and the end of the first call on it."""
        cached = self._calls.get(line)
        if cached is None:
            start, depth = self.line_start(line), 0
            end = start
            for bracket in _BRACKET.finditer(self.code, start):
                depth += 1 if bracket[0] == "(" else -1
                if depth <= 0:
                    end = bracket.start()
                    break
            cached = self._calls[line] = (start, end)
        return cached

    @cached_property
    def functions(self) -> list[Function]:
        """The functions, in the order of their begins."""
        return sorted(self._in_python() if self.python else self._in_cpp(), key=lambda one: one.start)

    def _in_cpp(self) -> Iterator[Function]:
        opened: list[Function | None] = []
        for brace in _BRACE.finditer(self.code):
            if brace[0] == "{":
                head = self.statement_before(brace.start(), _HEAD_LENGTH)
                match = _FUNCTION_HEAD.search(head)
                named = match is not None and match[1] not in _NO_FUNCTION
                start = brace.start() - len(head)
                opened.append(Function(match[1], start, brace.end(), brace.end()) if match and named else None)
            elif opened:
                function = opened.pop()
                if function is not None:
                    function.end = brace.start()
                    yield function

    def _in_python(self) -> Iterator[Function]:
        for head in _DEF.finditer(self.code):
            colon = _END_OF_HEAD.search(self.code, head.end())
            body = colon.end() if colon else head.end()
            after = _LINE.finditer(self.code, body)
            end = next((line.start() for line in after if len(line[1]) <= len(head[1])), len(self.code))
            yield Function(head[2], head.start(), body, end)

    def around(self, at: int) -> Function | None:
        """Return the outermost function around a place."""
        last = bisect_right(self.functions, at, key=lambda one: one.start)
        return next((one for one in self.functions[:last] if one.end > at), None)

    def names_of(self, function: str) -> Iterator[int]:
        """Yield the places that name a function, except those that define or declare it."""
        for at in self.places(function):
            if self.python:
                if not _DEFINES.search(self.code, max(0, at - _HEAD_LENGTH), at):
                    yield at
                continue
            outer = self.around(at)
            if outer is not None and (outer.name != function or "{" in self.code[outer.start : at]):
                yield at


def _is_letter(character: str) -> bool:
    return character.isalnum() or character == "_"
