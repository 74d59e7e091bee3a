"""What the routes of one server share; it hangs on the application as `app.state.server`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from starlette.requests import Request

    from kg.pipeline.updating.writer import Writer
    from kg.query.readers.pool import Readers
    from kg.server.options import Options
    from kg.server.protocol_question import Asked
    from kg.server.robot.session import Session
    from kg.settings import Settings


@dataclass(slots=True)
class State:
    """The readers, the settings and the options of a running server.

    `writer` is there where the store may be changed, `robot` where one was named.
    """

    settings: Settings
    options: Options
    readers: Readers
    writer: Writer | None = None
    robot: Session | None = None
    asked: dict[tuple[object, ...], Asked | None] = field(default_factory=dict)
    """Requests for queries that were read before, by what they are read from."""


def state(request: Request) -> State:
    """Return what the server of a request shares."""
    found: State = request.scope["app"].state.server
    return found
