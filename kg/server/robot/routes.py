"""`/api/robot`, `/robot/...`: the pages' requests about the robot. Moving it needs the token (`kg.server.safety`).

Stopping does not: every viewer may stop it.
"""

from __future__ import annotations

import asyncio
import json
from functools import partial
from typing import TYPE_CHECKING, Any, Final, Literal, TypeVar

import msgspec
from starlette.responses import Response, StreamingResponse

from kg.errors import Place, RobotError
from kg.robot.programs.converting import convert
from kg.robot.programs.places import placed
from kg.robot.programs.tree import Program
from kg.robot.programs.trees import behavior_tree, program_of
from kg.server.errors import RequestError
from kg.server.methods import route
from kg.server.parameters import media_type, unsupported
from kg.server.robot.judging import LONGEST, Robot, judged
from kg.server.safety.tokens import is_trusted
from kg.server.state import state

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from starlette.requests import Request
    from starlette.types import Receive, Scope, Send

    from kg.server.robot.session import Session

_Body = TypeVar("_Body")
_PICTURE: Final = "default-src 'none'; style-src 'unsafe-inline'; sandbox; frame-ancestors 'none'"
"""Content-Security-Policy of a picture from the robot: inline styles only, no scripts, no requests."""


class _Given(msgspec.Struct, forbid_unknown_fields=True):
    program: Program | None = None
    text: str | None = None


class _Convert(msgspec.Struct, forbid_unknown_fields=True):
    program: Program | None = None
    bt: str | None = None
    to: Literal["text", "rospy", "rclpy", "bt"] = "text"


class _Here(msgspec.Struct, forbid_unknown_fields=True):
    listener: str


class _Read(msgspec.Struct, forbid_unknown_fields=True):
    listener: str
    capabilities: list[str]


class _Do(msgspec.Struct, forbid_unknown_fields=True):
    listener: str
    capability: str
    arguments: dict[str, bool | float | str] = {}
    seconds: float | None = None


async def _read(request: Request, kind: type[_Body]) -> _Body:
    """Return the decoded body of a request; KG520 if it is invalid, KG524 if it is not JSON."""
    if media_type(request) != "application/json":
        raise unsupported(media_type(request), "application/json")
    body = await request.body()
    if len(body) > LONGEST:
        raise RequestError("KG525", f"the body is longer than {LONGEST} bytes")
    try:
        return msgspec.json.decode(body, type=kind)
    except msgspec.MsgspecError as error:
        raise RequestError("KG520", f"invalid request body: {error}") from error
    except RecursionError as error:
        raise RequestError("KG520", "the program is nested too deeply") from error


def _session(request: Request) -> Session:
    session = state(request).robot
    if session is None:
        raise RobotError("KG845", "this server has no robot")
    return session


def _json(content: object) -> Response:
    body = msgspec.json.encode(content)
    return Response(body, media_type="application/json", headers={"Cache-Control": "no-store"})


async def _robot(request: Request) -> Response:
    session = state(request).robot
    if session is None:
        return _json({"address": None, "state": "none", "may_move": False, "capabilities": []})
    return _json({**session.status(), "may_move": is_trusted(request)})


async def _events(request: Request) -> Response:
    return _Events(_session(request))


class _Events(StreamingResponse):
    """The events of a page, which is removed when its client disconnects, even before the first event."""

    def __init__(self, session: Session) -> None:
        super().__init__(self._stream(), media_type="text/event-stream", headers={"Cache-Control": "no-store"})
        self._session = session
        self._listener = session.listen()

    async def _stream(self) -> AsyncIterator[bytes]:
        """Yield server-sent events (HTML Standard, section 9.2)."""
        async for event in self._listener.events():
            yield b": still here\n\n" if event is None else b"data: " + json.dumps(event).encode() + b"\n\n"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send events until the stream ends or the client disconnects."""
        try:
            await super().__call__(scope, receive, send)
        finally:
            await self._session.gone(self._listener)


async def _view(request: Request) -> Response:
    """Respond with the robot's view from above. Its publisher is untrusted, hence the policy of its own."""
    picture = await _session(request).view()
    headers = {"Cache-Control": "no-store", "Content-Security-Policy": _PICTURE}
    return Response(picture, media_type="image/svg+xml", headers=headers)


