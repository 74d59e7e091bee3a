"""OFFSET and LIMIT for a stream of results."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

Item = TypeVar("Item")


class Window(Generic[Item]):
    """The items after the first `offset`, at most `most`; can be iterated once.

    `count` is the number of items yielded so far. At the end, `more` is whether there were more than `most`. `tick` is
    called before each item is yielded, and may raise to stop.
    """

    def __init__(
        self,
        rows: Iterable[Item],
        *,
        offset: int = 0,
        most: int | None = None,
        tick: Callable[[int], object] = lambda _: None,
    ) -> None:
        self._rows = rows
        self._offset = offset
        self._most = most
        self._tick = tick
        self.count = 0
        self.more = False

    def __iter__(self) -> Iterator[Item]:
        """Yield the items; reads one more than `most` to detect whether there are more."""
        for item in islice(self._rows, self._offset, None):
            if self.count == self._most:
                self.more = True
                return
            self.count += 1
            self._tick(self.count)
            yield item
