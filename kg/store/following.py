"""Detects that the data of a SPARQL server has changed; the protocol cannot report it.

    following = Following(layout)
    following.check()       raises an error if the server does not respond
    following.look()        gives the data a new number if it has changed

The number of triples in each graph and the end of the last build or run of rules are compared. A change that keeps
all of these is missed.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Final

from kg.errors import StoreError
from kg.store.remote import SIZES
from kg.store.remote_reading import RemoteReading

if TYPE_CHECKING:
    from kg.store.layout import Layout

_ENDED: Final = (
    "SELECT (MAX(STR(?moment)) AS ?last) WHERE { GRAPH ?g { ?run <http://www.w3.org/ns/prov#endedAtTime> ?moment } }"
)
_SHARE: Final = 20
"""Pauses are this many times as long as a look, to keep the server free for others."""
_LEAST_SECONDS: Final = 10.0


class Following:
    """Advances the generation of a server's layout when the data has changed; before the first look it is 1.

    `pause` is the number of seconds to wait before the next look, `failure` the error of the last one.
    """

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        if layout.current() is None:
            layout.switch(1)
        self._seen: list[str] | None = None
        self.pause = 0.0
        self.failure: StoreError | None = None

    def check(self) -> None:
        """Send a small query; StoreError KG225 if the server does not respond."""
        with RemoteReading(self._layout) as snapshot:
            snapshot.query("ASK { GRAPH ?g { ?s ?p ?o } }")

    def look(self) -> None:
        """Compare the data with that of the last look; if the server does not respond, the generation stays."""
        began = time.monotonic()
        try:
            with RemoteReading(self._layout) as snapshot:
                seen = sorted(str(list(row)) for text in (SIZES, _ENDED) for row in snapshot.rows(text))
        except StoreError as error:
            self.failure = error
        else:
            self.failure = None
            if self._seen is not None and seen != self._seen:
                self._layout.switch((self._layout.current() or 0) + 1)
            self._seen = seen
        self.pause = max(_LEAST_SECONDS, _SHARE * (time.monotonic() - began))
