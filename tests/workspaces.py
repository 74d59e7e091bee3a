"""Stores of the example workspace, built once for a whole run of tests, whatever the number of its workers."""

from __future__ import annotations

import fcntl
import importlib
import os
import shutil
from contextlib import chdir
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode, Quad, RdfFormat, Store, parse

from kg.graph.iris import Iris
from kg.graph.ontology_files import ontology_triples
from kg.language.annotating import prepare
from kg.pipeline import reasoning
from kg.pipeline.build import build
from kg.pipeline.plan import code_version
from kg.pipeline.reasoning import rules_over
from kg.resources import folder
from kg.settings import load
from kg.store.bulk import table
from kg.store.embedded import EmbeddedStore
from kg.symbolic.descriptions import merged

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pytest

__all__ = ["copied", "example", "prepare_builds", "prepare_rules"]

_READERS: Final = ("kg.extract.cpp", "kg.extract.python.nodes", "kg.launch.files.reading")
"""Modules that build workers import when they read their first package."""
_SELECTIONS: Final = 8
_RULES: Final = ("_cut", "_packed", "_read")
"""Functions whose results a process keeps for one or two selections of rules; tests use several in turn."""


def prepare_builds() -> None:
    """Load the tagger, the readers, the descriptions of calls and the digest of the code, which forks inherit.

    From then on, this process keeps the rules of more selections.
    """
    for name in _RULES:
        kept = getattr(reasoning, name)
        if kept.cache_parameters()["maxsize"] < _SELECTIONS:
            setattr(reasoning, name, lru_cache(_SELECTIONS)(kept.__wrapped__))
    prepare()
    for name in _READERS:
        importlib.import_module(name)
    for language in ("cpp", "python"):
        merged((), language)
    code_version("")


def prepare_rules() -> None:
    """Read and order the active rules, for the stores built by this process and its forks.

    Uses an empty working folder, because a folder `rules` there would contain rules of a user.
    """
    settings = load({}, environment={})
    quads = parse(ontology_triples(), RdfFormat.N_TRIPLES)
    graph = NamedNode(Iris(settings.base).graph("ontology"))
    store = Store()
    store.extend(Quad(quad.subject, quad.predicate, quad.object, graph) for quad in quads)
    with TemporaryDirectory() as empty, chdir(empty):
        rules_over(settings, _Ontologies(store), cache=Path(empty, "cache"))


@dataclass(frozen=True, slots=True)
class _Ontologies:
    """An in-memory store that provides the ontologies for reading rules."""

    store: Store

    def table(self, select: str, graph: NamedNode | None) -> bytes:
        """Return the rows of a SELECT over one graph."""
        return table(lambda: self.store, select, graph)

    def graphs(self) -> list[NamedNode]:
        """Return the named graphs."""
        return [name for name in self.store.named_graphs() if isinstance(name, NamedNode)]


def example(factory: pytest.TempPathFactory, name: str = "examples", more: Sequence[Path] = ()) -> Path:
    """Return a folder with a copy of the example workspace, called `name`, and its store, `.kg`; both are read-only.

    The store also has the sources in the folders `more`. Outside any checkout, so the names of sources do not depend on
    the location of the tests. The workers of pytest-xdist share it: the first one builds, the others wait.
    """
    own = factory.getbasetemp()
    place = "-".join(["built", name, *(source.name for source in more)])
    root = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / place
    with root.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (root / ".kg" / "current").exists():
            shutil.rmtree(root, ignore_errors=True)
            shutil.copytree(folder("examples") / "workspace", root / name)
            for source in more:
                shutil.copytree(source, root / source.name)
            sources = [str(root / one) for one in (name, *(source.name for source in more))]
            build(sources, EmbeddedStore.create(root / ".kg"), load({}, environment={}))
    return root


def copied(store: Path, target: Path) -> None:
    """Copy the folder of a shared store, without cache entries that are being written and soon removed."""
    shutil.copytree(store, target, ignore=shutil.ignore_patterns("*.tmp"))
