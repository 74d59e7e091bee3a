"""Checking of programs for the page: conversion between blocks and text, and problems with their places."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import msgspec

from kg.errors import CATALOGUE, RobotError
from kg.robot.programs.check import check, doubts
from kg.robot.programs.events import Problem, place_at
from kg.robot.programs.parse import parse_with_places
from kg.robot.programs.places import Places, placed
from kg.robot.programs.tree import Program
from kg.robot.programs.write import write
from kg.server.addresses import url
from kg.server.errors import RequestError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.capability import Capabilities
    from kg.robot.connection import ComputationGraph

LONGEST: Final = 1 << 18
"""Maximum size in bytes of a program, as text or as JSON."""


_COMMANDS: Final = re.compile(r"`(kg|rosnode|ros2) |`-")
_HINTS: Final = {
    "": "The list “What it can do” shows what this robot has now.",
    "KG811": "Check on the robot whether the node runs.",
    "KG819": "Activate the node on the robot.",
    "KG820": "Start a drone first (“take off”). Switch the motors on, and check the robot.",
    "KG829": "Stop the other node.",
    "KG836": "Give the place a name: click into the picture from above, or use “set” from the blocks of places.",
}
"""The page's replacement for hints about commands, by code."""


class Robot(NamedTuple):
    """The context that programs are checked in: named places, the computation graph and the capabilities."""

    capabilities: Capabilities
    places: Places
    graph: ComputationGraph


def judged(program: Program | None, text: str | None, robot: Robot | None) -> dict[str, Any]:
    """Return a program as tree and as text, its problems, and the lines of its statements by their identities.

    Without a robot it is only parsed. A text that does not parse gives no program, and one problem with its place.

    Raises:
        RequestError: KG520 both or neither are given, or the tree is too deep to process.
        RobotError: KG830 the tree is too deep for a text.
    """
    if (program is None) == (text is None):
        raise RequestError("KG520", "the body needs either `program` or `text`")
    try:
        return _judged(program, text or "", robot)
    except RecursionError as error:
        raise RequestError("KG520", "the program is nested too deeply") from error


def _judged(program: Program | None, text: str, robot: Robot | None) -> dict[str, Any]:
    written = program is None
    if program is None:
        try:
            program = parse_with_places(text).program
        except RobotError as error:
            unreadable = problem_object(Problem.of(error, "", None))
            place = {"line": error.place and error.place.line, "column": error.place and error.place.column}
            return {"program": None, "text": text, "lines": {}, "problems": [unreadable | place]}
    program, identities = identified(program)
    shown = text if written else write(program)
    places = parse_with_places(shown).places
    problems: list[Problem] = []
    if robot is not None:
        bound = placed(program, robot.places)
        problems = [*check(bound, robot.capabilities, robot.places), *doubts(bound, robot.capabilities, robot.graph)]
    return {
        "program": msgspec.to_builtins(program),
        "text": shown,
        "lines": {identity: places[path][0] for path, identity in identities.items() if path in places},
        "problems": [{**problem_object(one), "line": place_at("", shown, places, one.path).line} for one in problems],
    }


def problem_object(problem: Problem) -> dict[str, Any]:
    """Return a problem in the format of the page."""
    return {
        "id": problem.id,
        "code": problem.code,
        "docs": url(f"/errors/{problem.code}"),
        "severity": problem.severity,
        "message": problem.message,
        "hint": hint_of(problem.code, problem.hint),
    }


def hint_of(code: str, hint: str | None) -> str:
    """Return a hint in the words of the page; hints with commands or options are replaced."""
    text = hint or CATALOGUE[code].way_out
    return _HINTS.get(code, _HINTS[""]) if _COMMANDS.search(text) else text


def identified(program: Program) -> tuple[Program, dict[str, str]]:
    """Return a program whose statements have unique identities, and the statements' paths by identity."""
    tree = msgspec.to_builtins(program)
    identities: dict[str, str] = {}
    taken: set[str] = set()
    for path, statement in _statements(tree, ""):
        identity = statement.get("id") or ""
        if not identity or identity in taken:
            identity = f"at {path}"
            statement["id"] = identity
        taken.add(identity)
        identities[path] = identity
    return msgspec.convert(tree, Program), identities


def _statements(part: Any, path: str) -> Iterator[tuple[str, dict[str, Any]]]:
    if isinstance(part, dict):
        if "block" in part:
            yield path, part
        for key, value in part.items():
            yield from _statements(value, f"{path}/{key}")
    elif isinstance(part, list | tuple):
        for index, value in enumerate(part):
            yield from _statements(value, f"{path}/{index}")
