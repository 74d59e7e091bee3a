"""`/jobs`: what runs; `/jobs/{id}`: how far a query is, and its end.

Whoever knows the identity of a job may look at it and cancel it. A client chooses it (`job=`) or reads it in
`X-Kg-Job`; without the token nobody is told those of others.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from starlette.responses import Response

from kg.server.errors import RequestError
from kg.server.methods import route
from kg.server.safety.tokens import is_trusted
from kg.server.state import state

if TYPE_CHECKING:
    from starlette.requests import Request

    from kg.query.readers.pool import Job


def _told(job: Job, *, whole: bool) -> dict[str, Any]:
    """Return what is told of a job; to those who do not know it neither its identity nor its text."""
    told = {"seconds": round(job.elapsed, 3), "rows": job.rows}
    return {"id": job.identity, "query": job.text, **told} if whole else told


def _json(content: object) -> Response:
    return Response(json.dumps(content), media_type="application/json", headers={"Cache-Control": "no-store"})


async def _all(request: Request) -> Response:
    jobs = state(request).readers.jobs
    return _json({"jobs": [_told(job, whole=is_trusted(request)) for job in jobs.values() if not job.own]})


async def _one(request: Request) -> Response:
    job = state(request).readers.jobs.get(request.path_params["identity"])
    if job is None:
        raise RequestError("KG521", "no job of this identity runs", hint="It has ended, or never began.")
    return _json(_told(job, whole=True))


async def _cancel(request: Request) -> Response:
    """End a job; one that has ended already, or never was, is none afterwards either."""
    state(request).readers.cancel(request.path_params["identity"])
    return Response(status_code=204)


ROUTES = [route("/jobs", GET=_all), route("/jobs/{identity}", GET=_one, DELETE=_cancel)]
