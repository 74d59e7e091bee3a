"""The outermost middleware: it sees what a request came to, and tells the log and the metrics."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.requests import ClientDisconnect, HTTPConnection

from kg.server.errors import DefectError
from kg.server.logs import Log
from kg.server.metrics import Metrics
from kg.server.records import record

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from kg.server.options import Options

__all__ = ["Observed"]


class Observed:
    """Note status, size, time and outcome of every request."""

    def __init__(self, app: ASGIApp, options: Options) -> None:
        self._app = app
        self._log = Log(options)
        self._metrics = Metrics()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on and write down what came of it; raises what the application raises."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        scope["kg.metrics"] = self._metrics
        request = HTTPConnection(scope)
        found = record(request)

        async def sending(message: Message) -> None:
            if message["type"] == "http.response.start":
                found.status = message["status"]
            else:
                found.sent += len(message.get("body", b""))
            await send(message)

        try:
            await self._app(scope, receive, sending)
        except ClientDisconnect:
            found.outcome = "left"
        except DefectError as error:
            found.outcome = "KG900"
            self._log.defect(error)
            raise
        except BaseException:
            found.outcome = "aborted" if found.outcome == "ok" else found.outcome
            raise
        finally:
            self._metrics.count(scope["method"], found)
            self._log.request(request, found)
