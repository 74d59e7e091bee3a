"""What processes share that answer requests one after the other: taking them, and telling what one failed of."""

from __future__ import annotations

import traceback
from typing import BinaryIO, Final

from kg.errors import KgError
from kg.query.readers.messages import PREFIX, Failure, Message, decode
from kg.store.failure import is_of_store, store_error

_NO_THREAD: Final = "can't start new thread"
"""How Python says that there is no room for the stack of one."""


def received(requests: BinaryIO) -> Message | bytes | None:
    """Return what comes next; None when nothing comes any more."""
    prefix = requests.read(PREFIX.size)
    if len(prefix) < PREFIX.size:
        return None
    length, kind = PREFIX.unpack(prefix)
    return decode(kind, requests.read(length))


def failure(error: Exception, what: str) -> Failure:
    """Return what tells the owner of this process why `what` (such as "query") failed.

    KG507 stands for a lack of memory, and codes of the store for what the system reports; what nobody has foreseen is
    KG900, and goes to standard error as a whole.
    """
    if isinstance(error, KgError):
        return Failure.of(error)
    if isinstance(error, MemoryError) or str(error) == _NO_THREAD:
        return Failure("KG507", f"the {what} needs more memory than it may use")
    if is_of_store(error):
        return Failure.of(store_error(error, "the store"))
    traceback.print_exception(error)
    return Failure("KG900", f"a defect in kg: {type(error).__name__}: {error}", "KgError")
