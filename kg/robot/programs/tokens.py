"""The text of a program as tokens: words, names and texts in quotes, numbers with their units, signs, ends of lines."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

from kg.errors import Place, RobotError
from kg.robot.programs.units import ALIASES, UNITS

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Kind", "Token", "quoted", "quoted_name", "refusal", "tokens"]

Kind = Literal["word", "name", "text", "number", "sign", "id", "comment", "line", "end of the program"]


@dataclass(frozen=True, slots=True)
class Token:
    """A token with its place, counted from one; `value` is what it means, `unit` that of a number."""

    kind: Kind
    value: str
    line: int
    column: int
    unit: str | None = None

    def __str__(self) -> str:
        if self.kind in {"line", "end of the program"}:
            return f"the end of the {'line' if self.kind == 'line' else 'program'}"
        return f"`{self.value}{' ' + self.unit if self.unit else ''}`"


_UNIT: Final = "|".join(re.escape(unit) for unit in sorted([*UNITS, *ALIASES], key=len, reverse=True))
_TOKEN: Final = re.compile(
    rf"""(?P<blank>[^\S\n]+)
    |(?P<comment>\#[^\n]*)
    |(?P<line>[\n;])
    |(?P<number>\d+(?:\.\d+)?(?:[eE][+-]?\d+)?)(?:[^\S\n]*(?P<unit>{_UNIT})(?![\w°]))?
    |(?P<word>[^\W\d]\w*)
    |(?P<text>"(?:[^"\\\n]|\\[^\n])*"|“[^”\n]*”)
    |(?P<name>'(?:[^'\\\n]|\\[^\n])*')
    |(?P<id>@(?:\w+|"(?:[^"\\\n]|\\[^\n])*"))
    |(?P<sign><=|>=|!=|==|[-+*/<>=()≤≥≠:,\u2212\u00d7])""",
    re.VERBOSE,
)
_SAME: Final = {"≤": "<=", "≥": ">=", "≠": "!=", "==": "=", "\u2212": "-", "\u00d7": "*"}


def refusal(text: str, path: str, token: Token, message: str, hint: str | None = None) -> RobotError:
    """Return the error that a program cannot be read, at a token."""
    lines = text.split("\n")
    excerpt = lines[token.line - 1] if token.line <= len(lines) else ""
    return RobotError("KG830", message, place=Place(path, token.line, token.column, excerpt), hint=hint)


def tokens(text: str, path: str) -> Iterator[Token]:
    """Yield the tokens of a program with one for its end; RobotError KG830 at what can be none."""
    position, line, begin = 0, 1, 0
    while position < len(text):
        column = position - begin + 1
        found = _TOKEN.match(text, position)
        if found is None or found.end() == position:
            wrong = Token("sign", text[position], line, column)
            hint = "A text or a name ends with the quote it began with, on the same line."
            raise refusal(text, path, wrong, f"{wrong} is not allowed here", hint if wrong.value in "\"'“" else None)
        position = found.end()
        if not found["blank"]:
            yield _token(text, path, found, line, column)
        if found[0] == "\n":
            line, begin = line + 1, position
    yield Token("end of the program", "", line, position - begin + 1)


def _token(text: str, path: str, found: re.Match[str], line: int, column: int) -> Token:
    if found["number"]:
        unit = found["unit"]
        return Token("number", found["number"], line, column, ALIASES.get(unit, unit))
    kind: Kind = found.lastgroup  # type: ignore[assignment] # the groups that are left are kinds
    value = found[0]
    if kind in {"text", "name"} or (kind == "id" and value[1] == '"'):
        try:
            value = _unquoted(value.removeprefix("@"))
        except ValueError:
            wrong = Token(kind, value, line, column)
            hint = r'After a backslash, write ", \, n, t or u with four digits.'
            raise refusal(text, path, wrong, f"{wrong} has an invalid escape", hint) from None
    elif kind == "comment":
        value = value[1:].removeprefix(" ")
    elif kind == "id":
        value = value[1:]
    return Token(kind, _SAME.get(value, value) if kind == "sign" else value, line, column)


def quoted(text: str) -> str:
    """Return a text in double quotes."""
    return json.dumps(text, ensure_ascii=False)


def quoted_name(name: str) -> str:
    """Return a name in single quotes."""
    return "'" + json.dumps(name, ensure_ascii=False)[1:-1].replace('\\"', '"').replace("'", "\\'") + "'"


def _unquoted(token: str) -> str:
    inner = token[1:-1]
    if token[0] == "“":
        return inner
    if token[0] == "'":
        inner = re.sub(r"\\.|\"", lambda part: {"\\'": "'", '"': '\\"'}.get(part[0], part[0]), inner)
    value: str = json.loads(f'"{inner}"', strict=False)
    return value
