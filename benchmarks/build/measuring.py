"""Running a program and measuring it with all that it starts."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Measurement", "measure", "python"]

_PAUSE_SECONDS = 0.05
_WATCHING_SHARE = 10
"""Looking at the processes may take a tenth of the time at most."""
_TICKS = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True, slots=True)
class Measurement:
    """Wall time and CPU in seconds, the peak of memory of all processes in megabytes, and what the program printed.

    `words` is what it printed on standard error, `code` its exit code (negative: the signal that ended it).
    """

    seconds: float
    cpu: float
    megabytes: float
    output: str
    words: str = ""
    code: int = 0


def python(*arguments: str) -> list[str]:
    """Return the command that runs this Python with `arguments`."""
    return [sys.executable, *arguments]


def measure(command: list[str], *, kill_after: float | None = None) -> Measurement:
    """Run a command to its end, or kill it and all that it started after `kill_after` seconds.

    Raises:
        SystemExit: it failed, with what it printed on standard error.
    """
    with tempfile.TemporaryFile("w+") as printed, tempfile.TemporaryFile("w+") as said:
        began = time.perf_counter()
        process = subprocess.Popen(command, stdout=printed, stderr=said, start_new_session=True)
        killer = threading.Timer(kill_after or 0, os.killpg, (process.pid, signal.SIGKILL))
        if kill_after is not None:
            killer.start()
        watch = _Watch(process.pid)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - began
        killer.cancel()
        watch.stop()
        code = process.returncode = os.waitstatus_to_exitcode(status)
        printed.seek(0)
        said.seek(0)
        output, words = printed.read(), said.read()
    if code not in {0, 1} and (kill_after is None or code != -signal.SIGKILL):
        raise SystemExit(f"{' '.join(command)} ended with {code}:\n{words}")
    # Children that nobody waited for are missing from the usage, short ones from what the watch saw.
    cpu = max(usage.ru_utime + usage.ru_stime, watch.cpu)
    return Measurement(seconds, cpu, watch.peak / 1e3, output, words, code)


class _Watch:
    """Looks at a process group from a thread; `peak` is the memory of all its processes in kilobytes."""

    def __init__(self, group: int) -> None:
        self.peak = 0
        self._group = group
        self._spent: dict[int, float] = {}
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    @property
    def cpu(self) -> float:
        """The processor seconds of all processes, as seen last."""
        return sum(self._spent.values())

    def stop(self) -> None:
        """End the watch."""
        self._ended.set()
        self._thread.join()

    def _run(self) -> None:
        pause = _PAUSE_SECONDS
        while not self._ended.wait(pause):
            began = time.perf_counter()
            self.peak = max(self.peak, sum(map(_proportional_kilobytes, self._members())))
            pause = max(_PAUSE_SECONDS, _WATCHING_SHARE * (time.perf_counter() - began))

    def _members(self) -> list[Path]:
        found = []
        for folder in Path("/proc").iterdir():
            if folder.name.isdigit():
                try:
                    fields = (folder / "stat").read_text().rpartition(")")[2].split()
                except OSError:
                    continue
                if int(fields[2]) == self._group:
                    self._spent[int(folder.name)] = (int(fields[11]) + int(fields[12])) / _TICKS
                    found.append(folder)
        return found


def _proportional_kilobytes(folder: Path) -> int:
    """Return what a process holds, with its share of the pages that it has in common with others; 0 when it is gone."""
    try:
        lines = (folder / "smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in lines if line.startswith("Pss:")), 0)
