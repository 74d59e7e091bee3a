"""The outermost middleware: it records the outcome of each request for logs and metrics, and reports defects."""

from __future__ import annotations

import secrets
from typing import TYPE_CHECKING

from starlette.requests import ClientDisconnect, HTTPConnection

from kg.errors import KgError
from kg.server.errors import DefectError, RequestError, answer
from kg.server.logs import Log
from kg.server.metrics import Metrics
from kg.server.records import record
from kg.server.safety.headers import with_headers

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from kg.server.options import Options


class Observed:
    """Record status, size, time and outcome of each request, and add the security headers to each response.

    For an unexpected exception, the client gets a code and an identity, and the log has the details under the same
    identity. A KgError after the start of a response is not a defect: the response and its connection end there.
    """

    def __init__(self, app: ASGIApp, options: Options) -> None:
        self._app = app
        self._log = Log(options)
        self._metrics = Metrics()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on and record its outcome; re-raises the application's errors, defects as DefectError."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        scope["kg.metrics"] = self._metrics
        request = HTTPConnection(scope)
        recorded = record(request)

        async def sending(message: Message) -> None:
            if message["type"] == "http.response.start":
                recorded.status = message["status"]
                message = with_headers(message)
            else:
                recorded.sent += len(message.get("body", b""))
            await send(message)

        try:
            await self._app(scope, receive, sending)
        except ClientDisconnect:
            recorded.outcome = "left"
        except Exception as error:
            if recorded.status and isinstance(_reason(error), KgError):
                recorded.outcome = "aborted" if recorded.outcome == "ok" else recorded.outcome
                raise
            identity = secrets.token_hex(8)
            if not recorded.status:
                internal = RequestError("KG900", f"a defect in kg; the log of the server has more under {identity}")
                await answer(request, internal)(scope, receive, sending)
            recorded.outcome = "KG900"
            defect = DefectError(identity)
            defect.__cause__ = error
            self._log.defect(defect)
            raise defect from error
        except BaseException:
            recorded.outcome = "aborted" if recorded.outcome == "ok" else recorded.outcome
            raise
        finally:
            self._metrics.count(scope["method"], recorded)
            self._log.request(request, recorded)


def _reason(error: BaseException) -> BaseException:
    """Return the original exception: Starlette wraps those raised after the start of a response."""
    return error.__cause__ or error
