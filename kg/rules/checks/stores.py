"""Stores as checks see them: whether bodies match, and which part of one does not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import pyoxigraph

from kg.rules.explain.derivations import bound_by
from kg.rules.explain.view import View
from kg.store.snapshot import MemorySnapshot

if TYPE_CHECKING:
    from kg.rules.explain.view import Vocabulary
    from kg.rules.form import Element

__all__ = ["StoreOf", "nothing"]


@dataclass(frozen=True, slots=True)
class StoreOf:
    """A snapshot, after rules have run over it."""

    view: View

    def matches(self, body: tuple[Element, ...]) -> bool:
        """Return whether a body has a solution."""
        return bool(self.view.solutions(body, bound_by(body), {}, 1))

    def failing(self, body: tuple[Element, ...]) -> Element | None:
        """Return the first part of a body that leaves it without solutions."""
        return next((part for index, part in enumerate(body) if not self.matches(body[: index + 1])), None)


def nothing(vocabulary: Vocabulary) -> StoreOf:
    """Return a store without data."""
    return StoreOf(View(MemorySnapshot(pyoxigraph.Store()), vocabulary))
