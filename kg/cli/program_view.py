"""Programs for robots on the command line: their problems, and their progress line by line."""

from __future__ import annotations

import json as as_json
import sys
from collections.abc import Sequence
from typing import Any

import typer

from kg.cli.diagnostics import colored, dim, report
from kg.cli.output import json_lines, json_value, write
from kg.errors import Exit, Place, RobotError
from kg.render.text import count, printable
from kg.robot.programs.events import Problem
from kg.robot.programs.files import Loaded, load
from kg.robot.programs.tree import statements
from kg.robot.programs.write import headline


def read(path: str, *, json: bool) -> Loaded:
    """Return the program in a file; with `json`, a syntax error is written like any other problem.

    Raises:
        typer.Exit: with `json`, the file is not a program.
        KGError: those of `load`.
    """
    try:
        return load(path)
    except RobotError as error:
        if not json:
            raise
        problem = Problem.of(error, "", None)
        json_lines([_problem_object(problem, path, error.place or Place(path))])
        raise typer.Exit(Exit.FOUND) from error


def error_at(problem: Problem, loaded: Loaded) -> RobotError:
    """Return a problem as an error at its place in the file."""
    return RobotError(problem.code, problem.message, place=loaded.place(problem.path), hint=problem.hint)


def show_problems(problems: Sequence[Problem], loaded: Loaded, *, json: bool) -> None:
    """Write problems of a program: as text on standard error, or one object each on standard output."""
    if json:
        json_lines(_problem_object(problem, loaded.path, loaded.place(problem.path)) for problem in problems)
        return
    for problem in problems:
        report(error_at(problem, loaded), problem.severity)


def _problem_object(problem: Problem, file: str, place: Place) -> dict[str, Any]:
    return {
        "severity": problem.severity,
        "code": problem.code,
        "message": problem.message,
        "hint": problem.hint,
        "id": problem.id,
        "path": problem.path,
        "file": file,
        "line": place.line,
        "column": place.column,
    }


class Log:
    """Writes the events of a program: lines with the time, or objects."""

    def __init__(self, loaded: Loaded, *, json: bool) -> None:
        """Index the statements by their paths."""
        self._loaded = loaded
        self._json = json
        self._heads = {path: headline(one) for path, one in statements(loaded.program.body)}
        self._color = colored(sys.stdout)

    def __call__(self, event: dict[str, Any]) -> None:
        """Write an event."""
        if self._json:
            json_lines([json_value(event)])
        else:
            text = self._words(event)
            if text is not None:
                time = dim(f"{event['at']:9.3f} s", color=self._color)
                write(f"{time}  {printable(text)}")
        sys.stdout.flush()

    def _words(self, event: dict[str, Any]) -> str | None:
        path = event.get("path", "")
        match event["event"]:
            case "enter":
                line = self._loaded.place(path).line
                return f"{line or path}: {self._heads[path]}"
            case "value":
                value = event["value"] if not isinstance(event["value"], float) else f"{event['value']:.4g}"
                return f"  {event['parameter']} of {event['capability']} = {value} {event.get('unit', '')}".rstrip()
            case "set":
                return f"  {event['variable']} = {event['shown']}"
            case "log":
                return f"  {event['message']}"
            case "warning":
                return f"  warning[{event['code']}]: {event['message']}"
            case "event":
                return f"  it happened: {self._heads[path]}"
            case "planned":
                value = as_json.dumps(json_value(event["value"]))
                return f"  would send to {event['kind']} {event['name']} ({event['type']}): {value}"
            case "paused" | "resumed":
                return str(event["event"])
            case "done" | "stopped" | "failed" | "cancelled":
                return f"{event['event']} after {count(event['statements'], 'statement')}"
        return None
