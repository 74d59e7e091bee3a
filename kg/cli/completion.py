"""What the shell offers behind Tab: names from the store, stored queries, codes. Where nothing is known, nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.errors import CATALOGUE, KgError
from kg.settings import load

if TYPE_CHECKING:
    from collections.abc import Callable


def codes(incomplete: str) -> list[tuple[str, str]]:
    """Return the error codes with their titles."""
    return [(code, entry.title) for code, entry in CATALOGUE.items() if code.startswith(incomplete.upper())]


def nodes(incomplete: str) -> list[str]:
    """Return the names of nodes."""

    def names() -> list[str]:
        from kg.graph.reading import node_names  # noqa: PLC0415 - start-up time
        from kg.store.opening import reading  # noqa: PLC0415 - start-up time

        with reading(load()) as snapshot:
            return node_names(snapshot)

    return _beginning(incomplete, names)


def packages(incomplete: str) -> list[str]:
    """Return the names of packages."""

    def names() -> list[str]:
        from kg.graph.overview import package_names  # noqa: PLC0415 - start-up time
        from kg.store.opening import reading  # noqa: PLC0415 - start-up time

        with reading(load()) as snapshot:
            return package_names(snapshot)

    return _beginning(incomplete, names)


def features(kind: str) -> Callable[[str], list[str]]:
    """Return what completes the values of a filter of `kg search`; types also by their last part."""

    def complete(incomplete: str) -> list[str]:
        def names() -> list[str]:
            from kg.search.filters import known  # noqa: PLC0415 - start-up time
            from kg.search.searching import open_search  # noqa: PLC0415 - start-up time
            from kg.store.opening import existing  # noqa: PLC0415 - start-up time

            whole = known(kind, open_search(existing(load())).names)
            return sorted({*whole, *(name.rpartition("/")[2] for name in whole)})

        return _beginning(incomplete, names)

    return complete


def queries(incomplete: str) -> list[str]:
    """Return the names of stored queries."""

    def names() -> list[str]:
        from kg.query.stored import discover  # noqa: PLC0415 - start-up time

        return list(discover(load().queries))

    return _beginning(incomplete, names)


def rules(incomplete: str) -> list[str]:
    """Return the names of rules."""

    def names() -> list[str]:
        from kg.rules.authoring.library import Library  # noqa: PLC0415 - start-up time

        return list(Library.of(load()).entries)

    return _beginning(incomplete, names)


def launches(incomplete: str) -> list[str]:
    """Return the names of launch files."""

    def names() -> list[str]:
        from kg.graph.systems_reading import system_names  # noqa: PLC0415 - start-up time
        from kg.store.opening import reading  # noqa: PLC0415 - start-up time

        with reading(load()) as snapshot:
            return [one.name for one in system_names(snapshot)]

    return _beginning(incomplete, names)


def topics(incomplete: str) -> list[str]:
    """Return the names of topics, in launched systems and in code."""
    return _channels("topic", incomplete)


def services(incomplete: str) -> list[str]:
    """Return the names of services, in launched systems and in code."""
    return _channels("service", incomplete)


def actions(incomplete: str) -> list[str]:
    """Return the names of actions, in launched systems and in code."""
    return _channels("action", incomplete)


def subjects(incomplete: str) -> list[str]:
    """Return the names of topics, services, actions and nodes."""
    return sorted({name for kind in (topics, services, actions, nodes) for name in kind(incomplete)})


def parameters(incomplete: str) -> list[str]:
    """Return the names of parameters, as code declares them and as launch and parameter files set them."""

    def names() -> list[str]:
        from kg.graph.parameters_reading import declared_names, set_names  # noqa: PLC0415 - start-up time
        from kg.store.opening import reading  # noqa: PLC0415 - start-up time

        with reading(load()) as snapshot:
            return sorted({*(name for name in declared_names(snapshot) if "{" not in name), *set_names(snapshot)})

    return _beginning(incomplete, names)


def _channels(kind: str, incomplete: str) -> list[str]:
    """Return names of channels; where the slash in front is not typed, they come without it."""

    def names() -> list[str]:
        from kg.graph.channels_reading import names as known  # noqa: PLC0415 - start-up time
        from kg.store.opening import reading  # noqa: PLC0415 - start-up time

        with reading(load()) as snapshot:
            found = known(snapshot, kind)
        return [name.removeprefix("/") for name in found] if incomplete and not incomplete.startswith("/") else found

    return _beginning(incomplete, names)


def _beginning(incomplete: str, names: Callable[[], list[str]]) -> list[str]:
    try:
        return [name for name in names() if name.startswith(incomplete)]
    except KgError:
        return []
