"""Failures of the disk and of the engine, as errors of `kg`.

The engine (RocksDB in Oxigraph) raises `OSError` and `RuntimeError`; only their text reveals a full disk or a damaged
file.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TypeGuard
from urllib.parse import urlsplit, urlunsplit

from kg.errors import Place, StoreError

_FULL = frozenset({errno.ENOSPC, errno.EDQUOT})
_CLOSED = frozenset({errno.EACCES, errno.EPERM, errno.EROFS})
_NO_FOLDER = frozenset({errno.ENOTDIR, errno.EEXIST})
_FULL_TEXTS = ("No space left on device", "Disk quota exceeded", "NoSpace")
_DAMAGED_TEXT = "Corruption:"
_ANOTHER = "Name a folder with `--store`."
LOCAL_HINT = "Use a store of this machine; `kg pull` makes one of a published graph."
"""What to do instead of a command that does not support a SPARQL server."""


def is_of_store(error: Exception) -> TypeGuard[OSError | RuntimeError]:
    """Return whether an error of the engine is about the disk or the store, not about the request."""
    return isinstance(error, OSError) or (isinstance(error, RuntimeError) and str(error).startswith(_DAMAGED_TEXT))


def store_error(error: OSError | RuntimeError, path: str) -> StoreError:
    """Return the error of `kg` for a failure at the store `path`.

    KG304 is a full disk, KG306 a path that is not writable or not a folder, KG303 anything else.
    """
    text = str(error)
    number = error.errno if isinstance(error, OSError) else None
    if number in _FULL or any(part in text for part in _FULL_TEXTS):
        return StoreError("KG304", "the disk is full; the store is as it was before", place=Place(path))
    if number in _CLOSED:
        return StoreError("KG306", f"it cannot be written: {os.strerror(number or 0)}", place=Place(path))
    if number in _NO_FOLDER:
        return StoreError("KG306", "it is a file, and a store is a folder", place=Place(path), hint=_ANOTHER)
    return StoreError("KG303", text, place=Place(path), hint="Run `kg doctor`, or build the store again.")


def remote_refusal(address: str) -> StoreError:
    """Return the error of a command that does not support a SPARQL server."""
    message = "the command does not work on a SPARQL server"
    return StoreError("KG309", message, place=Place(shown(address)), hint=LOCAL_HINT)


def shown(address: str) -> str:
    """Return an address without credentials and without parameters, which may hold keys."""
    parts = urlsplit(address)
    return urlunsplit((parts.scheme, parts.netloc.rpartition("@")[2], parts.path, "", ""))


@contextmanager
def translated(path: str) -> Iterator[None]:
    """Raise errors of the disk or the engine in the body as `StoreError` about `path`."""
    try:
        yield
    except (OSError, RuntimeError) as error:
        raise store_error(error, path) from error
