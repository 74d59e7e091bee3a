"""HTTP requests to a SPARQL server; failures are raised as errors of `kg`.

A request is only retried if the server cannot have received it, or if it is idempotent: an update that creates blank
nodes must not run twice.
"""

from __future__ import annotations

import base64
import json
import os
import shutil
import time
import urllib.request
from contextlib import suppress
from dataclasses import dataclass
from http import HTTPStatus
from http.client import HTTPException, HTTPResponse, IncompleteRead
from io import BufferedIOBase
from tempfile import SpooledTemporaryFile
from typing import IO, TYPE_CHECKING, Final, cast
from urllib.error import HTTPError, URLError
from urllib.parse import unquote, urlencode, urlsplit, urlunsplit
from urllib.request import HTTPDigestAuthHandler, HTTPPasswordMgrWithDefaultRealm, parse_http_list, parse_keqv_list

from kg.errors import Place, StoreError
from kg.store.failure import shown

if TYPE_CHECKING:
    from collections.abc import Sequence
    from email.message import Message

_ATTEMPTS: Final = 4
_FIRST_PAUSE: Final = 0.1
"""Seconds before the second attempt; each further pause is twice as long."""
_LONGEST_LINE: Final = 300
_LOGIN: Final = "Set KG_REMOTE_USER and KG_REMOTE_PASSWORD, or KG_REMOTE_TOKEN."
_ANYTHING: Final = "*/*"
_IN_MEMORY: Final = 16 << 20
"""Largest response in memory, in bytes; a larger one goes to a temporary file."""


@dataclass(frozen=True, slots=True)
class Answer:
    """Response of a server: the media type without parameters, and the body, in a file if large."""

    media_type: str
    body: IO[bytes]


class RefusedError(StoreError):
    """A server answered a request with an error; `status` is that of HTTP."""

    def __init__(self, status: int, message: str, *, place: Place, hint: str) -> None:
        """Create the error, which has the code KG225."""
        super().__init__("KG225", message, place=place, hint=hint)
        self.status = status


class _NoRedirects(urllib.request.HTTPRedirectHandler):
    """Reports redirects as errors: a redirected POST would arrive as a GET and change nothing."""

    def redirect_request(self, *_: object) -> None:
        return None


class _Login:
    """User name and password, as Basic authentication, or as Digest authentication after the server requested it.

    Digest authentication (RFC 7616) needs a challenge of the server, which holds for further requests until it expires.
    """

    def __init__(self, user: str, password: str, url: str) -> None:
        self._basic = _basic(user, password)
        passwords = HTTPPasswordMgrWithDefaultRealm()
        passwords.add_password(None, url, user, password)
        self._digest = HTTPDigestAuthHandler(passwords)
        self._challenge: dict[str, str] = {}

    def authorize(self, request: urllib.request.Request) -> None:
        """Add the header of authentication to a request."""
        digest = self._digest.get_authorization(request, self._challenge) if self._challenge else None
        request.add_header("Authorization", f"Digest {digest}" if digest else self._basic)

    def accepts(self, headers: Message) -> bool:
        """Store the challenge for Digest authentication in the headers of a response; return whether there is one."""
        scheme, _, parameters = headers.get("WWW-Authenticate", "").partition(" ")
        if scheme.lower() != "digest":
            return False
        challenge = parse_keqv_list(parse_http_list(parameters))
        if challenge.get("algorithm", "MD5") != "MD5":  # the others differ between versions of Python
            return False
        self._challenge = challenge
        return True


