"""The login page: browsers cannot send `Authorization` by themselves."""

from __future__ import annotations

import asyncio
import re
from typing import TYPE_CHECKING, Final

from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from kg.server.addresses import url
from kg.server.errors import RequestError
from kg.server.rendering import page
from kg.server.safety.tokens import Tokens, cookie_name

if TYPE_CHECKING:
    from starlette.requests import Request

_LOCAL: Final = re.compile(r"/(?![/\\])[^\x00-\x20\\]*")
"""A path on this server that no browser could take for another host."""
_PAUSE: Final = 0.3  # delay in seconds after a wrong token


def _page(request: Request, following: str, *, wrong: bool = False) -> Response:
    """Return the login page, which reveals nothing of the store; without a token, it has no form."""
    shown = page(
        request,
        "login.html",
        title="Log in",
        status=401 if wrong else 200,
        following=following,
        wrong=wrong,
        guarded=_tokens(request).proof is not None,
        snapshot=None,
    )
    shown.headers["Cache-Control"] = "no-store"
    return shown


def _tokens(request: Request) -> Tokens:
    tokens = request.scope["kg.tokens"]
    assert isinstance(tokens, Tokens)  # noqa: S101 - `Doors` put it there
    return tokens


def _following(value: object) -> str:
    return value if isinstance(value, str) and _LOCAL.fullmatch(value) else "/"


async def _login(request: Request) -> Response:
    if request.method != "POST":
        return _page(request, _following(request.query_params.get("next")))
    tokens = _tokens(request)
    async with request.form(max_files=0, max_fields=4, max_part_size=8192) as form:
        token, following = form.get("token"), _following(form.get("next"))
    if not isinstance(token, str):
        raise RequestError("KG520", "the form has no field `token`")
    proof = tokens.proof
    if proof is None or not tokens.matches(token):
        await asyncio.sleep(_PAUSE)
        return _page(request, following, wrong=True)
    return _session(RedirectResponse(url(following), 303), request, proof)


async def _logout(request: Request) -> Response:
    return _session(RedirectResponse(url("/login"), 303), request, "")


def _session(response: Response, request: Request, proof: str) -> Response:
    response.set_cookie(
        cookie_name(request),
        proof,
        max_age=None if proof else 0,
        path=url("") or "/",
        httponly=True,
        samesite="strict",
        secure=request.url.scheme == "https",
    )
    response.headers["Cache-Control"] = "no-store"
    return response


ROUTES: Final = [Route("/login", _login, methods=["GET", "POST"]), Route("/logout", _logout, methods=["POST"])]
"""Addresses for logging in and out."""
