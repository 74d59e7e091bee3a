"""What `bugs.toml` says, typed."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bugs.workspaces import Beside

FACTS = Path(__file__).with_name("bugs.toml")
SIDES = ("faulty", "fixed")


@dataclass(frozen=True)
class Tree:
    """A folder of a workspace: `commits` has one for each side."""

    repository: str
    folder: str
    commits: dict[str, str]


@dataclass(frozen=True)
class Start:
    """A launch file (`PACKAGE/PATH`) and the arguments that it is given, by side."""

    file: str
    arguments: dict[str, dict[str, str]]


@dataclass(frozen=True)
class Bug:
    """One misconfiguration; README.md says what each key means."""

    id: str
    kind: str
    reach: str
    fault: str
    peer: str
    expect: tuple[str, ...]
    names: tuple[tuple[str, ...], ...]
    trees: tuple[Tree, ...]
    starts: tuple[Start, ...]
    nodes: tuple[tuple[str, str], ...] = ()
    beside: tuple[Beside, ...] = ()
    environment: dict[str, str] = field(default_factory=dict)


def read(path: Path = FACTS) -> list[Bug]:
    """Return the bugs of a file, in its order."""
    text = tomllib.loads(path.read_text(encoding="utf-8"))
    libraries = {name: _library(name, entry) for name, entry in text["library"].items()}
    return [_bug(entry, libraries) for entry in text["bug"]]


def _library(name: str, entry: dict[str, str]) -> Tree:
    return Tree(entry["repository"], f"libraries/{name}", dict.fromkeys(SIDES, entry["commit"]))


def _bug(entry: dict[str, Any], libraries: dict[str, Tree]) -> Bug:
    return Bug(
        id=entry["id"],
        kind=entry["kind"],
        reach=entry.get("reach", "wiring"),
        fault=entry["fault"],
        peer=entry["peer"],
        expect=tuple(entry["expect"]),
        names=tuple(map(tuple, entry["names"])),
        trees=(*map(_tree, entry["repositories"]), *(libraries[name] for name in entry.get("libraries", ()))),
        starts=tuple(map(_start, entry.get("launch", ()))),
        nodes=tuple((node["package"], node["type"]) for node in entry.get("nodes", ())),
        beside=tuple(Beside(**one) for one in entry.get("counterpart", ())),
        environment=entry.get("environment", {}),
    )


def _tree(entry: dict[str, str]) -> Tree:
    return Tree(entry["at"], entry["folder"], {side: entry.get("commit") or entry[side] for side in SIDES})


def _start(entry: dict[str, Any]) -> Start:
    return Start(entry["file"], {side: entry.get("arguments", {}) | entry.get(side, {}) for side in SIDES})
