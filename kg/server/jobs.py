"""`/jobs`: running queries; `/jobs/{id}`: progress of one query, and its cancellation.

A client that knows the identity of a job may read and cancel it. It chooses the identity (`job=`) or reads it in
`X-Kg-Job`. Without the token, clients do not get the identities of other clients' jobs.
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


def _description(job: Job, *, whole: bool) -> dict[str, Any]:
    """Return the public description of a job, without identity and text unless `whole`."""
    progress = {"seconds": round(job.elapsed, 3), "rows": job.rows}
    return {"id": job.identity, "query": job.text, **progress} if whole else progress


def _json(content: object) -> Response:
    return Response(json.dumps(content), media_type="application/json", headers={"Cache-Control": "no-store"})


async def _all(request: Request) -> Response:
    jobs = state(request).readers.jobs
    return _json({"jobs": [_description(job, whole=is_trusted(request)) for job in jobs.values() if not job.own]})


async def _one(request: Request) -> Response:
    job = state(request).readers.jobs.get(request.path_params["identity"])
    if job is None:
        raise RequestError("KG521", "no job of this identity runs", hint="It has ended, or never began.")
    return _json(_description(job, whole=True))


async def _cancel(request: Request) -> Response:
    """Cancel a job; succeeds also for a job that has finished or never existed."""
    state(request).readers.cancel(request.path_params["identity"])
    return Response(status_code=204)


ROUTES = [route("/jobs", GET=_all), route("/jobs/{identity}", GET=_one, DELETE=_cancel)]
