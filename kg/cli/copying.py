"""Commands that change a SPARQL server: they change a store of this machine, and copy the graphs that differ."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.cli.diagnostics import note, say
from kg.errors import UsageError
from kg.lazily import lazily
from kg.render.text import count
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore

with lazily():
    from kg.store.remote import RemoteStore
    from kg.store.remote_reading import without_credentials
    from kg.store.replacing import replace_on

_SERVER_SECONDS: Final = 3600.0
"""Seconds for a server to replace graphs."""


def server_of(settings: Settings, update_url: str | None) -> RemoteStore | None:
    """Return the server that the settings name as the store, None if that is a folder.

    Raises:
        UsageError: KG002 if a file of settings names the server, KG003 for an address of updates without a server.
        StoreError: KG225 for an address with credentials.
    """
    if not isinstance(settings.store, str):
        if update_url:
            raise UsageError("KG003", "--update-url needs a server, but the store is a folder")
        return None
    layout_of(settings)  # refuses a server that a file of settings names

    for address in filter(None, (settings.store, update_url)):
        without_credentials(address)
    return RemoteStore(settings.store, update_url, timeout=_SERVER_SECONDS, from_environment=True)


def copy_to(server: RemoteStore, store: EmbeddedStore) -> None:
    """Replace the graphs of a server that differ from those of a store, and report it."""
    sent = replace_on(store.layout, server)
    removed = f", removed {sent.removed:,}" if sent.removed else ""
    say(f"wrote {count(sent.graphs, 'graph')} with {count(sent.triples, 'triple')}{removed} to {server.address}")
    if sent.missing > 0:
        note(f"the server stored {count(sent.missing, 'triple')} less, because it regards some values as equal")
