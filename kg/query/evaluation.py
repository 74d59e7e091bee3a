"""Evaluation of a query: check it, bind its parameters and dataset, and start it in the engine, which streams rows."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any, Final, Generic, TypeVar, cast

import pyoxigraph
from pyoxigraph import Literal, NamedNode, Triple

from kg.errors import KgError, QueryError
from kg.query.binding import bind
from kg.query.guard import check
from kg.query.syntax import syntax_error
from kg.store.failure import is_of_store, store_error
from kg.syntax.lexer import Kind, normalise, tokens
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from kg.query.result import Row
    from kg.store.interface import Snapshot


_FRESH: Final = re.compile("now|rand|uuid|bnode")
"""Functions whose value differs at each call or each query; STRUUID contains one of these."""


@dataclass(frozen=True, slots=True)
class Dataset:
    """Dataset of a query.

    If no graphs are given, FROM and FROM NAMED of the query apply. Without these, the default graph is the union of all
    graphs with `union`, else the unnamed graph. If `default_graphs` or `named_graphs` are given as IRIs, they replace
    the dataset (SPARQL 1.1 Protocol, section 2.1.4); the other is then empty. Only the embedded store supports them.
    """

    union: bool = True
    default_graphs: Sequence[str] | None = None
    named_graphs: Sequence[str] | None = None

    @property
    def given(self) -> bool:
        """Whether graphs are given."""
        return self.default_graphs is not None or self.named_graphs is not None


@dataclass(frozen=True, slots=True)
class Evaluation:
    """Result stream of the engine: `kind` is `rows`, `graph` or `boolean`.

    `result` yields rows or triples as the engine finds them, or is a bool. Errors while iterating are those of
    `Prepared.evaluate`.
    """

    kind: str
    variables: tuple[str, ...]
    result: Iterator[Row] | Iterator[Triple] | bool
    snapshot: str


@dataclass(frozen=True, slots=True)
class Prepared:
    """A query that passed the guard, with its parameters bound.

    `repeatable` is whether the same data always gives the same result, except for the order of rows without ORDER BY
    and the labels of blank nodes. `names_data` is whether it has a FROM clause.
    """

    typed: str
    bound: str
    repeatable: bool
    names_data: bool
    path: str

    def evaluate(self, snapshot: Snapshot, dataset: Dataset, base: str | None = None) -> Evaluation:
        """Start the query in the engine; relative IRIs are resolved against `base`, and are errors without one.

        Raises:
            QueryError: KG501 syntax error, KG506 the engine cannot evaluate it.
            StoreError: KG303 the data cannot be read.
        """
        further = _graphs(dataset)
        if base is not None:
            further["base"] = base
        union = dataset.union and not dataset.given and not self.names_data
        try:
            answer = snapshot.query(self.bound, prefixes=prefixes_in(self.bound), union=union, **further)
        except SyntaxError as error:
            raise self._explained(error, base) from error
        except (RuntimeError, OSError, ValueError) as error:
            raise _failure(error) from error
        return evaluation_of(answer, snapshot.identity)

    def _explained(self, error: SyntaxError, base: str | None) -> QueryError:
        """Return the syntax error at its place in the original text; binding parameters shifts the text after them."""
        try:
            pyoxigraph.Store().query(self.typed, prefixes=dict(PREFIXES), base_iri=base)
        except SyntaxError as typed:
            error = typed
        return syntax_error(error, self.typed, self.path, base=base)


def prepare(text: str, parameters: Mapping[str, NamedNode | Literal], path: str = "query") -> Prepared:
    """Check the SPARQL query `text` and bind its parameters (see `kg.query.binding`).

    Raises QueryError: KG502 refused, KG505 parameter, KG516 nested too deeply.
    """
    text = normalise(text)
    lexed = list(tokens(text))
    check(lexed, text, path)
    words = {token.text.lower() for token in lexed if token.kind is Kind.WORD}
    return Prepared(
        typed=text,
        bound=bind(text, parameters),
        # The engine does not require whitespace between all words; the lexer returns such words as one.
        repeatable=not any(map(_FRESH.search, words)),
        names_data=any(word.startswith("from") for word in words),
        path=path,
    )


def prefixes_in(text: str) -> Mapping[str, str]:
    """Return the known prefixes that `text` may use; the engine parses every namespace it receives."""
    if "\\" in text:  # an escape may be part of a prefix
        return PREFIXES
    return {prefix: namespace for prefix, namespace in PREFIXES.items() if f"{prefix}:" in text}


def _graphs(dataset: Dataset) -> dict[str, Any]:
    if not dataset.given:
        return {}
    try:
        return {
            "default_graphs": [NamedNode(iri) for iri in dataset.default_graphs or ()],
            "named_graphs": [NamedNode(iri) for iri in dataset.named_graphs or ()],
        }
    except ValueError as error:
        hint = "Write an absolute IRI without brackets."
        raise QueryError("KG505", f"a graph of the data set is not an IRI: {error}", hint=hint) from error


def evaluation_of(
    answer: pyoxigraph.QuerySolutions | pyoxigraph.QueryBoolean | pyoxigraph.QueryTriples, snapshot: str
) -> Evaluation:
    """Return the result of the engine on data of the identity `snapshot`; iterating raises as `Prepared.evaluate`."""
    if isinstance(answer, pyoxigraph.QueryBoolean):
        return Evaluation("boolean", (), bool(answer), snapshot)
    if isinstance(answer, pyoxigraph.QueryTriples):
        return Evaluation("graph", (), cast("Iterator[Triple]", _guarded(answer)), snapshot)
    variables = tuple(variable.value for variable in answer.variables)
    return Evaluation("rows", variables, cast("Iterator[Row]", map(tuple, _guarded(answer))), snapshot)


def _guarded(answer: Iterable[Any]) -> Iterator[Any]:
    """Yield the results of the engine; raises as `Prepared.evaluate`."""
    try:
        yield from answer
    except (RuntimeError, OSError, ValueError) as error:
        raise _failure(error) from error


def _failure(error: RuntimeError | OSError | ValueError) -> KgError:
    """Return the error of the engine as one of the store or of the query."""
    return store_error(error, "the store") if is_of_store(error) else QueryError("KG506", str(error))


Item = TypeVar("Item")


class Window(Generic[Item]):
    """The items after the first `offset`, at most `most`; can be iterated once.

    `count` is the number of items yielded so far. At the end, `more` is whether there were more than `most`. `tick` is
    called before each item is yielded, and may raise to stop.
    """

    def __init__(
        self,
        rows: Iterable[Item],
        *,
        offset: int = 0,
        most: int | None = None,
        tick: Callable[[int], object] = lambda _: None,
    ) -> None:
        self._rows = rows
        self._offset = offset
        self._most = most
        self._tick = tick
        self.count = 0
        self.more = False

    def __iter__(self) -> Iterator[Item]:
        """Yield the items; reads one more than `most` to detect whether there are more."""
        for item in islice(self._rows, self._offset, None):
            if self.count == self._most:
                self.more = True
                return
            self.count += 1
            self._tick(self.count)
            yield item
