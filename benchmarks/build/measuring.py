"""Running a program and measuring it with all that it starts."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Measurement", "measure", "python"]

_PAUSE_SECONDS = 0.05


@dataclass(frozen=True, slots=True)
class Measurement:
    """Wall time and CPU in seconds, the peak of memory in megabytes, and what the program printed."""

    seconds: float
    cpu: float
    megabytes: float
    output: str


def python(*arguments: str) -> list[str]:
    """Return the command that runs this Python with `arguments`."""
    return [sys.executable, *arguments]


def measure(command: list[str]) -> Measurement:
    """Run a command to its end; SystemExit with what it said when it fails."""
    with tempfile.TemporaryFile("w+") as printed, tempfile.TemporaryFile("w+") as said:
        began = time.perf_counter()
        process = subprocess.Popen(command, stdout=printed, stderr=said, start_new_session=True)
        watch = _Watch(process.pid)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - began
        watch.stop()
        process.returncode = os.waitstatus_to_exitcode(status)
        printed.seek(0)
        said.seek(0)
        output, words = printed.read(), said.read()
    if process.returncode not in {0, 1}:
        raise SystemExit(f"{' '.join(command)} ended with {process.returncode}:\n{words}")
    return Measurement(seconds, usage.ru_utime + usage.ru_stime, watch.peak / 1e3, output)


class _Watch:
    """Looks at the memory of a process group from a thread; `peak` is in kilobytes."""

    def __init__(self, group: int) -> None:
        self.peak = 0
        self._group = group
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End the watch."""
        self._ended.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._ended.wait(_PAUSE_SECONDS):
            self.peak = max(self.peak, sum(map(_proportional_kilobytes, self._members())))

    def _members(self) -> list[Path]:
        found = []
        for folder in Path("/proc").iterdir():
            if folder.name.isdigit():
                try:
                    fields = (folder / "stat").read_text().rpartition(")")[2].split()
                except OSError:
                    continue
                if int(fields[2]) == self._group:
                    found.append(folder)
        return found


def _proportional_kilobytes(folder: Path) -> int:
    """Return what a process holds, with its share of the pages that it has in common with others; 0 when it is gone."""
    try:
        lines = (folder / "smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in lines if line.startswith("Pss:")), 0)
