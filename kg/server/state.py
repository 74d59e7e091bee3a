"""State shared by the routes of one server, stored as `app.state.server`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from starlette.requests import Request

    from kg.pipeline.updating.writer import Writer
    from kg.query.readers.pool import Readers
    from kg.server.options import Options
    from kg.server.protocol_question import QueryRequest
    from kg.server.robot.session import Session
    from kg.settings import Settings


@dataclass(slots=True)
class State:
    """The readers, settings and options of a running server.

    `writer` is set if the store may be changed, `robot` if one was named.
    """

    settings: Settings
    options: Options
    readers: Readers
    writer: Writer | None = None
    robot: Session | None = None
    parsed: dict[tuple[object, ...], QueryRequest | None] = field(default_factory=dict)
    """Parsed query requests by the text that they were parsed from."""


def state(request: Request) -> State:
    """Return the shared state of a request's server."""
    shared: State = request.scope["app"].state.server
    return shared
