"""What robots can do, kept between commands: rules run again only if the robot, they or an ontology changed.

A file below the user's cache holds the capabilities of one graph. Its name is a digest of all that they follow from.
"""

from __future__ import annotations

import hashlib
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final

import msgspec

from kg.pipeline.kept import installations, states
from kg.pipeline.reasoning import digest, rule_folders
from kg.robot.capability import Capabilities
from kg.store.layout import user_cache, write_atomically

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.connection import ComputationGraph
    from kg.settings import Settings

__all__ = ["MOST", "folder", "key", "remembered"]

MOST: Final = 64
"""How many files there are at most; those used least recently go first."""
_MOST_BYTES: Final = 1 << 20
_CODE: Final = Path(__file__).resolve().parent.parent.parent


def folder() -> Path:
    """Return where the files are."""
    return user_cache() / "capabilities"


def key(graph: ComputationGraph, settings: Settings, names: tuple[str, ...]) -> str:
    """Return a digest of what capabilities follow from: graph, names, rules, ontologies, and the code of kg.

    The addresses of nodes do not count, which are others after each start. Raises as `kg.pipeline.reasoning.digest`.
    """
    nodes = [(node.name, node.problem) for node in graph.nodes]
    seen = [graph.ros, nodes, graph.ends, graph.problems, graph.complete, names]
    rules = [settings.base, [str(one) for one in rule_folders(settings)], digest(settings)]
    code = [tuple(state) for state in (*states(_CODE), *installations())]
    return hashlib.blake2b(msgspec.json.encode([seen, rules, code]), digest_size=16).hexdigest()


def remembered(name: str, make: Callable[[], Capabilities]) -> Capabilities:
    """Return the capabilities of that key, made now if no file has them.

    Two processes may make the same file at once: each replaces it in one step by the same content. Without a folder
    that can be written, nothing is kept.
    """
    place = folder() / f"{name}.json"
    with suppress(OSError, msgspec.MsgspecError):
        found = msgspec.json.decode(place.read_bytes(), type=Capabilities)
        place.touch()
        return found
    content = msgspec.json.encode(make())
    if len(content) <= _MOST_BYTES:
        with suppress(OSError):
            place.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            write_atomically(place, content, durable=False)
            _prune(place.parent)
    return msgspec.json.decode(content, type=Capabilities)  # what is left out as a default is the same each time


def _prune(place: Path) -> None:
    """Remove the files used least recently, and what writers that were killed left."""
    found = [(path.stat().st_mtime_ns, path) for path in place.iterdir()]
    for _, path in sorted(found)[:-MOST]:
        path.unlink(missing_ok=True)
