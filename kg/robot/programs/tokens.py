"""Tokens of the text form, the keywords shared by parser and printer, and the parser's cursor.

Tokens are words, quoted names and texts, numbers with units, signs, and line ends.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

from kg.errors import Place, RobotError
from kg.robot.programs.units import ALIASES, UNITS
from kg.similar import did_you_mean

FUNCTIONS: Final = ("absolute", "round", "count")
"""Functions of one value, written with parentheses."""
BEGINNINGS: Final = frozenset(
    {"if", "while", "forever", "repeat", "for", "break", "set", "wait", "at", "whenever", "as", "log", "stop", "do"}
    | {"program"}
)
"""Keywords that begin a statement; any other word begins a capability."""
ENDINGS: Final = frozenset({"end", "otherwise", "also", "during"})
"""Keywords that end a sequence of statements."""
FOREIGN: Final = {
    "else": "Write `otherwise`.",
    "elif": "Write `otherwise if`.",
    "print": 'Write `log "..."`.',
    "let": "Write `set x to 3`.",
    "var": "Write `set x to 3`.",
}
"""Keywords of other languages with their counterparts here; a capability of such a name is quoted."""
RESERVED: Final = (
    frozenset({"and", "or", "not", "of", "contains", "true", "false", "then", "do", "for", "within", "times", "until"})
    | frozenset({"to", "step"})
    | ENDINGS
)
"""Keywords of expressions, which cannot be unquoted names of variables or parameters."""
BARE: Final = re.compile(r"[^\W\d]\w*")


def bare_name(name: str) -> bool:
    """Return whether a name of a variable, parameter or capability needs no quotes in an expression."""
    return BARE.fullmatch(name) is not None and name.lower() not in RESERVED | set(FUNCTIONS)


def bare_phrase(capability: str) -> bool:
    """Return whether a capability needs no quotes at the start of a statement."""
    words = capability.split(" ")
    return all(BARE.fullmatch(word) and word.lower() not in ENDINGS for word in words) and (
        words[0].lower() not in BEGINNINGS | FOREIGN.keys() or (words[0].lower() == "stop" and len(words) > 1)
    )


Kind = Literal["word", "name", "text", "number", "sign", "id", "comment", "line", "end of the program"]


@dataclass(frozen=True, slots=True)
class Token:
    """A token with its place, counted from one; `value` is its meaning, `unit` that of a number."""

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
    """Return the syntax error at a token."""
    lines = text.split("\n")
    excerpt = lines[token.line - 1] if token.line <= len(lines) else ""
    return RobotError("KG830", message, place=Place(path, token.line, token.column, excerpt), hint=hint)


def tokens(text: str, path: str) -> Iterator[Token]:
    """Yield the tokens of a program and an end token; RobotError KG830 at an invalid character."""
    position, line, begin = 0, 1, 0
    while position < len(text):
        column = position - begin + 1
        match = _TOKEN.match(text, position)
        if match is None or match.end() == position:
            wrong = Token("sign", text[position], line, column)
            hint = "A text or a name ends with the quote it began with, on the same line."
            raise refusal(text, path, wrong, f"{wrong} is not allowed here", hint if wrong.value in "\"'“" else None)
        position = match.end()
        if not match["blank"]:
            yield _token(text, path, match, line, column)
        if match[0] == "\n":
            line, begin = line + 1, position
    yield Token("end of the program", "", line, position - begin + 1)


def _token(text: str, path: str, match: re.Match[str], line: int, column: int) -> Token:
    if match["number"]:
        unit = match["unit"]
        return Token("number", match["number"], line, column, ALIASES.get(unit, unit))
    kind: Kind = match.lastgroup  # type: ignore[assignment] # the groups that are left are kinds
    value = match[0]
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


class Cursor:
    """The tokens of a text, pending comments, and the places of the parts parsed so far.

    `begun` are the lines of the open statements, the innermost last.
    """

    def __init__(self, text: str, path: str) -> None:
        """Tokenize a text; RobotError KG830 at an invalid character."""
        self.text = text.replace("\r\n", "\n").removeprefix("\ufeff")
        self.path = path
        self.comments: list[str] = []
        self.begun: list[int] = []
        self.places: dict[str, tuple[int, int]] = {}
        self._tokens = list(tokens(self.text, path))
        self._next = 0

    @property
    def token(self) -> Token:
        """The next token."""
        return self._tokens[self._next]

    def ahead(self, far: int = 1) -> Token:
        """Return a later token; the end token beyond the end."""
        return self._tokens[min(self._next + far, len(self._tokens) - 1)]

    def take(self) -> Token:
        """Consume and return the next token."""
        token = self.token
        self._next = min(self._next + 1, len(self._tokens) - 1)
        return token

    def kind(self, *kinds: Kind) -> bool:
        """Return whether the next token is of one of these kinds."""
        return self.token.kind in kinds

    def word(self, *words: str) -> bool:
        """Return whether the next token is one of these words, in any case."""
        return self.token.kind == "word" and self.token.value.lower() in words

    def phrase(self, phrase: str) -> bool:
        """Consume a phrase if it comes next, and return whether it did."""
        words = phrase.split()
        following = [self.ahead(far) for far in range(len(words))]
        if [one.value.lower() if one.kind == "word" else "" for one in following] != words:
            return False
        self._next += len(words)
        return True

    def sign(self, *signs: str) -> bool:
        """Return whether the next token is one of these signs."""
        return self.token.kind == "sign" and self.token.value in signs

    def note(self, path: str) -> None:
        """Record that the part with this path begins here."""
        self.places.setdefault(path, (self.token.line, self.token.column))

    def skip(self) -> None:
        """Skip line ends, and collect comments."""
        while self.kind("line", "comment"):
            token = self.take()
            if token.kind == "comment":
                self.comments.append(token.value)

    def take_comments(self) -> str:
        """Return the pending comments as one."""
        comment = "\n".join(self.comments)
        self.comments.clear()
        return comment

    def expected(self, what: str, *, hint: str | None = None) -> RobotError:
        """Return the syntax error (KG830) for an unexpected token, with a suggestion for a misspelt word."""
        begin = self._next
        while begin and self._tokens[begin - 1].kind != "line":
            begin -= 1
        first = self._tokens[begin]
        suggestion = None
        if first.kind == "word" and first.value.lower() not in BEGINNINGS | ENDINGS:
            suggestion = did_you_mean(first.value, BEGINNINGS | ENDINGS)
        return refusal(self.text, self.path, self.token, f"expected {what}, found {self.token}", suggestion or hint)

    def refused(self, token: Token, message: str, hint: str | None = None) -> RobotError:
        """Return a syntax error (KG830) at a token."""
        return refusal(self.text, self.path, token, message, hint)