class Endpoint:
    """Address of a server; its user name and password are never shown.

    They are sent as Basic authentication, or as Digest authentication if the server requests it.

    Raises:
        StoreError: KG225 if the scheme of the address is not http or https.
    """

    def __init__(self, address: str, *, timeout: float = 60.0, from_environment: bool = False) -> None:
        """`timeout` is how long the server may be silent, in seconds.

        `from_environment` sends the credentials in `KG_REMOTE_TOKEN`, or `KG_REMOTE_USER` and `KG_REMOTE_PASSWORD`.
        """
        self.timeout = timeout
        self._from_environment = from_environment
        parts = urlsplit(address)
        host = parts.netloc.rpartition("@")[2]
        self.shown = shown(address)
        if parts.scheme not in {"http", "https"} or not host:
            hint = "Give an address such as http://localhost:7878/query."
            raise StoreError("KG225", "this is not the address of a server", place=Place(self.shown), hint=hint)
        self._url = urlunsplit((parts.scheme, host, parts.path, parts.query, ""))
        self._headers = {"User-Agent": "kg"}
        user, password = "", ""
        if parts.username is not None:
            user, password = unquote(parts.username), unquote(parts.password or "")
        elif from_environment:
            token, user, password = _credentials(parts.scheme, parts.hostname or "")
            self._headers |= {"Authorization": f"Bearer {token}"} if token else {}
        self._login = _Login(user, password, self._url) if user else None
        self._opener = urllib.request.build_opener(_NoRedirects)

    def get(self, target: IO[bytes], limit: int) -> None:
        """Download the content of the address to `target`.

        Raises:
            StoreError: KG225 as `post`, KG308 for more than `limit` bytes.
        """
        request = urllib.request.Request(self._url, headers=self._headers)  # noqa: S310 - http or https, see __init__
        try:
            with self._open(request, self.timeout) as response:
                while chunk := response.read(1 << 16):
                    limit -= len(chunk)
                    if limit < 0:
                        raise StoreError("KG308", "the server sent more than it may", place=Place(self.shown))
                    target.write(chunk)
                _check_complete(response)
        except HTTPError as error:
            raise self._refused(error) from error
        except (OSError, HTTPException) as error:
            raise self._unreachable(error, self.timeout) from error

    def put(self, content: IO[bytes], size: int) -> None:
        """Put `size` bytes to the address; raises as `post`."""
        headers = {**self._headers, "Content-Type": "application/octet-stream", "Content-Length": str(size)}
        request = urllib.request.Request(self._url, content, headers, method="PUT")  # noqa: S310 - http or https, see __init__
        try:
            self._open(request, self.timeout).close()
        except HTTPError as error:
            raise self._refused(error) from error
        except (OSError, HTTPException) as error:
            raise self._unreachable(error, self.timeout) from error

    def post(
        self, fields: Sequence[tuple[str, str]], *, accept: str = _ANYTHING, timeout: float | None = None
    ) -> Answer:
        """Send the fields of a form, which every server accepts, and return the response.

        Virtuoso hangs on a body that is a plain query, the alternative of the protocol. A request with `accept` is a
        query, and is retried if the connection broke before the response; an update is not.

        Raises:
            RefusedError: KG225 with the status and the first line of the server's message.
            StoreError: KG225 with the reason why there was no response.
        """
        headers = {**self._headers, "Content-Type": "application/x-www-form-urlencoded", "Accept": accept}
        request = urllib.request.Request(self._url, urlencode(fields).encode(), headers, method="POST")  # noqa: S310 - http or https, see __init__
        repeatable = accept != _ANYTHING
        seconds = timeout or self.timeout
        for attempt in range(_ATTEMPTS):
            try:
                return self._send(request, seconds)
            except HTTPError as error:
                raise self._refused(error) from error
            except (OSError, HTTPException) as error:
                if attempt == _ATTEMPTS - 1 or not (_unsent(error) or (repeatable and not _timed_out(error))):
                    raise self._unreachable(error, seconds) from error
                time.sleep(_FIRST_PAUSE * 2**attempt)
        raise AssertionError

    def _send(self, request: urllib.request.Request, timeout: float) -> Answer:
        with self._open(request, timeout) as response:
            body = SpooledTemporaryFile(_IN_MEMORY)  # noqa: SIM115 - closed with the response
            shutil.copyfileobj(response, body)
            _check_complete(response)
            body.seek(0)
            return Answer(response.headers.get_content_type(), cast("IO[bytes]", body))

    def _open(self, request: urllib.request.Request, timeout: float) -> HTTPResponse:
        """Send a request; once more if the server requests Digest authentication."""
        if self._login is None:
            return cast("HTTPResponse", self._opener.open(request, timeout=timeout))
        self._login.authorize(request)
        try:
            return cast("HTTPResponse", self._opener.open(request, timeout=timeout))
        except HTTPError as error:
            # Virtuoso sends no challenge if a request has a header of Basic authentication.
            if error.code != HTTPStatus.UNAUTHORIZED or not (
                self._login.accepts(error.headers) or self._login.accepts(self._headers_without_login(timeout))
            ):
                raise
            error.close()
        if isinstance(request.data, BufferedIOBase):
            request.data.seek(0)
        self._login.authorize(request)
        return cast("HTTPResponse", self._opener.open(request, timeout=timeout))

    def _headers_without_login(self, timeout: float) -> Message:
        """Return the headers of the response to an empty request without credentials."""
        request = urllib.request.Request(self._url, headers=self._headers)  # noqa: S310 - http or https, see __init__
        try:
            with self._opener.open(request, timeout=timeout) as response:
                return cast("Message", response.headers)
        except HTTPError as error:
            with error:
                return error.headers

    def _refused(self, error: HTTPError) -> RefusedError:
        with error:
            line, advice = _report(error.headers.get_content_type(), error.read(1 << 16))
        if error.code == 401 or (error.code == 403 and not advice):  # noqa: PLR2004 - HTTP: a login is missing or wrong
            hint = _LOGIN if self._from_environment else "Give user and password as http://USER:PASSWORD@HOST/."
        elif 300 <= error.code < 400:  # noqa: PLR2004 - HTTP redirections
            hint = "Give the address that the server answers at itself; redirections are not followed."
        elif error.code in {404, 405}:
            hint = "Check the address: servers have one for queries and one for updates."
        else:
            hint = advice or "The server sent this text; see its log for details."
        message = f"the server answered {error.code} {error.reason}" + (f": {line}" if line else "")
        return RefusedError(error.code, message, place=Place(self.shown), hint=hint)

    def _unreachable(self, error: OSError | HTTPException, seconds: float) -> StoreError:
        reason = error.reason if isinstance(error, URLError) else error
        if _timed_out(error):
            message = f"the server did not answer within {seconds:g} s"
            hint = "It may still be at work; allow more time, or give it less to do at once."
        elif isinstance(reason, ConnectionResetError | BrokenPipeError | IncompleteRead):
            # urllib wraps what fails while it sends, not what fails while it reads.
            missing = "it had the whole request" if isinstance(error, URLError) else "its response was complete"
            message = f"the server closed the connection before {missing}"
            hint = "Servers do so if the login is wrong or the request too large for them; see the log of the server."
        else:
            message = f"cannot connect to the server: {reason or type(reason).__name__}"
            hint = "Check that the server runs and that the address is right."
        return StoreError("KG225", message, place=Place(self.shown), hint=hint)


