"""Program that reads hostile launch files in a process of its own, and prints their side effects as JSON.

    python hostile_launches.py FOLDER_OF_PACKAGES FOLDER_OF_INSTALLED_PACKAGES

Each folder of the first is a package `odd` with a launch file `launch/main.*`. An audit hook of the interpreter sees
every opened file, every started process and connection, and all executed code.
"""

from __future__ import annotations

import json
import os
import sys
import time
from importlib import import_module
from pathlib import Path

import msgspec

from kg.corpus.reading import Reader
from kg.corpus.workspace import Workspace, scan
from kg.facts import Repository
from kg.launch.files import read_configuration

_FORBIDDEN = ("subprocess.", "os.system", "os.exec", "os.fork", "os.posix_spawn", "socket.", "urllib.", "pty.")


class Watch:
    """Side effects of reading a file."""

    def __init__(self) -> None:
        self.on = False
        self.opened: list[str] = []
        self.begun: list[str] = []

    def see(self, event: str, arguments: tuple[object, ...]) -> None:
        """Record a relevant audit event."""
        if not self.on:
            return
        if event == "open" and isinstance(arguments[0], str):
            self.opened.append(os.path.realpath(arguments[0]))
        elif event.startswith(_FORBIDDEN):
            self.begun.append(f"{event} {arguments}"[:200])


def main(packages: Path, installed: Path) -> None:
    """Read the launch file of each package."""
    import_module("kg.launch.files.ros2.python.reading")  # loaded lazily, so load it before auditing begins
    watch, found = Watch(), {}
    sys.addaudithook(watch.see)
    for folder in sorted(packages.iterdir()):
        source = scan(folder, Repository("local/odd", str(folder)))
        path = next(path.relative_to(folder) for path in (folder / "launch").iterdir() if path.stem.startswith("main"))
        reader = Reader(Workspace([source], [installed]), source, source.packages[0])
        watch.opened, watch.begun, began = [], [], time.process_time()
        watch.on = True
        read = read_configuration(reader, str(path), 1 if path.suffix == ".launch" else 2)
        watch.on = False
        found[folder.name] = {
            "seconds": time.process_time() - began,
            "opened": watch.opened,
            "begun": watch.begun,
            "text": msgspec.json.encode(read).decode(),
        }
    print(json.dumps(found))  # noqa: T201 - the answer of this program


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
