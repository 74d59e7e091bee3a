"""Small stores and folders of rules for the tests of authoring."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pyoxigraph import RdfFormat

from kg.rules.authoring.workbench import Workbench
from kg.rules.reading import discover
from kg.rules.recording import Names
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.files import RuleFile

__all__ = ["EX", "NAMES", "bench", "files", "write_rules"]

EX = "https://example.org/"
NAMES = Names.of(EX, f"{EX}ns#")
_HEADER = "# {title}\n#\n# ## What it infers\n#\n# Something.\n#\n# ## Why\n#\n# To test it.\n\nPREFIX : <https://example.org/>\n"


def write_rules(folder: Path, **texts: str) -> Path:
    """Write rules of the family `f` in SPARQL to a folder; their texts may use the empty prefix."""
    (folder / "f").mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        (folder / "f" / f"{name}.rq").write_text(_HEADER.format(title=name.capitalize()) + text + "\n")
    return folder


def files(folder: Path) -> list[RuleFile]:
    """Return the rules of a folder."""
    return list(discover([folder]).files)


def bench(folder: Path, data: str, inferred: str = "") -> Workbench:
    """Return a workbench on a new store with data, and the inferred triples, as Turtle."""
    store = EmbeddedStore.create(folder / "store")
    with store.write("test") as transaction:
        for name, text, graph in (("data", data, None), ("inferred", inferred, NAMES.inferred)):
            path = folder / f"{name}.ttl"
            path.write_text(f"@prefix : <{EX}> .\n@prefix owl: <http://www.w3.org/2002/07/owl#> .\n{text}")
            transaction.load_file(path, RdfFormat.TURTLE, graph=graph)
    return Workbench(store.read(), NAMES)
