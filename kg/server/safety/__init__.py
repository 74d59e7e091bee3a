"""Protection of the server: ASGI middlewares, and limits on connections below them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.middleware import Middleware

from kg.server.safety.bodies import Bodies, announced, long
from kg.server.safety.floods import Floods, Gate
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
    here, who = (announced, Hosts(options)), (Sites(options.origins), Doors(options, tokens))
    each = (long(options.body),)
    gates = [Middleware(Gate, checks=(*here, *who), each=each)]
    if options.origins:
        gates = [
            Middleware(Gate, checks=here, each=each),
            Middleware(CrossOrigin, origins=options.origins),
            Middleware(Gate, checks=who),
        ]
    return [
        Middleware(Observed, options=options),
        *gates,
        Middleware(Floods, most=options.per_client),
        Middleware(Bodies, most=options.body),
    ]
