"""Owners of graphs: those that only rules and builds write, and those that the next build rewrites."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.graph.iris import Iris

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.pipeline.inferring import Inferred
    from kg.pipeline.updating.executing import Executor
    from kg.settings import Settings

LEFT_OUT: Final = "a rule was left out"
"""Beginning of the warnings about rules that did not run."""
_NEVER: Final = ("inferred", "builds")
_BUILT: Final = ("shared", "source/", "launch/")
_FEW: Final = 2


def protected_graphs(settings: Settings) -> list[NamedNode]:
    """Return the graphs that only `kg` writes: the inferences, and the record of builds."""
    return [NamedNode(Iris(settings.base).graph(name)) for name in _NEVER]


def warnings(executor: Executor, settings: Settings, inferred: Inferred | None) -> Iterator[str]:
    """Yield warnings about a completed change."""
    built = tuple(f"{settings.base}graph/{name}" for name in _BUILT)
    overwritten = [f"<{name}>" for name in sorted(executor.touched) if name.startswith(built)]
    if overwritten:
        yield f"{_listed(overwritten)}: read by `kg build`; the next build of the source drops this change"
    if Iris(settings.base).graph("ontology") in executor.touched:
        yield "the ontologies of kg were changed, on which rules depend; another version of kg brings its own again"
    skipped = [str(graph) for graph in sorted(executor.skipped, key=str)]
    if skipped:
        yield f"{_listed(skipped)}: written by kg alone, left as it was"
    for problem in inferred.problems if inferred else ():
        yield f"{LEFT_OUT}: {problem}"


def _listed(names: list[str]) -> str:
    more = len(names) - _FEW
    return ", ".join(names[:_FEW]) + (f" and {more} more graphs" if more > 0 else "")
