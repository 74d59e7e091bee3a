"""Errors, warnings and notes on standard error. No other module of the command line writes there.

An error has its code and message, the place, the source line with carets under the column, and a hint:

    error[KG501]: expected a variable
     --> query.rq:3:8
      |
    3 | SELECT WHERE { ?s ?p ?o }
      |        ^^^^^
    help: Correct the text at the marked place, or before it.
"""

from __future__ import annotations

import os
import sys
import traceback
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Final

from kg.errors import CATALOGUE, KgError, Place
from kg.render.text import marked, printable

REPORT_ADDRESS: Final = "the issue tracker named on the project's page"
_STYLES: Final = {"error": "1;31", "warning": "1;33", "note": "1;36", "help": "1;32", "dim": "2", "bold": "1"}


@dataclass(frozen=True, slots=True)
class Mode:
    """Output settings of this run: `color`, and whether errors include Python's traceback."""

    color: str = "auto"
    traceback: bool = False


_AT_FIRST: Final = Mode(os.environ.get("KG_COLOR", "auto"), bool(os.environ.get("KG_DEBUG")))
MODE: ContextVar[Mode] = ContextVar("MODE", default=_AT_FIRST)


def colored(stream: IO[str]) -> bool:
    """Return whether to colour output to `stream` (https://no-color.org)."""
    color = MODE.get().color
    if color == "auto":
        return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
    return color == "always"


def _paint(style: str, text: str, *, on: bool) -> str:
    return f"\x1b[{_STYLES[style]}m{text}\x1b[0m" if on else text


def dim(text: str, *, color: bool) -> str:
    """Return dimmed text."""
    return _paint("dim", text, on=color)


def say(text: str = "") -> None:
    """Write a line, after flushing standard output."""
    sys.stdout.flush()
    sys.stderr.write(text + "\n")
    sys.stderr.flush()


def note(text: str) -> None:
    """Report something about the result, such as truncation or a choice made."""
    say(f"{_paint('note', 'note', on=colored(sys.stderr))}: {text}")


def problem(code: str, message: str, place: str) -> None:
    """Report a problem of a source on one line."""
    on = colored(sys.stderr)
    say(f"{printable(place)}: {_paint('warning', code, on=on)} {printable(message)}")


def report(error: KgError, severity: str = "error") -> None:
    """Report an error, or as a `warning` something the command can do without."""
    if MODE.get().traceback:
        say("".join(traceback.format_exception(error)).rstrip())
    say(render(error, color=colored(sys.stderr), severity=severity))


def defect(error: BaseException) -> None:
    """Report an unexpected exception as KG900."""
    tail = traceback.extract_tb(error.__traceback__)[-1:]
    where = f" ({Path(tail[0].filename).name}:{tail[0].lineno})" if tail else ""
    first_line = str(error).partition("\n")[0]
    hint = f"Please report it to {REPORT_ADDRESS}, with the command and its output with KG_DEBUG=1."
    wrapped = KgError("KG900", f"{type(error).__name__}: {first_line}{where}", hint=hint)
    wrapped.__cause__ = error
    report(wrapped)


def render(error: KgError, *, color: bool = False, severity: str = "error") -> str:
    """Return the lines of an error, or of a finding of lower severity (`warning`, `note`)."""
    help_text = error.hint or CATALOGUE[error.code].way_out
    return "\n".join(
        [
            head(severity, error.code, error.message, color=color),
            *(excerpt(error.place, color=color) if error.place else ()),
            *helps(help_text, color=color),
        ]
    )


def head(severity: str, code: str, message: str, *, color: bool) -> str:
    """Return the line with code and message."""
    return (
        _paint(severity if severity in _STYLES else "note", f"{severity}[{code}]", on=color) + ": " + printable(message)
    )


def helps(text: str, *, color: bool) -> list[str]:
    """Return the lines with hints."""
    return [f"{_paint('help', 'help', on=color)}: {printable(line)}" for line in text.splitlines()]


def linked(text: str, address: str | None, *, color: bool) -> str:
    """Return printable text with a terminal link to `address` (OSC 8)."""
    shown = printable(text)
    return f"\x1b]8;;{address}\x1b\\{shown}\x1b]8;;\x1b\\" if address and color else shown


def excerpt(place: Place, *, color: bool, address: str | None = None) -> list[str]:
    """Return the lines of a place: its name, linked to `address`, and the source line."""
    line = _line(place)
    number = str(place.line or "")
    gutter = " " * len(number)
    arrow = _paint("dim", "-->", on=color)
    lines = [f"{gutter} {arrow} {linked(str(place), address, color=color)}"]
    if line is None or not line.strip():
        return lines
    bar = _paint("dim", "|", on=color)
    shown, carets = marked(place, line)
    lines += [f"{gutter} {bar}", f"{_paint('dim', number, on=color)} {bar} {shown}"]
    if carets:
        lines.append(f"{gutter} {bar} {_paint('error', carets, on=color)}")
    return lines


def _line(place: Place) -> str | None:
    """Return the source line at `place`, if it can be read."""
    if place.excerpt is not None or place.line is None:
        return place.excerpt
    try:
        with Path(place.path).open(encoding="utf-8", errors="replace") as file:
            return next((line.rstrip("\n") for number, line in enumerate(file, 1) if number == place.line), None)
    except (OSError, ValueError):
        return None
