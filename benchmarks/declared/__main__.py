"""Writes what `generate_parameter_library` declares as truth for `benchmarks/accuracy`, read in the plainest way.

    python benchmarks/declared CHECKOUT... > declared.jsonl
    python benchmarks/accuracy CHECKOUT... --truth declared.jsonl --scorer score_interfaces.py

A checkout is a git folder. Every call of `generate_parameter_library(NAME FILE)` in a CMakeLists.txt beside a
package.xml gives one record with all names that the file declares. Nothing of `kg` is used, so that it cannot agree
with its own mistakes.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

if TYPE_CHECKING:
    from collections.abc import Iterator

CALL = re.compile(r"generate_parameter_library\(\s*(\S+)\s+([^\s)]+)")
NAME = re.compile(r"<name>\s*([^<\s]+)")


def main() -> None:
    """Print a record for each declaration in the checkouts of the command line."""
    for folder in map(Path, sys.argv[1:]):
        for listing in sorted(folder.rglob("CMakeLists.txt")):
            for record in records(folder, listing):
                print(json.dumps(record))


def records(folder: Path, listing: Path) -> Iterator[dict[str, Any]]:
    """Yield the truth records of one CMakeLists.txt."""
    manifest = listing.with_name("package.xml")
    found = NAME.search(manifest.read_text()) if manifest.exists() else None
    if found is None:
        return
    for call in CALL.finditer(listing.read_text(errors="replace")):
        path = listing.parent / call[2].replace("${PROJECT_NAME}", found[1])
        declared = yaml.safe_load(path.read_text())
        yield {
            "repo": "/".join(git(folder, "config", "remote.origin.url").removesuffix(".git").split("/")[-2:]),
            "commit": git(folder, "rev-parse", "HEAD"),
            "package": found[1],
            "executable": call[1],
            "params": [[name, None] for node in declared.values() for name in leaves(node)],
        }


def leaves(node: dict[str, Any], above: tuple[str, ...] = ()) -> Iterator[str]:
    """Yield the dotted names of the parameters below a node; a part that is a key of a map stands as `<key>`."""
    for key, value in node.items():
        if isinstance(value, dict) and isinstance(value.get("type"), str):
            yield ".".join((*above, key))
        elif isinstance(value, dict):
            yield from leaves(value, (*above, "<key>" if key.startswith("__map_") else key))


def git(folder: Path, *arguments: str) -> str:
    """Return what git prints, without the end of the line."""
    return subprocess.run(["git", "-C", folder, *arguments], check=True, capture_output=True, text=True).stdout.strip()


if __name__ == "__main__":
    main()
