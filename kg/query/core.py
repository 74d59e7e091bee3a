"""Run a query in this process: guards, deadline, limit of rows."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from kg.query.evaluation import Dataset, Evaluation, prepare
from kg.query.result import Boolean, Graph, Result, Solutions
from kg.query.runner import Runner, in_thread
from kg.query.window import Window

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pyoxigraph import Literal, NamedNode

    from kg.store.interface import Snapshot


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

    Raises:
        QueryError: KG501 syntax error, KG502 refused, KG503 deadline (a `DeadlineError`), KG505 parameter, KG516
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
