"""Defects of ours: the client gets a code and an identity, the log the same identity and what happened."""

from __future__ import annotations

import secrets
from typing import TYPE_CHECKING

from starlette.requests import ClientDisconnect, HTTPConnection

from kg.errors import KgError
from kg.server.errors import DefectError, RequestError, answer

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

__all__ = ["Defects"]


class Defects:
    """Tell the client of what no route has foreseen, and raise it as a `DefectError` for the log.

    An error of `kg` behind the beginning of an answer is none: the answer ends there, and the connection with it.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass everything on; raises DefectError, and ClientDisconnect when nobody listens any more."""
        started = False

        async def sending(message: Message) -> None:
            nonlocal started
            started = True
            await send(message)

        try:
            await self._app(scope, receive, sending)
        except ClientDisconnect:
            raise
        except Exception as error:
            if started and isinstance(_reason(error), KgError):
                raise
            identity = secrets.token_hex(8)
            if scope["type"] == "http" and not started:
                told = RequestError("KG900", f"a defect in kg; the log of the server has more under {identity}")
                await answer(HTTPConnection(scope), told)(scope, receive, send)
            raise DefectError(identity) from error


def _reason(error: BaseException) -> BaseException:
    """Return what was raised first: Starlette wraps what comes behind the beginning of an answer."""
    return error.__cause__ or error
