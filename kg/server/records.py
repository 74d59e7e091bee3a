"""What is noted of a request while it is answered, for the log and the metrics."""

from __future__ import annotations

import hashlib
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from starlette.requests import HTTPConnection

_KEY: Final = "kg.record"


@dataclass(slots=True)
class Record:
    """One request: routes fill in `query` (its text), `rows`, and `cached`; errors their code as the `outcome`."""

    began: float = field(default_factory=time.perf_counter)
    query: str | None = None
    rows: int | None = None
    cached: bool = False
    outcome: str = "ok"
    status: int = 0
    sent: int = 0
    """Bytes of the body of the answer."""

    @property
    def seconds(self) -> float:
        """How long ago the request came."""
        return time.perf_counter() - self.began

    @property
    def digest(self) -> str | None:
        """A name for the text of the query that does not tell it: the same text has the same."""
        return None if self.query is None else hashlib.sha256(self.query.encode("utf-8", "replace")).hexdigest()[:12]


def record(request: HTTPConnection) -> Record:
    """Return the record of a request, which the log reads when it has been answered."""
    found: Record | None = request.scope.get(_KEY)
    if found is None:
        found = request.scope[_KEY] = Record()
    return found
