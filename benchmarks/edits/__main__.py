"""Measures what a build costs after an edit, above a build without changes, in processor seconds.

    python benchmarks/edits CHECKOUT --comment FILE... --change FILE OLD NEW [--repeat 3]

CHECKOUT is copied and built once. Then each edit is made as often as asked, each time another one: a comment is put
before the first line of a FILE, in which a text OLD and a text NEW take each other's place in turn. Of several
measurements, of builds without changes too, the smallest counts, since whatever else the machine does only adds. CPU is
that of the process and of all it started, user and system. Modules are compiled by the first build, as those of an
installation are. A query that sees the edit is not part of it: it costs what it cost before.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "build"))

from measuring import measure, python

if TYPE_CHECKING:
    from collections.abc import Callable


def main() -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("checkout", type=Path)
    parser.add_argument("--comment", nargs="+", default=[], metavar="FILE", help="C++, relative to the checkout")
    parser.add_argument("--change", nargs=3, action="append", default=[], metavar=("FILE", "OLD", "NEW"))
    parser.add_argument("--repeat", type=int, default=3, help="how often each edit is made")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="kg-benchmark-") as folder:
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
        os.environ["PYTHONPYCACHEPREFIX"] = str(Path(folder) / "compiled")
        copy = Path(folder) / "checkout"
        shutil.copytree(options.checkout, copy, symlinks=True)
        command = python("-m", "kg", "--store", str(Path(folder) / "store"), "build", str(copy))
        measure(command)
        idle = min(measure(command).cpu for _ in range(options.repeat))
        print(f"without changes: {idle:.2f} s")
        for file in options.comment:
            print(f"a comment in {file}: {_edited(command, _comment(copy / file), options.repeat) - idle:.2f} s more")
        for file, old, new in options.change:
            cost = _edited(command, _change(copy / file, old, new), options.repeat)
            print(f"{old} changed into {new} in {file}: {cost - idle:.2f} s more")


def _edited(command: list[str], edit: Callable[[int], None], repeat: int) -> float:
    """Return the least that a build costs after an edit."""
    found = []
    for number in range(repeat):
        edit(number)
        found.append(measure(command).cpu)
    return min(found)


def _comment(path: Path) -> Callable[[int], None]:
    return lambda number: _write(path, f"// comment {number}\n{path.read_text()}")


def _change(path: Path, old: str, new: str) -> Callable[[int], None]:
    return lambda number: _write(path, path.read_text().replace(*((new, old) if number % 2 else (old, new))))


def _write(path: Path, text: str) -> None:
    if path.read_text() == text:
        raise SystemExit(f"{path} does not hold the text that is to change")
    path.write_text(text)


if __name__ == "__main__":
    main()
