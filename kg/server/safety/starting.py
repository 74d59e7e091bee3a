"""What has to hold before a server listens: who could reach it, and what they would need."""

from __future__ import annotations

import socket
from typing import TYPE_CHECKING

from kg.errors import UsageError
from kg.server.safety.hosts import is_loopback
from kg.server.safety.tokens import LEAST, Tokens

if TYPE_CHECKING:
    from kg.server.options import Options


def check(options: Options) -> None:
    """Refuse options that would let others in unasked.

    Raises:
        UsageError: KG540 other machines could read without a token, KG541 the token is missing or cannot be used,
            KG002 origins that may not be listed.
    """
    given = options.token is not None or options.token_file is not None
    if given and not _usable(options):
        where = f"the file {options.token_file}" if options.token_file else "KG_TOKEN"
        raise UsageError("KG541", f"{where} holds no token of at least {LEAST} characters")
    if options.write and not given:
        raise UsageError("KG541", "write access needs a token, but none is set")
    if not is_loopback(options.host) and not given and not options.open_to_all:
        raise UsageError("KG540", f"{options.host} is reachable from other machines, but no token is set")
    for origin in options.origins:
        if not _is_origin(origin):
            hint = "List origins one by one, as in `--cors https://example.org`."
            raise UsageError("KG002", f"{origin!r} is not an origin of a site", hint=hint)


def _usable(options: Options) -> bool:
    token = Tokens(options.token, options.token_file).current
    return token is not None and len(token) >= LEAST and token.isascii() and token.isprintable() and " " not in token


def _is_origin(text: str) -> bool:
    scheme, separator, host = text.partition("://")
    return scheme in {"http", "https"} and bool(separator and host) and not set(host) & set("/?#@* ")


def listen(options: Options) -> socket.socket:
    """Return a socket that listens where the options say; UsageError KG542 when that cannot be."""
    if not 0 <= options.port < 1 << 16:
        raise UsageError("KG542", f"{options.port} is not a port", hint="Ports go from 0, for a free one, to 65535.")
    try:
        family, kind, _, _, address = socket.getaddrinfo(
            options.host.strip("[]"), options.port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        listening = socket.socket(family, kind)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind(address)
        listening.listen(512)
    except OSError as error:
        message = f"cannot listen at {options.host} port {options.port}: {error.strerror or error}"
        raise UsageError("KG542", message) from error
    return listening