def _credentials(scheme: str, host: str) -> tuple[str, str, str]:
    """Return token, user and password from the environment, for the server that the user named; empty if not set.

    Credentials are not sent unencrypted to another machine.
    """
    token = os.environ.get("KG_REMOTE_TOKEN")
    user = os.environ.get("KG_REMOTE_USER")
    if not token and not user:
        return "", "", ""
    if scheme != "https" and host not in {"localhost", "127.0.0.1", "::1"}:
        hint = "Use an address of https, or unset KG_REMOTE_TOKEN and KG_REMOTE_USER."
        raise StoreError("KG225", "credentials are not sent without encryption", place=Place(host), hint=hint)
    if token:
        return token, "", ""
    return "", user or "", os.environ.get("KG_REMOTE_PASSWORD", "")


def _check_complete(response: HTTPResponse) -> None:
    """Raise IncompleteRead if the connection ended early, which reading in pieces does not report."""
    if response.length:
        raise IncompleteRead(b"", response.length)


def _basic(user: str, password: str) -> str:
    return "Basic " + base64.b64encode(f"{user}:{password}".encode()).decode()


def _unsent(error: OSError | HTTPException) -> bool:
    """Return whether the server cannot have received the request, as there was no connection."""
    return isinstance(error, URLError) and isinstance(error.reason, ConnectionRefusedError)


def _timed_out(error: OSError | HTTPException) -> bool:
    reason = error.reason if isinstance(error, URLError) else error
    return isinstance(reason, TimeoutError)


def _report(content_type: str, body: bytes) -> tuple[str, str]:
    """Return the message of an error and, from a server of kg, its hint (the JSON of RFC 9457, section 3)."""
    if content_type == "application/problem+json":
        with suppress(ValueError, AttributeError):
            members = json.loads(body)
            message = members.get("message") or members.get("detail") or members.get("title") or ""
            return _first_line(str(message).encode()), _first_line(str(members.get("hint") or "").encode())
    return _first_line(body), ""


def _first_line(body: bytes) -> str:
    lines = (line.strip() for line in body.decode(errors="replace").splitlines())
    return next(filter(None, lines), "")[:_LONGEST_LINE]
