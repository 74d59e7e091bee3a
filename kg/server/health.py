"""`/health`: whether the server is alive and can read its store; needs no reader, so it responds under any load."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Final

from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from kg.errors import StoreError
from kg.server.state import state

if TYPE_CHECKING:
    from starlette.requests import Request


async def _health(request: Request) -> Response:
    """Answer 200 with the snapshot in force, its age in seconds and the readers; 503 when there is no store.

    A store on another server must have answered when it was last looked at, else 502.

    Requests that the server makes itself do not count, as in the list of jobs.
    """
    shared = state(request)
    layout = shared.readers.layout
    generation = layout.in_force()
    if generation is None:
        raise StoreError("KG301", "the store's data has been deleted")
    following = shared.readers.following
    if following is not None and following.failure is not None:
        raise following.failure
    jobs = sum(not job.own for job in shared.readers.jobs.values())
    waiting = shared.readers.stats().waiting
    return JSONResponse(
        {
            "status": "ok",
            "snapshot": str(generation),
            "age": round(time.time() - layout.pointer.stat().st_mtime, 3),
            "readers": shared.options.readers,
            "running": jobs - waiting,
            "waiting": waiting,
        },
        headers={"Cache-Control": "no-store"},
    )


ROUTES: Final = [Route("/health", _health)]
"""Addresses for supervisors of the server."""
