"""The cursor of a rule parser: its tokens, declared names, and errors with their places."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Final

from pyoxigraph import NamedNode

from kg.errors import Fix, RuleError
from kg.similar import misspelt, similar, suggest
from kg.syntax.lexer import END, Kind, Token, as_written, is_name, normalise, token_at, tokens, unescape, unescape_local
from kg.syntax.names import PREFIXES, WELL_KNOWN, is_absolute, resolve
from kg.syntax.position import place_at
from kg.syntax.prologue import declaration
from kg.syntax.terms import GENERATED
from kg.syntax.tree import Span

MAX_NESTING: Final = 100
"""Maximum nesting of brackets: more than anyone writes, and safe for recursive code."""

_LONG: Final = 40


class Cursor:
    """Reads tokens from left to right; `token` is the next one, `consumed` are those read."""

    def __init__(self, text: str, path: str, *, prefixes: Mapping[str, str], base: str | None = None) -> None:
        """Normalise the line ends of a text; `path` is its name in errors."""
        self.text = normalise(text)
        self.path = path
        self.prefixes = dict(prefixes)
        self.base = base
        self.consumed: list[Token] = []
        self.token = self._token(0)
        self._depth = 0
        self._fresh = 0
        self._stem = "g"
        while f"_:{self._stem}" in self.text:
            self._stem += "g"

    def advance(self) -> Token:
        """Consume one token and return it."""
        token = self.token
        self.consumed.append(token)
        self.token = self._token(token.end)
        return token

    def _token(self, offset: int) -> Token:
        """Return the token at an offset; a variable that has the name of a generated one gets another."""
        token = as_written(token_at(self.text, offset))
        if token.kind is Kind.VARIABLE and token.text.startswith(GENERATED, 1):
            return token._replace(text=f"{token.text[0]}__·{token.text[1 + len(GENERATED) :]}")
        return token

    def at(self, *signs: str) -> bool:
        """Return whether the next token is one of these signs."""
        return self.token.kind is Kind.SIGN and self.token.text in signs

    def at_word(self, *words: str) -> bool:
        """Return whether the next token is one of these keywords, given in upper case."""
        return self.token.kind is Kind.WORD and self.token.text.upper() in words

    def at_end(self) -> bool:
        """Return whether all tokens are consumed."""
        return self.at(END)

    def accept(self, *signs: str) -> bool:
        """Consume one of these signs if it comes next."""
        if is_next := self.at(*signs):
            self.advance()
        return is_next

    def accept_word(self, *words: str) -> bool:
        """Consume one of these keywords if it comes next."""
        if is_next := self.at_word(*words):
            self.advance()
        return is_next

    def expect(self, sign: str, what: str = "") -> Token:
        """Consume a sign; raise KG201 for anything else."""
        if not self.at(sign):
            raise self.expected(f"`{sign}`{what}")
        return self.advance()

    def expect_word(self, word: str) -> Token:
        """Consume a keyword; raise KG201 for anything else."""
        if not self.at_word(word):
            raise self.expected(f"`{word}`", [word])
        return self.advance()

    def expected(self, what: str, names: Iterable[str] = ()) -> RuleError:
        """Return the error for an unexpected token; `names` are names for suggestions."""
        suggestions = misspelt(self.token.text, names) if self.token.kind is Kind.WORD else ()
        message = f"expected {what}, found {self._token_words()}"
        return self.error(message, self.token.start, hint=suggest(suggestions), fixes=map(Fix, suggestions))

    def error(
        self,
        message: str,
        offset: int,
        *,
        code: str = "KG201",
        hint: str | None = None,
        fixes: Iterable[Fix] = (),
    ) -> RuleError:
        """Return an error about the token at an offset."""
        return RuleError(code, message, place=place_at(self.text, offset, self.path), hint=hint, fixes=fixes)

    def _token_words(self) -> str:
        text = self.token.text
        if text == END:
            return "the end of the text"
        if text in {"'", '"'}:
            return "a string that is not closed or has a bad escape"
        if text == "<":
            return "`<`, which begins no IRI"
        return f"`{text if len(text) <= _LONG else text[:_LONG] + '...'}`"

    def span(self, start: int) -> Span:
        """Return the span from an offset to the last consumed token."""
        return Span(start, self.consumed[-1].end if self.consumed else start)

    @contextmanager
    def nested(self) -> Iterator[None]:
        """Enter a nesting level; raise KG201 if there are too many."""
        self._depth += 1
        if self._depth > MAX_NESTING:
            raise self.error(f"the rule nests deeper than {MAX_NESTING}", self.token.start, code="KG209")
        yield
        self._depth -= 1

    def fresh(self) -> str:
        """Return an unused label of a blank node."""
        self._fresh += 1
        return f"{self._stem}{self._fresh}"

    def at_iri(self) -> bool:
        """Return whether the next token is an IRI or a prefixed name."""
        return is_name(self.token)

    def iri(self, what: str = "an IRI") -> NamedNode:
        """Parse an IRI or a prefixed name."""
        if not self.at_iri():
            raise self.expected(what)
        return self.named(self.advance())

    def named(self, token: Token) -> NamedNode:
        """Return the IRI of a token; KG201 for an unknown prefix or a relative IRI without a base."""
        value = self._written(token) if token.kind is Kind.IRI else self._expanded(token)
        try:
            return NamedNode(value if self.base is None else resolve(self.base, value))
        except ValueError as error:
            raise self.error(f"`{value}` is not a valid IRI: {error}", token.start) from None

    def _expanded(self, token: Token) -> str:
        prefix, _, local = token.text.partition(":")
        namespace = self.prefixes.get(prefix)
        if namespace is None:
            unknown = self._unknown_prefixes(token)
            near = [f"{one}:" for one in similar(prefix, self.prefixes)] if prefix and len(unknown) == 1 else []
            hint = f"Declare {'it' if len(unknown) == 1 else 'them'}: PREFIX {prefix}: <...>."
            raise self.error(
                f"unknown prefix{'es' * (len(unknown) > 1)} {', '.join(f'`{each}:`' for each in unknown)}",
                token.start,
                hint=suggest(near) or hint,
                fixes=[*(Fix(f"{each}{local}") for each in near), *declaring(self.text, unknown, self.path)],
            )
        return namespace + unescape_local(local)

    def _unknown_prefixes(self, first: Token) -> list[str]:
        """Return the undeclared prefixes from a token on, so one fix can declare them all."""
        declared = set(self.prefixes)
        undeclared = {first.text.partition(":")[0]: None}
        declares = False
        for token in tokens(self.text[first.start :]):
            # `:=` of SPARQL 1.2 RL begins like a name with the empty prefix.
            if token.kind is Kind.NAME and token.text != ":" and not token.text.startswith("_:"):
                prefix = token.text.partition(":")[0]
                if declares:
                    declared.add(prefix)
                elif prefix not in declared:
                    undeclared[prefix] = None
            declares = token.kind is Kind.WORD and token.text.upper() == "PREFIX"
        return list(undeclared)

    def _written(self, token: Token) -> str:
        try:
            value = unescape(token.text[1:-1])
        except ValueError:
            raise self.error("invalid escape sequence in the IRI", token.start) from None
        if self.base is None and not is_absolute(value):
            raise self.error(
                f"the IRI `<{value}>` is relative", token.start, hint="Declare BASE <...> or write it out."
            )
        return value

    def spelling(self, tokens: list[Token]) -> str:
        """Return tokens as text: names as IRIs in brackets, without comments, with minimal spaces."""
        pieces: list[str] = []
        previous: Token | None = None
        for token in tokens:
            if previous is not None and _apart(previous, token):
                pieces.append(" ")
            if is_name(token):
                pieces.append(str(self.named(token)))
            else:
                # The engine accepts these two keywords in lower case only.
                pieces.append(token.text.lower() if token.text.upper() in {"TRUE", "FALSE"} else token.text)
            previous = token
        return "".join(pieces)


def declaring(text: str, unknown: Iterable[str], path: str, *, turtle: bool = False) -> Iterator[Fix]:
    """Yield the fix that declares the well-known prefixes among those that a text does not declare."""
    usual = {**WELL_KNOWN, **PREFIXES}
    wanted = {prefix: usual[prefix] for prefix in unknown if prefix in usual}
    if wanted:
        at, lines = declaration(text, wanted, turtle=turtle)
        title = f"Declare {' and '.join(f'`{each}:`' for each in wanted)}"
        yield Fix(lines, place_at(text, at, path, at), title)


def _apart(left: Token, right: Token) -> bool:
    """Return whether a space is needed between two tokens; word operators keep theirs before a bracket."""
    if left.text in {"(", "!", "^^"} or right.text in {")", ",", "^^"} or right.kind is Kind.TAG:
        return False
    if left.text in {"+", "-"} and right.kind is Kind.NUMBER and left.end == right.start:
        return False
    if right.text != "(":
        return True
    return not (is_name(left) or (left.kind is Kind.WORD and left.text.upper() not in _OPERATORS))


_OPERATORS: Final = frozenset({"IN", "NOT", "EXISTS", "AS", "FILTER", "BIND", "VALUES", "BY", "HAVING", "SELECT"})