async def _judged(session: Session | None, program: Program | None, text: str | None = None) -> dict[str, Any]:
    """Check a program in a thread, since the event loop may be repeating a velocity at the same time."""
    return await asyncio.to_thread(judged, program, text, session.robot if session else None)


async def _why(request: Request) -> Response:
    session = _session(request)
    name = request.query_params.get("capability", "")
    if not name:
        raise RequestError("KG520", "the parameter `capability` is missing")
    return _json(await session.why(name))


async def _check(request: Request) -> Response:
    sent = await _read(request, _Given)
    return _json(await _judged(state(request).robot, sent.program, sent.text))


async def _convert(request: Request) -> Response:
    sent = await _read(request, _Convert)
    if (sent.program is None) == (sent.bt is None):
        raise RequestError("KG520", "the body needs either `program` or `bt`")
    robot = None if sent.to == "text" and sent.bt is None else _connected(request)
    program = sent.program
    if program is None and robot is not None:
        program = await asyncio.to_thread(program_of, sent.bt or "", robot.capabilities)
    checked = await _judged(None, program)
    if sent.to == "text" or robot is None or program is None:
        return _json({"text": checked["text"]})
    make = behavior_tree if sent.to == "bt" else partial(convert, to=sent.to)
    return _json({"text": await asyncio.to_thread(make, placed(program, robot.places), robot.capabilities)})


def _connected(request: Request) -> Robot:
    """Return the robot; RobotError KG846 without a connection."""
    robot = _session(request).robot
    if robot is None:
        raise RobotError("KG846", "no robot is connected, so its capabilities are unknown")
    return robot


async def _run(request: Request) -> Response:
    session = _session(request)
    sent = await _read(request, _Given)
    checked = await _judged(session, sent.program, sent.text)
    for problem in checked["problems"]:
        if problem["severity"] == "error":
            place = None if sent.text is None else _place(sent.text, problem)
            raise RobotError(problem["code"], problem["message"], place=place, hint=problem["hint"])
    await session.run(sent.program or msgspec.convert(checked["program"], Program))
    return Response(status_code=204)


def _place(text: str, problem: dict[str, Any]) -> Place:
    lines = text.split("\n")
    line = problem["line"] or 1
    written = lines[line - 1] if line <= len(lines) else ""
    first = len(written) - len(written.lstrip()) + 1
    return Place("text", line, problem.get("column") or first, written)


def _posted(
    kind: type[msgspec.Struct], act: Callable[[Session], Callable[..., None]]
) -> Callable[[Request], Awaitable[Response]]:
    """Return the endpoint that calls a method of the session with the members of a body of that kind."""

    async def endpoint(request: Request) -> Response:
        session = _session(request)
        act(session)(*msgspec.structs.astuple(await _read(request, kind)))
        return Response(status_code=204)

    return endpoint


def _simply(act: Callable[[Session], Awaitable[Any]]) -> Callable[[Request], Awaitable[Response]]:
    async def endpoint(request: Request) -> Response:
        await act(_session(request))
        return Response(status_code=204)

    return endpoint


ROUTES = [
    route("/api/robot", GET=_robot),
    route("/robot/events", GET=_events),
    route("/robot/view", GET=_view),
    route("/robot/why", GET=_why),
    route("/robot/check", POST=_check),
    route("/robot/convert", POST=_convert),
    route("/robot/run", POST=_run),
    route("/robot/pause", POST=_simply(lambda session: session.pause())),
    route("/robot/resume", POST=_simply(lambda session: session.resume())),
    route("/robot/stop", POST=_simply(lambda session: session.stop())),
    route("/robot/do", POST=_posted(_Do, lambda session: session.do)),
    route("/robot/read", POST=_posted(_Read, lambda session: session.follow)),
    route("/robot/here", POST=_posted(_Here, lambda session: session.here)),
]
