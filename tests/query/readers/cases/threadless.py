"""Readers whose main thread cannot be started."""

from __future__ import annotations

import threading

from kg.query.readers.forkserver import main


def start(_: threading.Thread) -> None:
    """Fail as if there were no address space for a stack."""
    message = "no room for a thread"
    raise RuntimeError(message)


if __name__ == "__main__":
    threading.Thread.start = start  # type: ignore[method-assign]  # to fail where the test wants it
    main()
