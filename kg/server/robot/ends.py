"""How work for pages ended: errors are told as they are, defects of ours with KG900, and reported."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kg.errors import KgError
from kg.robot.tasks import report
from kg.server.errors import RequestError

if TYPE_CHECKING:
    import asyncio

__all__ = ["failure"]


def failure(task: asyncio.Task[Any], what: str) -> KgError | None:
    """Return the error that ended a task, None where none did; a defect is reported as that of `what`."""
    error = None if task.cancelled() else task.exception()
    if error is None or isinstance(error, KgError):
        return error
    report(what, error)
    return RequestError("KG900", f"a defect in kg ended {what}; the log of the server has more")
