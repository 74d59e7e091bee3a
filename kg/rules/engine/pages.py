"""Arrays in a temporary file: the memory of a large run is that of what it works on, not that of all it knows.

Arrays are written to the file and mapped for reading. The system keeps their pages as long as it has memory to spare;
`release` takes them out of this process, so that they count, and stay, only while they are used.
"""

from __future__ import annotations

import mmap
import os
import tempfile
from typing import TYPE_CHECKING, Any, Final, TypeVar
from weakref import finalize

import numpy as np

from kg.store.failure import translated

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    _Array = TypeVar("_Array", bound=NDArray[Any])

__all__ = ["SMALL_BYTES", "Pages"]

SMALL_BYTES: Final = 1 << 16
"""Smaller arrays stay in memory."""
_EXTENT_BYTES: Final = 1 << 26
"""The file grows by this much at least, and each piece is mapped as a whole; what is never written takes no disk."""
_LEAST_BYTES: Final = 1 << 12


class Pages:
    """A file of arrays in the folder `cache`, which goes with this object, however the process ends.

    Raises OSError when it cannot be made. Afterwards StoreError KG304 when the disk is full.
    """

    def __init__(self, cache: Path) -> None:
        cache.mkdir(parents=True, exist_ok=True)
        self._file = tempfile.TemporaryFile(dir=cache, buffering=0)  # noqa: SIM115 - arrays need it as long as this
        finalize(self, self._file.close)
        self._folder = str(cache)
        self._maps: list[mmap.mmap] = []
        self._end = self._left = 0
        self._free: dict[int, list[tuple[mmap.mmap, int, int]]] = {}
        """Places that arrays no longer need, by size: a mapped piece, the place in it, the place in the file."""

    def store(self, array: _Array) -> _Array:
        """Return an array as it is in the file, to be read; one that is there already, or is small, as it is."""
        if array.nbytes < SMALL_BYTES or not array.flags.writeable:
            return array
        return self.join([array])  # type: ignore[return-value]  # of the same kind

    def join(self, arrays: Sequence[NDArray[Any]]) -> NDArray[Any]:
        """Return some arrays of one type, one after the other, as one in the file."""
        size = sum(array.nbytes for array in arrays)
        kind = arrays[0].dtype
        if not size:
            return np.empty(0, kind)
        room = max(_LEAST_BYTES, 1 << (size - 1).bit_length())
        places = self._free.setdefault(room, [])
        place = places.pop() if places else self._place(room)
        piece, begin, offset = place
        with translated(self._folder):
            for array in arrays:
                rest = np.ascontiguousarray(array).data.cast("B") if array.size else memoryview(b"")
                while rest:
                    written = os.pwrite(self._file.fileno(), rest, offset)
                    rest, offset = rest[written:], offset + written
        view = np.frombuffer(piece, kind, size // kind.itemsize, begin)
        finalize(view, places.append, place)  # views of it keep it
        return view

    def release(self) -> None:
        """Take the pages out of this process, until they are read again."""
        if hasattr(mmap, "MADV_DONTNEED"):
            for piece in self._maps:
                piece.madvise(mmap.MADV_DONTNEED)

    def _place(self, room: int) -> tuple[mmap.mmap, int, int]:
        if room > self._left:
            extent = max(room, _EXTENT_BYTES)
            self._file.truncate(self._end + extent)
            self._maps.append(mmap.mmap(self._file.fileno(), extent, access=mmap.ACCESS_READ, offset=self._end))
            self._end, self._left = self._end + extent, extent
        begin = len(self._maps[-1]) - self._left
        self._left -= room
        return self._maps[-1], begin, self._end - len(self._maps[-1]) + begin
