"""A store in memory, asked as a snapshot of a store on disk is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pyoxigraph
    from pyoxigraph import Store

    from kg.rules.form import Term

__all__ = ["Whole"]


class Whole:
    """A store whose default graph is, unless told otherwise, all there is."""

    def __init__(self, store: Store) -> None:
        self._store = store

    def query(
        self,
        text: str,
        /,
        *,
        prefixes: Mapping[str, str] | None = None,
        union: bool = True,
        substitutions: Mapping[pyoxigraph.Variable, Term] | None = None,
    ) -> Any:
        """Run a query; variables in `substitutions` stand for those terms."""
        return self._store.query(
            text,
            prefixes=dict(prefixes or {}),
            use_default_graph_as_union=union,
            substitutions=dict(substitutions) if substitutions else None,
        )
