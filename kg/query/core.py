"""The one way a query is run: guards, deadline, cap of rows; whatever its face."""

from __future__ import annotations

import itertools
import time
from typing import TYPE_CHECKING

import pyoxigraph

from kg.errors import QueryError
from kg.query.binding import bind
from kg.query.guard import check
from kg.query.lexer import normalise, tokens
from kg.query.prefixes import PREFIXES
from kg.query.result import Boolean, Graph, Solutions
from kg.query.runner import in_thread
from kg.query.syntax import syntax_error

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pyoxigraph import Literal, NamedNode

    from kg.query.result import Result
    from kg.query.runner import Runner
    from kg.store.interface import Snapshot

__all__ = ["run"]


def run(  # noqa: PLR0913 - the settings of one query, all by name
    snapshot: Snapshot,
    text: str,
    *,
    parameters: Mapping[str, NamedNode | Literal] | None = None,
    timeout: float | None = None,
    limit: int | None = None,
    union: bool = True,
    path: str = "query",
    runner: Runner = in_thread,
) -> Result:
    """Run the SPARQL query `text` and return its whole answer.

    `parameters` are terms for variables (see `kg.query.binding`); `timeout` is in seconds; `limit` caps rows or
    triples, and the answer says whether there were more; with `union` the default graph is the union of all
    graphs; `path` is what errors name as the place of the text.

    Raises:
        QueryError: KG501 not SPARQL, KG502 refused, KG503 deadline (a `DeadlineError`), KG505 parameter.
    """
    text = normalise(text)
    check(tokens(text), text, path)
    bound = bind(text, parameters or {})
    began = time.perf_counter()

    def work() -> Result:
        try:
            answer = snapshot.query(bound, prefixes=PREFIXES, union=union)
        except SyntaxError as error:
            raise _explained(error, text, path) from error
        except (RuntimeError, OSError, ValueError) as error:
            raise QueryError("KG506", str(error)) from error
        return _collect(answer, snapshot.identity, limit, began)

    return runner(work, timeout)


def _explained(error: SyntaxError, text: str, path: str) -> QueryError:
    """Return the error about the text as typed: binding parameters moves what stands behind them."""
    try:
        pyoxigraph.Store().query(text, prefixes=dict(PREFIXES))
    except SyntaxError as typed:
        error = typed
    return syntax_error(error, text, path)


def _collect(
    answer: pyoxigraph.QuerySolutions | pyoxigraph.QueryBoolean | pyoxigraph.QueryTriples,
    snapshot: str,
    limit: int | None,
    began: float,
) -> Result:
    """Take the rows out of the engine, one more than `limit` to know whether there are more."""
    stop = None if limit is None else limit + 1
    if isinstance(answer, pyoxigraph.QueryBoolean):
        return Boolean(bool(answer), time.perf_counter() - began, snapshot)
    if isinstance(answer, pyoxigraph.QueryTriples):
        triples = tuple(itertools.islice(answer, stop))
        cut = limit if limit is not None and len(triples) > limit else None
        return Graph(triples[:limit], time.perf_counter() - began, snapshot, cut)
    variables = tuple(variable.value for variable in answer.variables)
    rows = tuple(tuple(row) for row in itertools.islice(answer, stop))
    cut = limit if limit is not None and len(rows) > limit else None
    return Solutions(variables, rows[:limit], time.perf_counter() - began, snapshot, cut)
