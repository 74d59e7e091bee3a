"""A server with a robot that is asked to stop."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import httpx
from patience import patient
from rover import PREPARED
from serving import TOKEN, served

if TYPE_CHECKING:
    from pathlib import Path


def test_pages_that_listen_do_not_hold_up_the_end(store: Path) -> None:
    """The robot is stopped and streams end at once, before the grace period of requests is over (C39)."""
    with served(store, before=PREPARED, log="off", token=TOKEN, robot="rover://ending", grace=60) as server:
        with httpx.stream("GET", f"{server.address}/robot/events", timeout=patient(30)) as stream:
            lines = stream.iter_lines()
            assert "hello" in next(lines)
            begun = time.monotonic()
            code, said = server.stop(20)
        assert time.monotonic() - begun < patient(10)
        assert (code, said) == (0, "")
