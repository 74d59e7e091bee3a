"""Values that are read, and what was done, for people and for programs."""

from __future__ import annotations

import math
import sys
from collections import Counter
from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.cli.diagnostics import note, report, say
from kg.cli.output import json_line, terminal, write
from kg.errors import CATALOGUE, RobotError
from kg.render.text import count, printable

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kg.robot.capability import Capability
    from kg.robot.connection import GraphProblem
    from kg.robot.driving import Outcome, Plan

_LONGEST: Final = 60
_WIDEST: Final = 100
"""Columns that a line about a goal on its way may take."""
_QUATERNION: Final = {"x", "y", "z", "w"}


def tell(value: Mapping[str, Any], capability: Capability, *, json: bool) -> None:
    """Write values by parameter, as words with units on a terminal, else as a line of JSON."""
    if json or not terminal():
        sys.stdout.write(json_line(_plain(value)))
    else:
        write(_words(value, capability))
    sys.stdout.flush()


def tell_message(value: Mapping[str, Any]) -> None:
    """Write a message as a line of JSON."""
    sys.stdout.write(json_line(_plain(value)))
    sys.stdout.flush()


def warn(doubt: GraphProblem, *, json: bool) -> None:
    """Warn of what may come to nothing, and of the way out; with `json` also by a line among the data."""
    error = RobotError(doubt.code, f"{doubt.subject}: {doubt.message}")
    report(error, "warning")
    if json:
        hint = CATALOGUE[doubt.code].way_out
        told = {"event": "warning", "code": doubt.code, "name": doubt.subject, "message": doubt.message, "hint": hint}
        sys.stdout.write(json_line(told))
        sys.stdout.flush()


def tell_feedback(value: Mapping[str, Any], capability: Capability, *, json: bool) -> None:
    """Tell how far a goal is: all of it as a line of data with `json`, else as a short line of words."""
    if json:
        tell({"feedback": value}, capability, json=True)
    elif words := _words(value, capability):
        say(words if len(words) <= _WIDEST else f"{words[: _WIDEST - 3]}...")


def show_outcome(outcome: Outcome, capability: Capability, *, json: bool) -> None:
    """Write how something ended, and what came of it."""
    if json or not terminal():
        found = {"ended": outcome.ended, "sent": outcome.sent, "values": outcome.values}
        if outcome.moved is not None:
            found["moved"] = outcome.moved
        sys.stdout.write(json_line(_plain(found)))
        return
    if outcome.values:
        write(_words(outcome.values, capability))
    plan = outcome.plan
    if plan.kind == "topic":
        after = ", then a zero command" if plan.afterwards is not None else ""
        note(f"sent {count(outcome.sent, 'message')} to {plan.name}{after}")
    else:
        note(f"{plan.name} is {outcome.ended}")


def show_plan(plan: Plan, *, json: bool) -> None:
    """Write what would be sent where."""
    if json or not terminal():
        sys.stdout.write(json_line(_plain(msgspec.to_builtins(plan))))
        return
    often = f" {plan.rate:g} times a second" if plan.rate else ""
    time = f" for {plan.seconds:g} s" if plan.rate and plan.seconds else ""
    note(f"{plan.capability} would send to the {plan.kind} {plan.name} of {plan.node}{often}{time}:")
    for line in _lines({plan.type: plan.message}):
        write(printable(line))
    if plan.afterwards is not None:
        note("then the same with zeros, to stop")


def _lines(value: Mapping[str, Any], depth: int = 0) -> list[str]:
    found = []
    for name, one in value.items():
        if isinstance(one, dict):
            found += [f"{'  ' * depth}{name}:", *_lines(one, depth + 1)]
        else:
            found.append(f"{'  ' * depth}{name}: {_short(one)}")
    return found


def _words(value: Mapping[str, Any], capability: Capability) -> str:
    units = {one.name: one.unit for one in capability.parameters}
    leaves = dict(_leaves(value))
    shared = Counter(ending for name in leaves for ending in _endings(name))
    short = {next((one for one in _endings(name) if shared[one] == 1), name): told for name, told in leaves.items()}
    parts = [f"{name} {_short(one):>8}{_unit(one, units.get(name))}" for name, one in short.items()]
    return printable("   ".join(parts)).rstrip()


def _endings(path: str) -> Iterator[str]:
    """Yield what a path ends with, the shortest first: `c`, `b.c`, `a.b.c`."""
    steps = path.split(".")
    return (".".join(steps[-length:]) for length in range(1, len(steps) + 1))


def _leaves(value: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the fields of a message that have none of their own, by their paths, but for headers and quaternions."""
    for name, one in value.items():
        if not isinstance(one, dict):
            yield before + name, one
        elif name != "header" and set(one) != _QUATERNION:
            yield from _leaves(one, f"{before}{name}.")


def _unit(value: Any, unit: str | None) -> str:
    return f" {unit}" if unit and isinstance(value, int | float) else ""


def _short(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return "free" if math.isinf(value) else f"{value:.3f}"
    text = f"{len(value)} bytes" if isinstance(value, bytes) else str(value)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


def _plain(value: Any) -> Any:
    """Return a value as JSON has it: null for what is not finite, the number of bytes for bytes."""
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, bytes):
        return f"{len(value)} bytes"
    return None if isinstance(value, float) and not math.isfinite(value) else value
