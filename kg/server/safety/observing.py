"""The outermost middleware: it records the outcome of each request for logs and metrics, and reports defects."""

from __future__ import annotations

import secrets
from typing import TYPE_CHECKING, TypeAlias

from starlette.requests import ClientDisconnect, HTTPConnection

from kg.errors import KgError
from kg.server.errors import DefectError, RequestError, answer
from kg.server.logs import Log
from kg.server.metrics import Metrics
from kg.server.records import Record, record
from kg.server.safety.headers import lines_of, with_headers
from kg.server.scopes import WHOLE

if TYPE_CHECKING:
    from collections.abc import Callable

    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from kg.server.options import Options

    Whole: TypeAlias = Callable[[int, bytes, bytes], bool]


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
        sending = _Sending(send, recorded, scope.get(WHOLE))
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
            await sending.end()
            self._metrics.count(scope["method"], recorded)
            self._log.request(request, recorded)


class _Sending:
    """The `send` of one response: it records it, and adds the security headers.

    The start of a response with a known length waits for the body, since `whole` (`kg.server.scopes.WHOLE`) sends both
    at once; without `whole`, and in other cases, all parts are passed on.
    """

    __slots__ = ("_lines", "_recorded", "_send", "_started", "_whole")

    def __init__(self, send: Send, recorded: Record, whole: Whole | None) -> None:
        self._send = send
        self._recorded = recorded
        self._whole = whole
        self._started: Message | None = None
        self._lines = b""

    async def __call__(self, message: Message) -> None:
        if message["type"] == "http.response.start":
            self._recorded.status = message["status"]
            lines = lines_of(message["headers"]) if self._whole is not None else None
            if lines is None:
                await self._send(with_headers(message))
            else:
                self._started, self._lines = message, lines
            return
        body = message.get("body", b"")
        self._recorded.sent += len(body)
        started, whole = self._started, None if message.get("more_body", False) else self._whole
        if started is not None and whole is not None and whole(started["status"], self._lines, body):
            self._started = None
            return
        await self.end()
        await self._send(message)

    async def end(self) -> None:
        """Send the start if it still waits: without the body, the client sees that the response was cut off."""
        if self._started is not None:
            started, self._started = self._started, None
            await self._send(with_headers(started))


def _reason(error: BaseException) -> BaseException:
    """Return the original exception: Starlette wraps those raised after the start of a response."""
    return error.__cause__ or error
