"""Split the text of a SPARQL update into operations (SPARQL 1.1 Update, section 3), by its tokens.

The engine has parsed the whole text before, so this only has to find the boundaries of parts. An unusual text whose
parts are not found is rejected as a syntax error.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

from kg.errors import QueryError
from kg.syntax.lexer import Kind, Token, tokens
from kg.syntax.position import place_at

_PROLOGUE: Final = {"prefix": 3, "base": 2, "version": 2}
_MANAGING: Final = frozenset({"clear", "drop", "create", "add", "move", "copy"})
_GROUPS: Final = frozenset({"default", "named", "all"})


@dataclass(frozen=True, slots=True)
class Part:
    """The text between two braces: `begin` is the offset after the first, `end` that of the last."""

    begin: int
    end: int
    tokens: tuple[Token, ...]

    def of(self, text: str) -> str:
        """Return the part of `text`, without the braces."""
        return text[self.begin : self.end]


@dataclass(frozen=True, slots=True)
class Data:
    """`INSERT DATA` or `DELETE DATA`.

    In each operation, `prologue` contains all earlier declarations as text; `begin` and `end` are its offsets,
    including the `;` after it.
    """

    prologue: str
    insert: bool
    quads: Part
    begin: int = 0
    end: int = 0


@dataclass(frozen=True, slots=True)
class Modify:
    """`WITH ... DELETE ... INSERT ... USING ... WHERE`, or its short form `DELETE WHERE`.

    `graph` is the graph of WITH, `using` and `named` those of USING and USING NAMED, as written in the text.
    """

    prologue: str
    graph: str | None
    delete: Part | None
    insert: Part | None
    using: tuple[str, ...]
    named: tuple[str, ...]
    where: Part
    begin: int = 0
    end: int = 0


@dataclass(frozen=True, slots=True)
class Manage:
    """`CLEAR`, `DROP`, `CREATE` (of `target`), `ADD`, `MOVE` or `COPY` (of `source` to `target`).

    Graphs are as written in the text, or `DEFAULT`, `NAMED`, `ALL`.
    """

    prologue: str
    verb: str
    silent: bool
    source: str
    target: str
    begin: int = 0
    end: int = 0


Operation: TypeAlias = Data | Modify | Manage


def operations(text: str, path: str, base: str | None) -> Iterator[Operation]:
    """Yield the operations of a normalised update that the engine can parse; KG501 if one is not found."""
    return _Reading(text, path).operations(f"BASE <{base}> " if base else "")


class _Reading:
    """A position in the tokens of an update."""

    def __init__(self, text: str, path: str) -> None:
        self._text = text
        self._path = path
        self._tokens = tuple(tokens(text))
        self._at = 0

    def operations(self, prologue: str) -> Iterator[Operation]:
        while True:
            prologue += self._prologue()
            begin = self._next()
            if begin is None:
                return
            operation = self._operation(prologue)
            if self._next() is not None:
                self._expect(";")
            yield replace(operation, begin=begin.start, end=self._tokens[self._at - 1].end)

    def _prologue(self) -> str:
        texts = []
        while (length := _PROLOGUE.get(self._word())) is not None:
            texts += [token.text for token in self._tokens[self._at : self._at + length]]
            self._at += length
        return "".join(f"{text} " for text in texts)

    def _operation(self, prologue: str) -> Operation:
        verb = self._word()
        if verb in _MANAGING:
            return self._manage(prologue)
        if verb in {"insert", "delete"} and self._word(1) == "data":
            self._at += 2
            return Data(prologue, verb == "insert", self._braces())
        if verb == "delete" and self._word(1) == "where":
            self._at += 2
            pattern = self._braces()
            return Modify(prologue, None, pattern, None, (), (), pattern)
        return self._modify(prologue)

    def _modify(self, prologue: str) -> Modify:
        graph = self._term() if self._take("with") else None
        delete = self._braces() if self._take("delete") else None
        insert = self._braces() if self._take("insert") else None
        if delete is None and insert is None:
            raise self._misfit()
        using: list[str] = []
        named: list[str] = []
        while self._take("using"):
            (named if self._take("named") else using).append(self._term())
        self._expect("where")
        return Modify(prologue, graph, delete, insert, tuple(using), tuple(named), self._braces())

    def _manage(self, prologue: str) -> Manage:
        verb = self._word()
        self._at += 1
        silent = self._take("silent")
        first = self._graph()
        if verb not in {"add", "move", "copy"}:
            return Manage(prologue, verb, silent, first, first)
        self._expect("to")
        return Manage(prologue, verb, silent, first, self._graph())

    def _graph(self) -> str:
        if self._word() in _GROUPS:
            self._at += 1
            return self._tokens[self._at - 1].text.upper()
        self._take("graph")
        return self._term()

    def _term(self) -> str:
        token = self._next()
        if token is None or token.kind not in {Kind.IRI, Kind.NAME}:
            raise self._misfit()
        self._at += 1
        return token.text

    def _braces(self) -> Part:
        """Return the part between a `{` and its closing `}`."""
        opening = self._at
        self._expect("{")
        depth = 1
        while depth:
            token = self._next()
            if token is None:
                raise self._misfit()
            if token.kind is Kind.SIGN:
                depth += (token.text == "{") - (token.text == "}")
            self._at += 1
        inner = self._tokens[opening + 1 : self._at - 1]
        return Part(self._tokens[opening].end, self._tokens[self._at - 1].start, inner)

    def _next(self, ahead: int = 0) -> Token | None:
        return self._tokens[self._at + ahead] if self._at + ahead < len(self._tokens) else None

    def _word(self, ahead: int = 0) -> str:
        token = self._next(ahead)
        return token.text.lower() if token is not None and token.kind is Kind.WORD else ""

    def _take(self, word: str) -> bool:
        is_next = self._word() == word
        self._at += is_next
        return is_next

    def _expect(self, text: str) -> None:
        token = self._next()
        if token is None or token.text.lower() != text:
            raise self._misfit()
        self._at += 1

    def _misfit(self) -> QueryError:
        token = self._next()
        if token is None:
            place = place_at(self._text, len(self._text), self._path)
            return QueryError("KG501", "the update ends too early", place=place)
        place = place_at(self._text, token.start, self._path)
        return QueryError("KG501", f"`{token.text}` is not expected here", place=place)
