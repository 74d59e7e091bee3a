"""The part of an answer that is asked for, out of what is found one by one."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

Item = TypeVar("Item")


class Window(Generic[Item]):
    """What is found behind the first `offset`, `most` of it at most, to be taken once.

    `count` is how many were given out so far; `more` tells, at the end, whether there were more than `most`. `tick` is
    called at each, before it is given out, and may raise to end it.
    """

    def __init__(
        self,
        found: Iterable[Item],
        *,
        offset: int = 0,
        most: int | None = None,
        tick: Callable[[int], object] = lambda _: None,
    ) -> None:
        self._found = found
        self._offset = offset
        self._most = most
        self._tick = tick
        self.count = 0
        self.more = False

    def __iter__(self) -> Iterator[Item]:
        """Yield them; one more than `most` is looked for, to know whether there are more."""
        for item in islice(self._found, self._offset, None):
            if self.count == self._most:
                self.more = True
                return
            self.count += 1
            self._tick(self.count)
            yield item
