"""Sessions shown in the documentation: the commands of ```console blocks are run, their output is put below them.

A command is a line that starts with `$ `, and what follows it with `> `. All commands of a page run in one folder, one
after the other, on a terminal without colours, as a reader would see them; what goes to standard error comes last. A
line `...` stands for lines that are left out.
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

_BLOCK: Final = re.compile(r"(?P<open>^```console\n)(?P<body>.*?)(?P<close>^```$)", re.MULTILINE | re.DOTALL)
_PROMPT: Final = "$ "
_MORE: Final = "> "
_LEFT_OUT: Final = "..."
_VARIES: Final = re.compile(r"\b\d+(?:\.\d+)? ?(?=m?s\b)|\b\d+\.\d{4}\b|\b\d+(?=%)|(?<=\bat )[0-9a-f]{12}\b")
"""Durations in sentences and in columns, shares of them, and the commit of the examples: any edit there changes it."""
_SECONDS: Final = 120
_DEFECT: Final = "error[KG900]"
"""What `kg` says of a defect in itself: no page shows that as an example."""
_CONTROL: Final = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]|\x1b\]8;[^\x1b]*\x1b\\")
"""Weights of letters, and links behind them."""
_CHUNK_BYTES: Final = 65536
_ROOT: Final = str(Path(__file__).resolve().parent.parent)
_SHOWN_ROOT: Final = "~/kg"
"""What the folder of this checkout is called in the documentation."""


def commands(text: str) -> list[str]:
    """Return the commands of a page in order."""
    return [command for block in _BLOCK.finditer(text) for command, _ in _entries(block["body"])]


def masked(text: str) -> str:
    """Return the text without what differs from run to run: durations, the commit of the examples."""
    return _VARIES.sub("# ", text)


def refreshed(text: str, folder: Path) -> str:
    """Return the page with the output that its commands have now; they run in `folder`."""

    def block(found: re.Match[str]) -> str:
        parts = [_shown(command, shown, run(command, folder)) for command, shown in _entries(found["body"])]
        return found["open"] + "".join(parts) + found["close"]

    return _BLOCK.sub(block, text)


def run(command: str, folder: Path) -> str:
    """Run a line of a shell as a reader with `kg` on the path would, and return what it prints.

    Raises RuntimeError where that is a defect in `kg` (KG900).
    """
    terminal, other_end = pty.openpty()
    surroundings = {name: value for name, value in os.environ.items() if not name.startswith("KG_")}
    search = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
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
    """Lay out a command with its output, shortened where the page shortened it."""
    lines = [line.rstrip() for line in printed.rstrip("\n").splitlines()]
    if _LEFT_OUT in before:
        cut = before.index(_LEFT_OUT)
        after = len(before) - cut - 1
        if len(lines) > cut + after:
            lines = [*lines[:cut], _LEFT_OUT, *lines[len(lines) - after :]]
    return "\n".join([_PROMPT + command.replace("\n", "\n" + _MORE), *lines]) + "\n"
