"""The check of `Host` against DNS rebinding: names that lead to this server without its consent."""

from __future__ import annotations

import re
from functools import lru_cache
from ipaddress import ip_address
from typing import TYPE_CHECKING, Final

from kg.server.errors import RequestError

if TYPE_CHECKING:
    from starlette.requests import HTTPConnection

    from kg.server.options import Options

LOOPBACK: Final = frozenset({"localhost", "127.0.0.1", "::1"})
"""Names of this machine for itself."""
_HOST: Final = re.compile(r"(?:\[(?P<six>[0-9a-fA-F:.]+)\]|(?P<name>[\w.-]+))(?::\d{1,5})?", re.ASCII)


@lru_cache(maxsize=256)
def is_loopback(host: str) -> bool:
    """Return whether a listening address is reachable from this machine only."""
    try:
        return ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return host.lower() == "localhost"


class Hosts:
    """Refuse requests for hosts other than loopback, the listening address and the allowed ones: KG527.

    Requests with no `Host`, several, or a malformed one are refused with KG520 (RFC 9112, section 3.2).
    """

    def __init__(self, options: Options) -> None:
        listened = () if options.host in {"", "0.0.0.0", "::"} else (options.host,)  # noqa: S104 - compared, not bound
        self._named = LOOPBACK | {name.lower().strip("[]") for name in (*listened, *options.hosts)}
        self._any_address = not is_loopback(options.host)

    def __call__(self, request: HTTPConnection) -> RequestError | None:
        """Return the error for a request for another host."""
        named = [value.decode("latin-1") for name, value in request.scope["headers"] if name == b"host"]
        if len(named) != 1:
            problem = f"the Host header is sent {len(named)} times" if named else "the Host header is missing"
            return RequestError("KG520", problem, hint="Send it once.")
        name = _name(named[0])
        if name is None:
            return RequestError("KG520", f"the Host header does not contain a host: {named[0]!r}")
        if name in self._named or (self._any_address and _is_address(name)):
            return None
        return RequestError("KG527", f"this server does not answer for the host {named[0]!r}")


@lru_cache(maxsize=64)
def _name(host: str) -> str | None:
    match = _HOST.fullmatch(host)
    return None if match is None else (match["six"] or match["name"]).lower().removesuffix(".")


def _is_address(name: str) -> bool:
    """Return whether a host is an IP address, which DNS cannot redirect."""
    try:
        ip_address(name)
    except ValueError:
        return False
    return True
