"""How the processor time of commands grows with the store: stores of several sizes, and each command on each.

    python benchmarks/growth FOLDER [--sizes 100000 1000000 5000000] [--repeat 3] [--only topic]

A store that FOLDER has already is not written again. Times are seconds of processor time of the whole process, the
smallest of the repetitions. The exponent is that of the time without that of `kg --help`, from the smallest store
to the largest: 0 is independent of the store, 1 in proportion to it.
"""

from __future__ import annotations

import argparse
import math
import os
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Final

from writing import write

from kg.settings import load

_NODE: Final = "robot_1_part_3_node_1"
_ONE: Final = (
    ("node", _NODE),
    ("node", "/robot_1_part_3_0", "--launch", "robot_1_part_3/launch/robot.launch.py"),
    ("nodes", "--package", "robot_1_part_3", "--json"),
    ("topic", "/robot_1_part_3/map"),
    ("service", "/robot_1_part_3_0/get_parameters"),
    ("param", "/robot_1_part_3_0/camera_0"),
    ("graph", "robot_1_part_3/launch/robot.launch.py"),
    ("why", _NODE, "publishes", "/robot_1_part_0/robot"),
    ("why-not", _NODE, "rnkg:feeds", "robot_1_part_3_node_2"),
    ("impact", "/robot_1_part_3/map"),
    ("query", "ASK { ?s ?p ?o }"),
    ("query", "who-publishes", "--param", "topic=/robot_1_part_0/robot"),
)
"""Commands that answer about one thing."""
_ALL: Final = (
    ("search", "lidar driver"),
    ("nodes",),
    ("nodes", "--json"),
    ("packages",),
    ("topics",),
    ("services",),
    ("instances",),
    ("stats",),
    ("status",),
    ("query", "degree"),
    ("query", "who-talks-to-whom"),
)
"""Commands that answer about everything."""
_LEAST: Final = 0.01
"""Seconds: less than this besides the start counts as this much."""


def main() -> None:
    """Read the command line, write stores, measure, print a table in Markdown."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="where the stores are, or are written to")
    parser.add_argument("--sizes", type=int, nargs="+", default=[100_000, 1_000_000, 5_000_000])
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--only", help="measure the commands alone that have this text")
    options = parser.parse_args()
    stores = [options.folder / str(size) for size in sorted(options.sizes)]
    for store in stores:
        if not (store / "current").exists():
            began = time.process_time()
            quads = write(store, int(store.name), load({}, environment={}))
            print(f"{store}: {quads:,} quads in {time.process_time() - began:.0f} s", file=sys.stderr)
    begin = min(_spent(("--help",), stores[0]) for _ in range(options.repeat))
    print(f"| command | {' | '.join(store.name for store in stores)} | exponent |")
    print("|---" * (len(stores) + 2) + "|")
    print(f"| `kg --help` | {begin:.2f} |{' |' * len(stores)}")
    factor = math.log(int(stores[-1].name) / int(stores[0].name))
    for command in (one for one in (*_ONE, *_ALL) if (options.only or "") in " ".join(one)):
        if command[0] == "search":
            for store in stores:
                _spent(command, store)  # the index is made once for a store
        found = [min(_spent(command, store) for _ in range(options.repeat)) for store in stores]
        first, last = (max(seconds - begin, _LEAST) for seconds in (found[0], found[-1]))
        exponent = math.log(last / first) / factor if factor else 0.0
        print(
            f"| `kg {' '.join(command)}` | {' | '.join(f'{one:.2f}' for one in found)} | {exponent:.2f} |", flush=True
        )


def _spent(command: tuple[str, ...], store: Path) -> float:
    """Run a command and return its processor time in seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    words = [sys.executable, "-m", "kg", "--store", str(store), *command]
    # Modules are compiled once, as after an installation.
    left_out = ("KG_", "PYTHONDONTWRITEBYTECODE")
    environment = {name: value for name, value in os.environ.items() if not name.startswith(left_out)}
    subprocess.run(words, env=environment, capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


if __name__ == "__main__":
    main()
