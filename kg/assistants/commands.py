"""Commands of `kg` run for an assistant, each in a process of its own that ends with the call."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
import tempfile
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

_GRACE: Final = 5.0  # seconds that a command has to end by itself, so that a robot that it drives is stopped


async def run_command(*arguments: str, seconds: float) -> tuple[int, str]:
    """Run `kg` with these arguments; return the exit code, and what it wrote on both outputs.

    After `seconds`, or when the call is cancelled, it is interrupted as by Ctrl-C; TimeoutError after `seconds`.
    """
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "kg", *arguments),
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.STDOUT,
        env=os.environ | {"KG_COLOR": "never"},
    )
    try:
        written, _ = await asyncio.wait_for(process.communicate(), seconds)
    finally:
        if process.returncode is None:
            with suppress(ProcessLookupError):
                process.send_signal(signal.SIGINT)
                try:
                    await asyncio.wait_for(process.communicate(), _GRACE)
                except TimeoutError:
                    process.kill()
    return process.returncode or 0, written.decode(errors="replace")


@contextmanager
def program_file(text: str) -> Iterator[tuple[str, str]]:
    """Yield a folder, with a slash at its end, and in it a file with the text of a program; both last as the block."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "program.kgp"
        path.write_text(text, encoding="utf-8")
        yield f"{folder}/", str(path)
