"""Receive requests and report errors, in processes that answer one request after the other."""

from __future__ import annotations

import traceback
from typing import BinaryIO, Final

from kg.errors import KgError
from kg.query.readers.messages import PREFIX, Failure, Message, decode
from kg.store.failure import is_of_store, store_error

_NO_THREAD: Final = "can't start new thread"
"""Message of Python if the stack of a thread cannot be allocated."""


def received(requests: BinaryIO) -> Message | bytes | None:
    """Return the next message; None at the end of the stream."""
    prefix = requests.read(PREFIX.size)
    if len(prefix) < PREFIX.size:
        return None
    length, kind = PREFIX.unpack(prefix)
    return decode(kind, requests.read(length))


def failure(error: Exception, what: str) -> Failure:
    """Return the error of `what` (such as "query") as a message for the owner of this process.

    The code is KG507 for a lack of memory, and one of the store's codes for errors of the system. Unexpected exceptions
    are KG900; their traceback is written to standard error.
    """
    if isinstance(error, KgError):
        return Failure.of(error)
    if isinstance(error, MemoryError) or str(error) == _NO_THREAD:
        return Failure("KG507", f"the {what} needs more memory than it may use")
    if is_of_store(error):
        return Failure.of(store_error(error, "the store"))
    traceback.print_exception(error)
    return Failure("KG900", f"a defect in kg: {type(error).__name__}: {error}", "KgError")
