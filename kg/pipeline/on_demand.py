"""Queries with rules of a family that are evaluated on demand; the store contains none of their inferences."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

from kg.errors import UnknownNameError
from kg.graph.vocabulary import RNKG
from kg.pipeline.reasoning import rules_over
from kg.rules.demand.deriving import Base, Derived, derive
from kg.rules.engine.limits import Limits
from kg.rules.reading import all_families
from kg.rules.recording import Names
from kg.similar import did_you_mean
from kg.store.opening import layout_of
from kg.store.overlay import overlaid

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_FOLDER: Final = "on-demand"
"""Folder in the cache of a store for the input of the rules of each family."""


@contextmanager
def with_family(
    settings: Settings, snapshot: EmbeddedSnapshot, family: str, text: str
) -> Iterator[tuple[EmbeddedSnapshot, Derived]]:
    """Yield a snapshot with the triples that the rules of a family derive for a query, and these triples.

    Raises:
        UnknownNameError: KG001 for an unknown family.
        RuleError: KG2xx for rules that cannot be read or evaluated, KG205 at the deadline for queries.
        StoreError: KG304, KG306 if the copy of the store cannot be written.
    """
    families = all_families(settings)
    if family not in families:
        hint = did_you_mean(family, families) or f"The families are {', '.join(families)}."
        raise UnknownNameError("KG001", f"unknown family of rules `{family}`", hint=hint)
    names = Names.of(settings.base, RNKG)
    rules = rules_over(settings, snapshot, families=(family,))
    cache = layout_of(settings).cache
    base = Base.of(rules, snapshot, snapshot.generation, names, cache / _FOLDER / family)
    derived = derive(text, rules, base, Limits(settings.timeout or None))
    if not len(derived.facts):
        yield snapshot, derived
        return
    with overlaid(snapshot, names.inferred, derived.chunks(), cache) as extended:
        yield extended, derived
