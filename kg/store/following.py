"""Notices that the data of a SPARQL server has changed, which the protocol has no word for.

    following = Following(layout)
    following.check()       the server must answer
    following.look()        the number of the data changes if it looks different

The look is at how many triples each graph has, and when builds and rules of `kg` last ended. A change that keeps all of
this is not noticed.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Final

from kg.errors import StoreError
from kg.store.remote_reading import RemoteReading

if TYPE_CHECKING:
    from kg.store.layout import Layout

_GRAPHS: Final = "SELECT ?g (COUNT(*) AS ?n) WHERE { GRAPH ?g { ?s ?p ?o } } GROUP BY ?g"
_ENDED: Final = (
    "SELECT (MAX(STR(?moment)) AS ?last) WHERE { GRAPH ?g { ?run <http://www.w3.org/ns/prov#endedAtTime> ?moment } }"
)
_SHARE: Final = 20
"""Looking takes at most this part of the server's time."""
_LEAST_SECONDS: Final = 10.0


class Following:
    """Moves the pointer of a server's layout when the data of the server has changed; before the first look it is 1.

    `pause` is how many seconds to wait before the next look, `failure` why the last one did not succeed.
    """

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        if layout.current() is None:
            layout.switch(1)
        self._seen: list[str] | None = None
        self.pause = 0.0
        self.failure: StoreError | None = None

    def check(self) -> None:
        """Ask whether there is a triple; StoreError KG225 where the server does not answer."""
        with RemoteReading(self._layout) as snapshot:
            snapshot.query("ASK { GRAPH ?g { ?s ?p ?o } }")

    def look(self) -> None:
        """Compare the data with that of the last look. A server that does not answer keeps its number."""
        began = time.monotonic()
        try:
            with RemoteReading(self._layout) as snapshot:
                seen = sorted(str(list(row)) for text in (_GRAPHS, _ENDED) for row in snapshot.rows(text))
        except StoreError as error:
            self.failure = error
        else:
            self.failure = None
            if self._seen is not None and seen != self._seen:
                self._layout.switch((self._layout.current() or 0) + 1)
            self._seen = seen
        self.pause = max(_LEAST_SECONDS, _SHARE * (time.monotonic() - began))
