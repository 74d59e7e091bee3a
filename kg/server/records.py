"""Data recorded about a request while it is handled, for the log and the metrics."""

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
    """One request: routes set `query` (its text), `rows` and `cached`; errors set their code as `outcome`."""

    began: float = field(default_factory=time.perf_counter)
    query: str | None = None
    rows: int | None = None
    cached: bool = False
    outcome: str = "ok"
    status: int = 0
    sent: int = 0
    """Bytes sent of the body of the response."""

    @property
    def seconds(self) -> float:
        """Seconds since the request arrived."""
        return time.perf_counter() - self.began

    @property
    def digest(self) -> str | None:
        """Digest of the text of the query, which identifies it without revealing it."""
        return None if self.query is None else hashlib.sha256(self.query.encode("utf-8", "replace")).hexdigest()[:12]


def record(request: HTTPConnection) -> Record:
    """Return the record of a request, which is logged after the response."""
    stored: Record | None = request.scope.get(_KEY)
    if stored is None:
        stored = request.scope[_KEY] = Record()
    return stored
