"""What stands between a client and the routes: plain ASGI middlewares, and what guards each connection below them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.middleware import Middleware

from kg.server.safety.bodies import Bodies, announced
from kg.server.safety.defects import Defects
from kg.server.safety.floods import Floods
from kg.server.safety.gate import Gate
from kg.server.safety.headers import SecurityHeaders
from kg.server.safety.hosts import Hosts
from kg.server.safety.observing import Observed
from kg.server.safety.sites import CrossOrigin, Sites
from kg.server.safety.tokens import Doors, Tokens

if TYPE_CHECKING:
    from kg.server.options import Options

__all__ = ["middleware"]


def middleware(options: Options) -> list[Middleware]:
    """Return the middlewares of a server with these options, outermost first."""
    tokens = Tokens(options.token, options.token_file)
    return [
        Middleware(Observed, options=options),
        Middleware(SecurityHeaders),
        Middleware(Defects),
        Middleware(Gate, checks=(announced(options.body), Hosts(options))),
        *([Middleware(CrossOrigin, origins=options.origins)] if options.origins else []),
        Middleware(Gate, checks=(Sites(options.origins), Doors(options, tokens))),
        Middleware(Floods, most=options.per_client),
        Middleware(Bodies, most=options.body),
    ]
