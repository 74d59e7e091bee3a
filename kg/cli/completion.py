"""Shell completion: names from the store, stored queries, codes. It offers nothing if the data cannot be read."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from kg.errors import CATALOGUE, KgError
from kg.lazily import lazily
from kg.settings import load

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot

with lazily():
    from kg.graph.reading.nodes import node_names
    from kg.graph.reading.overview import package_names
    from kg.graph.reading.parameters import declared_names, set_names
    from kg.graph.reading.systems import system_names
    from kg.query.stored import discover
    from kg.rules.authoring.library import Library
    from kg.search.searching import open_search
    from kg.store.opening import existing, reading


def completing(names: Callable[[str], Iterable[str]]) -> Callable[[str], list[str]]:
    """Decorate a function to return only the names with the typed prefix, and none on errors."""

    def complete(incomplete: str) -> list[str]:
        try:
            return [name for name in names(incomplete) if name.startswith(incomplete)]
        except KgError:
            return []

    return complete


def codes(incomplete: str) -> list[tuple[str, str]]:
    """Return the error codes with their titles."""
    return [(code, entry.title) for code, entry in CATALOGUE.items() if code.startswith(incomplete.upper())]


def _stored(names: Callable[[EmbeddedSnapshot], Iterable[str]]) -> Callable[[str], list[str]]:
    """Return the completer for names that are read from the store."""

    @completing
    def complete(_: str) -> Iterable[str]:
        with reading(load()) as snapshot:
            return list(names(snapshot))

    return complete


nodes = _stored(node_names)
packages = _stored(package_names)
launches = _stored(lambda snapshot: (one.name for one in system_names(snapshot)))
parameters = _stored(
    lambda snapshot: sorted({*(name for name in declared_names(snapshot) if "{" not in name), *set_names(snapshot)})
)


def features(kind: str) -> Callable[[str], list[str]]:
    """Return the completer for a filter of `kg search`; types are also completed by their last part."""

    @completing
    def complete(_: str) -> Iterable[str]:
        from kg.search.names import filter_values  # noqa: PLC0415 - start-up time

        whole = filter_values(kind, open_search(existing(load())).names)
        return sorted({*whole, *(name.rpartition("/")[2] for name in whole)})

    return complete


@completing
def queries(_: str) -> Iterable[str]:
    """Return the names of stored queries."""
    return discover(load().queries)


@completing
def rules(_: str) -> Iterable[str]:
    """Return the names of rules."""
    return Library.of(load()).entries


def channels(kind: str) -> Callable[[str], list[str]]:
    """Return the completer for names of topics, services or actions, in launched systems and in code.

    Names come without the leading slash unless it is typed.
    """

    @completing
    def complete(incomplete: str) -> Iterable[str]:
        from kg.graph.reading.channels import names as filter_values  # noqa: PLC0415 - start-up time

        with reading(load()) as snapshot:
            names = filter_values(snapshot, kind)
        return [name.removeprefix("/") for name in names] if incomplete and not incomplete.startswith("/") else names

    return complete


def subjects(incomplete: str) -> list[str]:
    """Return the names of topics, services, actions and nodes."""
    return sorted({name for of in (*map(channels, ("topic", "service", "action")), nodes) for name in of(incomplete)})
