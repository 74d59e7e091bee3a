"""Transcripts in the documentation: run the commands of ```console blocks and insert their output.

A command is a line that starts with `$ `; its continuation lines start with `> `. All commands of a page run in one
folder, one after the other, on a terminal without colours. Standard error comes last. A line `...` replaces omitted
lines.
"""

from __future__ import annotations

import os
import pty
import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["commands", "masked", "refreshed"]

PROGRAMS = Path(sys.executable).parent
"""The folder with the program `kg` that runs; tests have another one."""

_BLOCK: Final = re.compile(r"(?P<open>^```console\n)(?P<body>.*?)(?P<close>^```$)", re.MULTILINE | re.DOTALL)
_PROMPT: Final = "$ "
_MORE: Final = "> "
_LEFT_OUT: Final = "..."
_VARIES: Final = re.compile(r"\b\d+(?:\.\d+)? ?(?=m?s\b)|\b\d+\.\d{4}\b|\b\d+(?=%)|(?<=\bat )[0-9a-f]{12}\b")
"""Durations in sentences and in columns, shares of them, and the commit of the examples, which every edit changes."""
_SECONDS: Final = 120
_DEFECT: Final = "error[KG900]"
"""The error of a defect in `kg`, which no page may show."""
_CONTROL: Final = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]|\x1b\]8;[^\x1b]*\x1b\\")
"""Terminal codes for font weights and links."""
_CHUNK_BYTES: Final = 65536
_ROOT: Final = str(Path(__file__).resolve().parent.parent)
_SHOWN_ROOT: Final = "~/kg"
"""The name of the folder of this checkout in the documentation."""


def commands(text: str) -> list[str]:
    """Return the commands of a page, in order."""
    return [command for block in _BLOCK.finditer(text) for command, _ in _entries(block["body"])]


def masked(text: str) -> str:
    """Mask what differs between runs: durations, the commit of the examples."""
    return _VARIES.sub("# ", text)


def refreshed(text: str, folder: Path) -> str:
    """Return the page with the current output of its commands, run in `folder`."""

    def block(found: re.Match[str]) -> str:
        parts = [_shown(command, shown, run(command, folder)) for command, shown in _entries(found["body"])]
        return found["open"] + "".join(parts) + found["close"]

    return _BLOCK.sub(block, text)


def run(command: str, folder: Path) -> str:
    """Run a shell command as a reader with `kg` on the path would, and return its output.

    Raises RuntimeError if that is a defect in `kg` (KG900).
    """
    terminal, other_end = pty.openpty()
    surroundings = {name: value for name, value in os.environ.items() if not name.startswith("KG_")}
    search = f"{PROGRAMS}{os.pathsep}{os.environ['PATH']}"
    with subprocess.Popen(
        ["bash", "-c", command],  # noqa: S607 - the shell of whoever reads the page
        cwd=folder,
        env={**surroundings, "PATH": search, "HOME": str(folder), "TERM": "xterm", "NO_COLOR": "1", "COLUMNS": "120"},
        stdin=subprocess.DEVNULL,
        stdout=other_end,
        stderr=subprocess.PIPE,
    ) as process:
        os.close(other_end)
        shown = b"".join(_read(terminal))
        words = process.communicate(timeout=_SECONDS)[1]
    os.close(terminal)
    text = _CONTROL.sub("", (shown + words).decode())
    if _DEFECT in text:
        raise RuntimeError(f"a page would show a defect; `{command}` printed:\n{text}")
    return text.replace("\r\n", "\n").replace(f"{_ROOT}/", "").replace(_ROOT, _SHOWN_ROOT)


def _read(terminal: int) -> Iterator[bytes]:
    while True:
        try:
            chunk = os.read(terminal, _CHUNK_BYTES)
        except OSError:  # Linux answers so when the other end is closed
            return
        if not chunk:
            return
        yield chunk


def _entries(body: str) -> Iterator[tuple[str, list[str]]]:
    command, shown = "", list[str]()
    for line in body.splitlines():
        if line.startswith(_PROMPT):
            if command:
                yield command, shown
            command, shown = line.removeprefix(_PROMPT), []
        elif line.startswith(_MORE) and not shown:
            command += "\n" + line.removeprefix(_MORE)
        else:
            shown.append(line)
    if command:
        yield command, shown


def _shown(command: str, before: list[str], printed: str) -> str:
    """Lay out a command with its output, shortened as on the page."""
    lines = [line.rstrip() for line in printed.rstrip("\n").splitlines()]
    if _LEFT_OUT in before:
        cut = before.index(_LEFT_OUT)
        after = len(before) - cut - 1
        if len(lines) > cut + after:
            lines = [*lines[:cut], _LEFT_OUT, *lines[len(lines) - after :]]
    return "\n".join([_PROMPT + command.replace("\n", "\n" + _MORE), *lines]) + "\n"
