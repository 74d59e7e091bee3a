"""What is known of requests: which were slow, which are like one that was quick, and whether slow ones flood the lanes.

All of it is a guess about where a request had better begin, and a wrong one is found out after a quarter of a second.
"""

from __future__ import annotations

import re
import time
from collections import OrderedDict, deque
from typing import Final, NamedTuple, TypeVar

__all__ = ["Known", "Marks"]

_T = TypeVar("_T")

_REMEMBERED: Final = 1024
"""How many requests that were slow are known, and how many shapes."""

_SECONDS_KNOWN: Final = 60.0
"""How long a request is taken for slow after it was."""

_FLOOD_SECONDS: Final = 10.0
"""There is a flood while so many requests as make one were found to be slow in this time."""

_SHAPED_CHARACTERS: Final = 4096
"""Of a longer text no shape is made: that would cost the process that all requests go through more than a moment."""

_NO_SHAPE: Final = re.compile(r"""(<[^<>\s]*>)|\#[^\n]*|\s+|"[^"\n]*"|'[^'\n]*'|\d+""")
"""IRIs, which are kept, and what texts that cost the same may differ in; it reads no character more than twice."""


class Marks(NamedTuple):
    """What a request is known by: `exact` is that of no other, `shape` that of all that differ in values alone."""

    exact: int
    shape: int

    @classmethod
    def of(cls, message: bytes, text: str) -> Marks:
        """Return the marks of a message that asks for `text`, a query or the name of a view."""
        exact = hash(message)
        return cls(exact, hash(_NO_SHAPE.sub(r"\1", text)) if len(text) <= _SHAPED_CHARACTERS else exact)


class Known:
    """What became of requests; `many` that were found to be slow within ten seconds are a flood."""

    def __init__(self, many: int) -> None:
        self._slow: OrderedDict[int, float] = OrderedDict()
        self._quick: OrderedDict[int, bool] = OrderedDict()
        self._found: deque[float] = deque(maxlen=many)

    def is_slow(self, marks: Marks) -> bool:
        """Tell whether this very request was slow a short while ago."""
        return time.monotonic() - self._slow.get(marks.exact, -_SECONDS_KNOWN) < _SECONDS_KNOWN

    def guess(self, marks: Marks) -> bool | None:
        """Tell whether it is quick, as the last one like it was; None in a flood, when nothing is known of such."""
        return self._quick.get(marks.shape, None if self._is_flood() else True)

    def note(self, marks: Marks, *, quick: bool) -> None:
        """Remember what became of a request that began among the quick ones or on trial."""
        _put(self._quick, marks.shape, quick)
        if not quick:
            now = time.monotonic()
            _put(self._slow, marks.exact, now)
            self._found.append(now)

    def _is_flood(self) -> bool:
        return len(self._found) == self._found.maxlen and time.monotonic() - self._found[0] < _FLOOD_SECONDS


def _put(known: OrderedDict[int, _T], mark: int, value: _T) -> None:
    known[mark] = value
    known.move_to_end(mark)
    if len(known) > _REMEMBERED:
        known.popitem(last=False)
