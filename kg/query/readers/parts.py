"""Send a response in parts, and its progress."""

from __future__ import annotations

import time
from typing import BinaryIO, Final

from kg.errors import QueryError
from kg.query.readers.messages import End, Head, Progress, frame

_PART_BYTES: Final = 64 << 10
_SECONDS: Final = 0.1


class Parts:
    """Buffers a response and sends it in parts, after the head; `most` limits its bytes in all.

    Errors before the first part is full are found before anything is sent.
    """

    def __init__(self, answers: BinaryIO, head: Head, most: int | None) -> None:
        self._answers = answers
        self._head: Head | None = head
        self._most = most
        self._size = 0
        self._held: list[bytes] = []
        self._held_bytes = 0

    def take(self, data: bytes) -> None:
        """Append to the response; QueryError KG511 if it exceeds the limit."""
        self._size += len(data)
        if self._most is not None and self._size > self._most:
            hint = "Ask for fewer rows, with LIMIT."
            raise QueryError("KG511", f"the answer has more than {self._most:,} bytes", hint=hint)
        self._held.append(data)
        self._held_bytes += len(data)
        if self._held_bytes >= _PART_BYTES:
            self._send()

    def end(self, end: End) -> None:
        """Send the buffer and the end of the response as one piece."""
        self._send(frame(end))

    def _send(self, end: bytes = b"") -> None:
        head = b"" if self._head is None else frame(self._head)
        part = frame(b"".join(self._held)) if self._held else b""
        self._answers.write(head + part + end)
        self._answers.flush()
        self._head, self._held, self._held_bytes = None, [], 0


class Pulse:
    """Sends the number of rows, at most ten times a second."""

    def __init__(self, answers: BinaryIO) -> None:
        self._answers = answers
        self._next = time.monotonic() + _SECONDS

    def tick(self, count: int) -> None:
        """Send `count` if the last message is old enough."""
        now = time.monotonic()
        if now >= self._next:
            self._answers.write(frame(Progress(count)))
            self._answers.flush()
            self._next = now + _SECONDS
