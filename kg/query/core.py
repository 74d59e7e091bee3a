"""Run queries in this process: guards, deadline, limit of rows; stored queries by name, with parameters as text."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, Final

from pyoxigraph import Literal, NamedNode

from kg.errors import UsageError
from kg.query.binding import bind
from kg.query.evaluation import Dataset, Evaluation, Window, prepare
from kg.query.result import Boolean, Graph, Result, Solutions
from kg.query.runner import DeadlineError, Runner, in_thread
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.query.stored import StoredQuery
    from kg.store.interface import Snapshot
    from kg.store.terms import Term


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
    """Run the SPARQL query `text` and return its whole result.

    `parameters` binds variables to terms (see `kg.query.binding`). `timeout` is in seconds. `limit` limits rows or
    triples; the result records whether there were more. With `union` the default graph is the union of all graphs,
    unless the query names others. `path` is the path of the text in errors.

    Raises QueryError: KG501 syntax error, KG502 refused, KG503 deadline (a `DeadlineError`), KG505 parameter, KG516
    nested too deeply.
    """
    prepared = prepare(text, parameters or {}, path)
    began = time.perf_counter()
    return runner(lambda: _collect(prepared.evaluate(snapshot, Dataset(union)), limit, began), timeout)


def _collect(evaluation: Evaluation, limit: int | None, began: float) -> Result:
    """Collect the rows."""
    if isinstance(evaluation.result, bool):
        return Boolean(evaluation.result, time.perf_counter() - began, evaluation.snapshot)
    window: Window[Any] = Window(evaluation.result, most=limit)
    rows = tuple(window)
    seconds, cut = time.perf_counter() - began, limit if window.more else None
    if evaluation.kind == "graph":
        return Graph(rows, seconds, evaluation.snapshot, cut)
    return Solutions(evaluation.variables, rows, seconds, evaluation.snapshot, cut)


_PATIENCE: Final = 3.0
"""Time limit of the search for a suggestion, in seconds."""


def ask(
    snapshot: Snapshot,
    query: StoredQuery,
    values: Mapping[str, str],
    *,
    timeout: float | None = None,
    limit: int | None = None,
) -> Result:
    """Run a stored query with `values` for its parameters; see `kg.query.core.run` for the other arguments."""
    terms = query.bind(values)
    return run(snapshot, query.text, parameters=terms, timeout=timeout, limit=limit, path=str(query.path))


def row(
    snapshot: Snapshot, query: StoredQuery, values: Mapping[str, str], number: int, *, timeout: float | None = None
) -> tuple[str, dict[str, Term]]:
    """Return the text of a query with its parameters bound to `values`, and the bindings of one row of its result.

    Rows are counted from one; unbound variables are left out.

    Raises UsageError: KG003 if the result has no such row, or no rows; else as `kg.query.core.run`.
    """
    text = bind(query.text, query.bind(values))
    answer = run(snapshot, text, timeout=timeout, limit=number, path=str(query.path))
    rows = answer.rows if isinstance(answer, Solutions) else ()
    if not isinstance(answer, Solutions) or len(rows) < number:
        message = f"the answer has {len(rows)} row{'s' * (len(rows) != 1)}, not {number}"
        raise UsageError("KG003", message, hint="See it with `kg query`.")
    pairs = zip(answer.variables, rows[number - 1], strict=True)
    return text, {name: term for name, term in pairs if term is not None}


def suggestion(
    snapshot: Snapshot, query: StoredQuery, values: Mapping[str, str], *, timeout: float | None = None
) -> str | None:
    """Return a suggestion for a query with `values` that found nothing, or None.

    The query runs again without each value in turn. If its column of that name lacks the value, similar values of the
    column are suggested. Queries that take long without the value give no suggestion.
    """
    for name in values:
        terms = query.bind({key: value for key, value in values.items() if key != name})
        patience = min(timeout or _PATIENCE, _PATIENCE)
        try:
            result = run(snapshot, query.text, parameters=terms, timeout=patience, path=str(query.path))
        except DeadlineError:
            return None
        if not isinstance(result, Solutions) or name not in result.variables:
            continue
        column = result.variables.index(name)
        column_terms = (row[column] for row in result.rows)
        candidates = {term.value for term in column_terms if isinstance(term, Literal | NamedNode)}
        wanted = query.bind({name: values[name]})[name].value
        if wanted not in candidates:
            hint = did_you_mean(wanted, candidates)
            return f"unknown {name} `{wanted}`" + (f". {hint}" if hint else "")
    return None
