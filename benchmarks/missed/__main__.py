"""Lists the lines that create interfaces by calls of a framework, and at which no node has one.

    kg build CHECKOUT... && kg nodes --json > NODES.jsonl
    python benchmarks/missed CHECKOUT... --nodes NODES.jsonl [--list FILE]

A checkout is a folder of one source of the build. Lines are found by a regular expression over C++ and Python, without
`kg`, and count as read if an interface is there or one line away, directly or as the call in between. Tests and
copies of libraries are left out (`--all` keeps them), and so are comments and folders that no build enters. A line that
no node runs is no error: a class that nothing creates, a file that no target compiles. So the figure is a lower bound,
and the list shows where to read.
"""

from __future__ import annotations

import argparse
import json
import re
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

CALL: Final = re.compile(
    r"\bcreate_(?:publisher|subscription|service|client|server|camera_publisher)\b"
    r"|\b(?:advertise|advertiseService|advertiseCamera|subscribeCamera|serviceClient)\s*[<(]|\.subscribe\s*[<(]"
    r"|\brospy\.(?:Publisher|Subscriber|Service|ServiceProxy)\(|\bSimpleAction(?:Server|Client)\(|\bAction(?:Server|Client)\("
)
"""Calls of roscpp, rclcpp, rospy, rclpy, actionlib and image_transport that create interfaces."""
NOT_CALLS: Final = re.compile(r"^\s*(?://|#|\*|/\*|\"\"\")|\b(?:import|class|def|typedef|using)\b")
BLOCK: Final = re.compile(r"/\*.*?\*/", re.DOTALL)
OTHERS: Final = re.compile(r"(?:^|/)(?:tests?|3rdparty|third_party|thirdparty|external)(?:/|_)|_tests?\.(?:py|cpp)$")
IGNORED: Final = ("CATKIN_IGNORE", "COLCON_IGNORE", "AMENT_IGNORE")
"""Files in folders that no build enters."""
SUFFIXES: Final = {".cpp", ".cc", ".cxx", ".hpp", ".h", ".hh", ".py"}
PLACE: Final = re.compile(r"([\w./+-]+):(\d+)\b")


def main() -> None:
    """Read the command line, compare, print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("checkouts", nargs="+", type=Path, help="folders with sources")
    parser.add_argument("--nodes", type=Path, required=True, help="what `kg nodes --json` printed of them")
    parser.add_argument("--list", type=Path, help="where to write the lines without a fact")
    parser.add_argument("--all", action="store_true", help="count tests and copies of libraries too")
    options = parser.parse_args()
    known = {place for line in options.nodes.read_text("utf-8").splitlines() for place in places(json.loads(line))}
    read, missed = Counter[str](), list[str]()
    for checkout in options.checkouts:
        for path, number, text in calls(checkout, others=options.all):
            found = any((path, number + shift) in known for shift in (-1, 0, 1))
            read[checkout.name] += found
            if not found:
                missed.append(f"{checkout.name}/{path}:{number}: {text}")
    if options.list is not None:
        options.list.write_text("".join(f"{one}\n" for one in missed), "utf-8")
    total = read.total() + len(missed)
    share = read.total() / max(total, 1)
    print(f"{read.total()} of {total} lines have a fact ({share:.1%}), {len(options.checkouts)} sources")


def places(found: Any) -> Iterator[tuple[str, int]]:
    """Yield the files and lines in a record, also those in texts."""
    if isinstance(found, dict):
        if isinstance(found.get("file"), str) and isinstance(found.get("line"), int):
            yield found["file"], found["line"]
        for value in found.values():
            yield from places(value)
    elif isinstance(found, list):
        for value in found:
            yield from places(value)
    elif isinstance(found, str):
        yield from ((match[1], int(match[2])) for match in PLACE.finditer(found))


def calls(checkout: Path, *, others: bool) -> Iterator[tuple[str, int, str]]:
    """Yield path, line and text of each call that creates an interface."""
    ignored = {marker.parent for name in IGNORED for marker in checkout.rglob(name)}
    for file in sorted(checkout.rglob("*")):
        path = file.relative_to(checkout).as_posix()
        if file.suffix not in SUFFIXES or not file.is_file() or (OTHERS.search(path) and not others):
            continue
        if not ignored.isdisjoint(file.parents):
            continue
        text = file.read_bytes().decode("utf-8", "replace")
        if file.suffix != ".py":
            text = BLOCK.sub(lambda match: "\n" * match[0].count("\n"), text)
        for number, line in enumerate(text.split("\n"), 1):
            if CALL.search(line) and not NOT_CALLS.search(line):
                yield path, number, line.strip()


if __name__ == "__main__":
    main()
