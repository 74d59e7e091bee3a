"""Evaluate launch configurations with arguments other than their defaults.

A store contains every launch file with its default arguments. With others, the file is evaluated again from its source,
and wired with the node types of the store.
"""

from __future__ import annotations

from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from pyoxigraph import NamedNode

from kg.corpus.reading import Reader
from kg.corpus.workspace import INSTALLED, PackageFolder, Source, Workspace, scan_tree
from kg.errors import Place, SourceError, UsageError
from kg.graph.iris import Iris
from kg.graph.reading.systems import SystemName, system_names, systems
from kg.graph.systems import system_triples
from kg.launch.wiring.systems import wire
from kg.lazily import lazily
from kg.pipeline.inferring import Inference
from kg.pipeline.launch_names import check_given, find
from kg.pipeline.sources import installed_folders
from kg.pipeline.state import State, load
from kg.pipeline.systems import node_types, used_packages
from kg.similar import did_you_mean
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kg.facts import System
    from kg.launch.wiring.types import NodeTypes
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore
    from kg.store.interface import Queryable
    from kg.store.transaction import EmbeddedTransaction

with lazily():
    from kg.launch.files import read_configuration
    from kg.rules.selecting import columns_of


def chosen(
    settings: Settings,
    store: EmbeddedStore,
    launch: str | None,
    arguments: Mapping[str, str],
    environment: Mapping[str, str],
) -> list[System]:
    """Return the systems of the store, or that of `launch`, evaluated again if arguments or variables are given.

    Raises as `find` and `check_given`, and as `LaunchFile`.
    """
    check_given(launch, arguments, environment)
    if launch is None:
        with store.read() as snapshot:
            return systems(columns_of(snapshot), system_names(snapshot), settings.base)
    state = load(store.layout.cache)
    roots = {name: source.repository.root for name, source in state.sources.items()}
    with store.read() as snapshot:
        name = find(system_names(snapshot), launch, roots)
        if not arguments and not environment:
            return systems(snapshot, [name], settings.base)
        return [LaunchFile(settings, snapshot, state, name).system(arguments, environment)]


class LaunchFile:
    """A launch file in its source, for evaluation with several arguments and environments.

    Raises:
        SourceError: KG101 if its source has moved since the build.
    """

    def __init__(self, settings: Settings, graph: Queryable, state: State, name: SystemName) -> None:
        sources = tuple(
            source
            for one in state.sources.values()
            if Path(one.repository.root).is_dir()
            for source in scan_tree(Path(one.repository.root))
        )
        source, package = _owner(sources, name)
        workspace = Workspace(sources, installed_folders(settings))
        self.reader = Reader(workspace, source, package, settings.max_file_bytes)
        self._name, self._graph = name, graph
        self._place = Place(str(source.root / name.path))
        self._packages = {
            package.name
            for built in state.sources.values()
            for package in built.packages.values()
            if any(one.plugin is not None for one in package.known.nodes)
        }
        self._types: NodeTypes | None = None

    def system(self, arguments: Mapping[str, str], environment: Mapping[str, str]) -> System:
        """Return the system.

        Raises:
            SourceError: KG101 if it cannot be read.
            UsageError: KG003 for an undeclared argument.
        """
        name = self._name
        configuration = read_configuration(self.reader, name.path, name.ros, arguments, environment)
        if configuration is None:
            raise SourceError("KG101", "the launch file cannot be read", place=self._place)
        declared = {one.name for one in configuration.arguments}
        for argument in arguments:
            if argument not in declared:
                hint = did_you_mean(argument, declared) or f"Its arguments are {', '.join(sorted(declared)) or 'none'}."
                raise UsageError("KG003", f"{name.name} has no argument `{argument}`", hint=hint)
        used = used_packages([configuration])
        if self._types is None or not used <= self._packages:
            self._packages |= used
            self._types, _ = node_types(self._graph, self._packages)
        return wire(configuration, self._types)


def unread(settings: Settings, systems: Iterable[System], environment: Iterable[str]) -> list[str]:
    """Return the environment variables that do not occur in the files of the systems."""
    state = load(layout_of(settings).cache)
    roots = {name: Path(source.repository.root) for name, source in state.sources.items()}
    roots[INSTALLED] = Path("/")
    missing = list(environment)
    for repository, path in {file for system in systems for file in system.configuration.files}:
        with suppress(OSError, KeyError):
            text = (roots[repository] / path).read_bytes()
            missing = [name for name in missing if name.encode() not in text]
    return missing


def _owner(sources: Sequence[Source], name: SystemName) -> tuple[Source, PackageFolder]:
    for source in sources:
        if source.repository.name == name.repository:
            for package in source.packages:
                if any(entry.path == name.path for entry in package.files):
                    return source, package
    hint = "Build it again from where it is now."
    raise SourceError("KG101", f"{name.repository}:{name.path} is not where it was built from", hint=hint)


@contextmanager
def trial(settings: Settings, store: EmbeddedStore, system: System) -> Iterator[EmbeddedTransaction]:
    """Yield a transaction in which this system replaces the stored one; it is rolled back.

    The rules have run over it. Meanwhile other writers wait or are refused (KG302).
    """
    iris, configuration = Iris(settings.base), system.configuration
    packages = {reference.package for one in system.instances for reference in (one.type, *one.plugins) if reference}
    with store.write("kg lint") as transaction:
        _, records = node_types(transaction, packages)
        graph = NamedNode(iris.launch_graph(configuration.repository, configuration.path))
        transaction.replace_small_graphs({graph: system_triples(system, records, iris)})
        Inference(store, settings).run(transaction)
        yield transaction
        transaction.roll_back()
