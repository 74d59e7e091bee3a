"""`/robot`: a robot's capabilities, executed by hand or composed to programs (onto-ros, figure 4).

Connection and language are in `kg.server.robot`.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import msgspec
from starlette.routing import Route

from kg.errors import RobotError
from kg.resources import folder
from kg.robot.programs.parse import parse
from kg.robot.programs.units import UNITS, described
from kg.server.addresses import url
from kg.server.rendering import page
from kg.server.safety.tokens import is_trusted
from kg.server.state import state

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response


async def _robot(request: Request) -> Response:
    server = state(request)
    address = server.robot.address if server.robot else ""
    units = [{"unit": symbol, "dimension": described(unit.dimension)} for symbol, unit in UNITS.items()]
    data = {"address": address, "units": units, "examples": _examples(), "exercises": _exercises()}
    return page(
        request,
        "robot.html",
        title="Robot",
        twin=url("/api/robot"),
        data=msgspec.json.encode(data).decode(),
        address=address,
        said=f"Connecting to {address} …" if address else "No robot is connected.",
        may_move=is_trusted(request),
        has_token=server.options.token is not None or server.options.token_file is not None,
    )


@cache
def _examples() -> list[dict[str, Any]]:
    examples = []
    for path in sorted((folder("examples") / "programs").glob("**/*.kgp")):
        text = path.read_text("utf-8")
        try:
            program = parse(text)
        except RobotError:
            continue
        examples.append({"name": program.name, "comment": program.comment, "text": text})
    return examples


@cache
def _exercises() -> list[dict[str, Any]]:
    """Return the exercises of the onto-ros paper, each with its task for both robots."""
    exercises = msgspec.toml.decode((folder("examples") / "programs" / "exercises.toml").read_bytes())["exercise"]
    return [
        {
            "number": one["number"],
            "title": one["title"],
            "tasks": {robot: one[robot]["task"] for robot in ("office", "drone")},
        }
        for one in exercises
    ]


ROUTES = [Route("/robot", _robot)]
