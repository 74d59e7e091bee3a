"""Logs of requests and of slow queries: lines to standard error or a file, never to standard output.

The token is never logged. The request log identifies a query by its digest; only the log of slow queries, which is off
by default, contains its text.
"""

from __future__ import annotations

import json
import logging
import sys
import traceback
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, Final

from kg.server.errors import DefectError

if TYPE_CHECKING:
    from starlette.requests import HTTPConnection

    from kg.server.options import Options
    from kg.server.records import Record

_REQUESTS: Final = logging.getLogger("kg.server.requests")
_SLOW: Final = logging.getLogger("kg.server.slow")
_DEFECTS: Final = logging.getLogger("kg.server.defects")


class Log:
    """The logs of one server."""

    def __init__(self, options: Options) -> None:
        self._form = options.log
        self._slow = options.slow
        self._slow_log = options.slow_log

    def request(self, request: HTTPConnection, recorded: Record) -> None:
        """Log a finished request, and its query if it was slow."""
        seconds = recorded.seconds
        if self._form != "off":
            _REQUESTS.info(self._line(_members(request, recorded, seconds)))
        if self._slow is not None and recorded.query is not None and seconds >= self._slow:
            self._write_slow(recorded, seconds)

    def _line(self, members: dict[str, Any]) -> str:
        if self._form == "json":
            return json.dumps(members)
        first = f"{members.pop('time')} {members.pop('client')} {members.pop('method')} {members.pop('path')}"
        fields = (f"{name}={value}" for name, value in members.items() if value not in (None, False))
        return " ".join((first, *fields))

    def _write_slow(self, recorded: Record, seconds: float) -> None:
        members = {
            "time": _now(),
            "seconds": round(seconds, 3),
            "rows": recorded.rows,
            "outcome": recorded.outcome,
            "digest": recorded.digest,
            "query": recorded.query,
        }
        line = json.dumps(members)
        try:
            if self._slow_log is None:
                _SLOW.info(line)
            else:
                with self._slow_log.open("a", encoding="utf-8") as file:
                    file.write(line + "\n")
        except OSError as error:
            _SLOW.warning("the log of slow queries cannot be written: %s", error)

    @staticmethod
    def defect(error: DefectError) -> None:
        """Log a defect under the identity reported to the client."""
        _DEFECTS.error("%s KG900 %s\n%s", _now(), error, "".join(traceback.format_exception(error.__cause__)).rstrip())


def _members(request: HTTPConnection, recorded: Record, seconds: float) -> dict[str, Any]:
    scope = request.scope
    path = scope["path"]
    return {
        "time": _now(),
        "client": (scope.get("client") or ("-",))[0],
        "method": scope["method"],
        "path": path if path.isprintable() and " " not in path else path.encode("unicode_escape").decode(),
        "status": recorded.status,
        "ms": round(seconds * 1000, 1),
        "bytes": recorded.sent,
        "outcome": recorded.outcome,
        "rows": recorded.rows,
        "query": recorded.digest,
        "cached": recorded.cached,
    }


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


class _SkipLogged(logging.Filter):
    """Filter out records that this module has logged itself."""

    def filter(self, record: logging.LogRecord) -> bool:
        raised = record.exc_info[1] if record.exc_info else None
        return not isinstance(raised, DefectError)


def configure() -> None:
    """Send the logs of this process to standard error, one line each."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("%(message)s"))
    logger = logging.getLogger("kg.server")
    logger.handlers = [handler]
    logger.setLevel(logging.INFO)
    logger.propagate = False
    logging.getLogger("uvicorn.error").addFilter(_SkipLogged())
