"""Plugins that are loaded from parameters below no node: controllers of `ros_control` (`loader` in the table)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.names import normalise
from kg.wiring.plugins import Framework, Loaded, table
from kg.wiring.values import shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.wiring.instances import Draft
    from kg.wiring.types import NodeTypes
    from kg.wiring.values import Server

__all__ = ["attach"]

_TYPE: Final = "/type"


def attach(drafts: Sequence[Draft], server: Server, types: NodeTypes, repository: str) -> None:
    """Give each plugin that starters name to the first node that can load it; without such a node it is left out."""
    for framework in table().values():
        loader = next((draft for draft in drafts if _loads(draft, framework)), None) if framework.loader else None
        if loader is None:
            continue
        for scope, identifier in dict.fromkeys(_wanted(drafts, framework)):
            given = server.all.get(normalise(f"{scope}/{identifier}{_TYPE}"))
            kind = shown(given.value) if given is not None else None
            found = types.plugin(kind, repository) if kind is not None else None
            if kind is not None and (found is None or found[1].base_class == framework.base):
                loader.plugins.append(Loaded(identifier, kind, scope, found, framework, f"{identifier}{_TYPE}"))


def _wanted(drafts: Sequence[Draft], framework: Framework) -> Iterator[tuple[str, str]]:
    """Yield the namespaces and ids that the arguments of starters name."""
    for draft in drafts:
        if draft.started.package in framework.starter:
            for argument in draft.started.arguments:
                for word in argument.split():
                    if not word.startswith("-"):
                        yield draft.place.namespace, word


def _loads(draft: Draft, framework: Framework) -> bool:
    started = draft.started
    if f"{started.package}/{started.executable}" in framework.loader:
        return True
    if draft.typed is None:
        return False
    names = (interface.name for interface in draft.typed[1].interfaces if interface.name is not None)
    return any(name == offered or name.endswith(f"/{offered}") for name in names for offered in framework.loader)
