"""Expressions of SPARQL as blocks; an expression without a block stays text, as a whole.

The grammar is that of SPARQL 1.1, productions from Expression on; the text was checked by the parser of rules before.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, get_args, get_type_hints

from kg.rules.blocks.tree import (
    Compare,
    Formula,
    Join,
    Known,
    Logic,
    Match,
    Name,
    Not,
    Number,
    Of,
    Reckon,
    Says,
    Text,
    Thing,
    Truth,
)
from kg.rules.decompose.expressions import bare
from kg.syntax.lexer import END, Kind, as_operator, quoted, token_at, tokens_of, unescape

if TYPE_CHECKING:
    from kg.rules.blocks.tree import Test, Value
    from kg.syntax.lexer import Token

_LEVELS: Final = (("||",), ("&&",), ("=", "!=", "<", "<=", ">", ">="), ("+", "-"), ("*", "/"))
"""Operators, from those that bind least."""
_WORDS: Final = {"||": "or", "&&": "and"}
_TESTS: Final = (Compare, Match, Known, Logic, Not, Says)
_MATCHES: Final = frozenset(get_args(get_type_hints(Match)["how"]))
_FUNCTIONS: Final = frozenset(get_args(get_type_hints(Of)["function"]))


class _NoBlock(Exception):  # noqa: N818 - no error: there is only no block for it
    """No block exists for an expression."""


def test_of(text: str) -> Test | None:
    """Return the test of an expression; None if a part of it has no block."""
    found = _parsed(text)
    return found if isinstance(found, _TESTS) else None


def value_of(text: str) -> Value:
    """Return the value of an expression, as SPARQL if a part of it has no block."""
    found = _parsed(text)
    return Formula(text=formula(text)) if found is None or isinstance(found, _TESTS) else found


def formula(text: str) -> str:
    """Return an expression without the brackets around all of it, and without comments; lines are joined."""
    kept = tokens_of(bare(text))
    spaced = zip([None, *kept], kept, strict=False)
    return "".join((" " if one and one.end < other.start else "") + other.text for one, other in spaced)


def _parsed(text: str) -> Test | Value | None:
    parser = _Parser(text)
    try:
        found = parser.level(0)
    except _NoBlock:
        return None
    return found if parser.token.text == END else None


class _Parser:
    def __init__(self, text: str) -> None:
        self.text = text
        self.token = token_at(text, 0)

    def level(self, level: int) -> Test | Value:
        """Read operands and the operators between them that bind at least as much as those of a level."""
        if level == len(_LEVELS):
            return self._operand()
        found = self.level(level + 1)
        while as_operator(self.token).text in _LEVELS[level]:
            operator = self._operator()
            found = _joined(operator, found, self.level(level + 1))
        return found

    def _advance(self) -> Token:
        token = self.token
        self.token = token_at(self.text, token.end)
        return token

    def _operator(self) -> str:
        self.token = as_operator(self.token)
        return self._advance().text

    def _accept(self, sign: str) -> bool:
        found = self.token.text == sign
        if found:
            self._advance()
        return found

    def _expect(self, sign: str) -> None:
        if not self._accept(sign):
            raise _NoBlock

    def _operand(self) -> Test | Value:
        if self._accept("!"):
            return Not(of=_test(self._operand()))
        if self.token.text in {"-", "+"}:
            sign = self._advance().text
            if self.token.kind is not Kind.NUMBER:
                raise _NoBlock
            return self._number(sign)
        if self._accept("("):
            found = self.level(0)
            self._expect(")")
            return found
        return self._primary()

    def _primary(self) -> Test | Value:
        token = self.token
        if token.kind is Kind.NUMBER:
            return self._number("")
        if token.kind is Kind.WORD:
            return self._called(self._advance().text.upper())
        self._advance()
        if token.kind is Kind.VARIABLE:
            return Thing(name=token.text[1:])
        if token.kind is Kind.STRING:
            return self._string(token)
        if token.kind in {Kind.IRI, Kind.NAME} and self.token.text != "(":
            return Name(name=token.text)
        raise _NoBlock

    def _number(self, sign: str) -> Number:
        digits = self._advance().text
        if digits.endswith("."):
            raise _NoBlock
        return Number(value=sign + digits)

    def _string(self, token: Token) -> Text:
        content = unescape(quoted(token)[1])
        if self.token.kind is Kind.TAG:
            return Text(value=content, language=self._advance().text[1:])
        if self._accept("^^"):
            return Text(value=content, datatype=self._advance().text)
        return Text(value=content)

    def _called(self, word: str) -> Test | Value:
        if word in {"TRUE", "FALSE"}:
            return Truth(value=word == "TRUE")
        arguments = self._arguments()
        if word == "CONCAT" and arguments:
            return Join(parts=tuple(map(_value, arguments)))
        if word in _FUNCTIONS and len(arguments) == 1:
            return Of(function=word, of=_value(arguments[0]))  # type: ignore[arg-type]  # one of them, as was just seen
        if word in _MATCHES and len(arguments) == 2:  # noqa: PLR2004 - the value and the text
            value, text = map(_value, arguments)
            return Match(how=word, value=value, text=text)  # type: ignore[arg-type]  # as above
        if word == "BOUND" and len(arguments) == 1 and isinstance(arguments[0], Thing):
            return Known(name=arguments[0].name)
        raise _NoBlock

    def _arguments(self) -> list[Test | Value]:
        self._expect("(")
        found: list[Test | Value] = []
        while not self._accept(")"):
            if found:
                self._expect(",")
            found.append(self.level(0))
        return found


def _test(found: Test | Value) -> Test:
    if not isinstance(found, _TESTS):
        raise _NoBlock
    return found


def _value(found: Test | Value) -> Value:
    if isinstance(found, _TESTS):
        raise _NoBlock
    return found


def _joined(operator: str, left: Test | Value, right: Test | Value) -> Test | Value:
    if operator in _WORDS:
        return Logic(operator=_WORDS[operator], left=_test(left), right=_test(right))  # type: ignore[arg-type]  # a word
    if operator in _LEVELS[2]:
        return Compare(operator=operator, left=_value(left), right=_value(right))  # type: ignore[arg-type]  # one of them
    return Reckon(operator=operator, left=_value(left), right=_value(right))  # type: ignore[arg-type]  # one of them
