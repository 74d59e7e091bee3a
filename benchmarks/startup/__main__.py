"""Measures how long commands that do nothing yet take to start, which imports take it, and what a small build costs.

    python benchmarks/startup [--repeat 20] [--demos 5]

Times are in milliseconds. Wall clock and CPU (user and system, of the process and what it started) are given as the
smallest of the repetitions, since whatever else the machine does only adds.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time

COMMANDS = (["--help"], ["--version"], ["query", "--help"], ["explain", "KG101"], ["config", "show"], ["nodes"])
"""Beginnings of a day with `kg`; the last one fails for want of a store."""

RULES = """
import time
from kg.resources import folder
from kg.rules.reading import discover
began = time.process_time()
rules = discover([folder("rules")])
print(len(rules.files), time.process_time() - began)
"""
"""Reads all rules in force, which each process does once that builds, checks or explains."""

SLOWEST = 12


def main() -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--repeat", type=int, default=20, help="how often each command is run")
    parser.add_argument("--demos", type=int, default=5, help="how often the demo is run and the rules are read")
    options = parser.parse_args()
    repeat = options.repeat
    print(f"{'command':24} {'wall ms':>8} {'CPU ms':>8}")
    with tempfile.TemporaryDirectory(prefix="kg-benchmark-") as folder:
        print(f"{'python (nothing)':24} {_row(['-c', ''], repeat, folder)}")
        for command in COMMANDS:
            print(f"{'kg ' + ' '.join(command):24} {_row(['-m', 'kg', *command], repeat, folder)}")
        print(f"{'kg demo':24} {_row(['-m', 'kg', 'demo'], options.demos, folder)}")
        print(f"\n{_rules(options.demos, folder)}")
        print(
            f"\nimports of kg --help that take longest, themselves and with what they import, in ms\n{_imports(folder)}"
        )


def _row(arguments: list[str], repeat: int, folder: str) -> str:
    runs = [_run(arguments, folder) for _ in range(repeat)]
    return f"{min(wall for wall, _ in runs) * 1e3:8.1f} {min(cpu for _, cpu in runs) * 1e3:8.1f}"


def _run(arguments: list[str], folder: str) -> tuple[float, float]:
    """Run Python once and return its wall clock and CPU time in seconds."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([sys.executable, *arguments], cwd=folder, env=_environment(), capture_output=True, check=False)
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _rules(repeat: int, folder: str) -> str:
    """Return what reading the rules costs, with the imports that it needs and without the start of Python."""
    command = [sys.executable, "-c", RULES]
    runs = [
        subprocess.run(command, cwd=folder, env=_environment(), capture_output=True, text=True, check=True)
        for _ in range(repeat)
    ]
    files, seconds = min((run.stdout.split() for run in runs), key=lambda row: float(row[1]))
    return f"reading {files} files of rules: {float(seconds) * 1e3:.1f} ms of CPU"


def _imports(folder: str) -> str:
    command = [sys.executable, "-X", "importtime", "-m", "kg", "--help"]
    run = subprocess.run(command, cwd=folder, env=_environment(), capture_output=True, text=True, check=True)
    rows = [line.removeprefix("import time:").split("|") for line in run.stderr.splitlines() if "|" in line]
    timed = [(int(row[1]), int(row[0]), row[2].strip()) for row in rows if row[1].strip().isdigit()]
    slowest = sorted(timed, reverse=True)[:SLOWEST]
    return "\n".join(f"{itself / 1e3:8.1f} {whole / 1e3:8.1f}  {name}" for whole, itself, name in slowest)


def _environment() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if not name.startswith("KG_")}


if __name__ == "__main__":
    main()
