"""The assembly of a package's facts: every reader is called once, and their results become one `PackageFacts`.

`extract_package` is a pure function of the files of the package and of those that they include, so that it can run in
any process of a pool, or on another machine. A defect in one reader costs that reader's facts of that package only.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from functools import partial
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Final, TypeVar

from kg.errors import guarded
from kg.extract import cpp, definitions, implicit, manifests, parameters, python, texts
from kg.extract.buildmodel import BuildModel, TargetKind
from kg.extract.imports import add_imports
from kg.extract.sending import add_sending
from kg.facts import (
    FileKind,
    Interface,
    InterfaceDefinition,
    Location,
    NodeKind,
    NodeType,
    Package,
    PackageFacts,
    Parameter,
    Role,
    SourceFile,
)
from kg.holes import is_known, is_partial
from kg.names import resolve
from kg.symbolic.descriptions import merged

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.extract.marks import Extracted

_ROLES: Final = {role: position for position, role in enumerate(Role)}


def merge(read: Iterable[Extracted]) -> list[Extracted]:
    """Return each node once; one read twice (two entry points to the same code) has the facts of both.

    The first executable of a class is its `executable` and gives it its name; others are among its `aliases`.
    """
    merged: dict[tuple[object, ...], Extracted] = {}
    for extracted in read:
        node = extracted.node
        key = (node.name, node.kind, node.executable, node.plugin, node.language)
        merged[key] = _both(merged[key], extracted) if key in merged else extracted
    return _joined(merged.values())


def _joined(nodes: Iterable[Extracted]) -> list[Extracted]:
    """Return nodes with each class and its executables as one."""
    classes: dict[object, Extracted] = {}
    others: list[Extracted] = []
    for extracted in nodes:
        node = extracted.node
        if node.plugin is None:
            others.append(extracted)
            continue
        key = (node.plugin, node.language, node.kind)
        classes[key] = _started_by(classes[key], extracted) if key in classes else extracted
    same: dict[object, list[object]] = {}
    for name, extracted in classes.items():
        same.setdefault(_declared(extracted), []).append(name)
    alone: list[Extracted] = []
    for extracted in others:
        keys = same.get(_declared(extracted), [])
        if extracted.node.kind is NodeKind.EXECUTABLE and len(keys) == 1 and _fits(classes[keys[0]], extracted):
            classes[keys[0]] = _started_by(classes[keys[0]], extracted)
        else:
            alone.append(extracted)
    return [*alone, *classes.values()]


def _declared(extracted: Extracted) -> object:
    """Return what a node declares, and at which calls of the framework."""
    node = extracted.node
    return (
        node.language,
        node.ros,
        frozenset((one.role, one.name, one.type, _call(one)) for one in node.interfaces),
        frozenset((one.name, one.access, _call(one)) for one in node.parameters),
        frozenset((mark.key, mark.namespace, mark.detail) for mark in extracted.marks),
    )


def _call(fact: Interface | Parameter) -> Location:
    return fact.via[-1] if fact.via else fact.location


def _fits(loaded: Extracted, executable: Extracted) -> bool:
    """Check whether a class and an executable that declare the same are one node: they do, and by one name."""
    one, other = loaded.node, executable.node
    names = set(filter(is_known, (one.node_name, other.node_name)))
    return bool(one.interfaces or one.parameters) and len(names) < 2  # noqa: PLR2004 - not two names


def _common_name(one: NodeType, other: NodeType) -> str | None:
    """Return the name that the code gives a node in either way to start it, the known one if there is one."""
    names = [name for name in (one.node_name, other.node_name) if name]
    return next(filter(is_known, names), names[0] if names else None)


def _started_by(loaded: Extracted, executable: Extracted) -> Extracted:
    """Return a class with one more way to start it."""
    first, second = loaded.node, executable.node
    other = second.executable
    node = first if _declared(loaded) == _declared(executable) else _both(loaded, executable).node
    node = replace(
        node,
        node_name=_common_name(first, second),
        node_namespace=first.node_namespace or second.node_namespace,
        sources=_once(first.sources + second.sources),
        bounds=_once(first.bounds + second.bounds),
        slots=_once(first.slots + second.slots),
    )
    if other is not None and first.executable is None:
        node = replace(node, name=other, executable=other)
    elif other is not None and first.executable != other:
        node = replace(node, aliases=_once((*first.aliases, other)))
    return replace(loaded, node=node)


def _both(one: Extracted, other: Extracted) -> Extracted:
    first, second = one.node, other.node
    node = replace(
        first,
        node_name=_common_name(first, second),
        node_namespace=first.node_namespace or second.node_namespace,
        base_class=first.base_class or second.base_class,
        exported=first.exported or second.exported,
        sources=_once(first.sources + second.sources),
        interfaces=_once(first.interfaces + second.interfaces),
        parameters=_once(first.parameters + second.parameters),
        bounds=_once(first.bounds + second.bounds),
        slots=_once(first.slots + second.slots),
    )
    return replace(one, node=node, marks=_once(one.marks + other.marks))


_Item = TypeVar("_Item")


def _once(items: tuple[_Item, ...]) -> tuple[_Item, ...]:
    return tuple(dict.fromkeys(items))


def canonical(nodes: Iterable[NodeType]) -> tuple[NodeType, ...]:
    """Return the nodes with resolved names, without exact duplicates, and everything in an order of its own."""
    complete = (
        replace(
            node,
            sources=tuple(sorted(set(node.sources))),
            interfaces=_ordered(_once(tuple(_resolved(node))), _interface_order),
            parameters=_ordered(
                _once(node.parameters), lambda one: (one.implicit, _place(one.location), one.name or "", one.access)
            ),
            slots=_ordered(
                _once(node.slots), lambda one: (_place(one.location), one.base_class or "", one.parameter or "")
            ),
        )
        for node in nodes
    )
    return tuple(sorted(complete, key=_node_order))


def own_name(node: NodeType) -> str:
    """Return the name a node has when it is started alone: the one it gives itself, else that of its type."""
    if node.node_name:
        return node.node_name
    return node.name.rpartition("::")[2].rpartition("/")[2].removesuffix(".py")


def _resolved(node: NodeType) -> Iterable[Interface]:
    """Yield the interfaces with the names that they have if the node is started alone, where its namespace is known."""
    for interface in node.interfaces:
        namespace, name = node.node_namespace or "/", own_name(node)
        if interface.node is not None:
            namespace, _, name = interface.node.rpartition("/")
        if interface.name is None or (is_partial(namespace) and not interface.name.startswith("/")):
            yield interface
        else:
            yield replace(interface, resolved=resolve(interface.name, name, namespace))


def _place(location: Location) -> tuple[str, str, int]:
    return (location.repository or "", location.path, location.line)


def _ordered(items: tuple[_Item, ...], key: Callable[[_Item], tuple[object, ...]]) -> tuple[_Item, ...]:
    """Return items by their keys; those of equal keys by all they are, which takes long to spell."""
    keyed = [(key(item), item) for item in items]
    equal = Counter(place for place, _ in keyed)
    keyed.sort(key=lambda pair: (*pair[0], repr(pair[1]) if equal[pair[0]] > 1 else ""))
    return tuple(item for _, item in keyed)


def _interface_order(interface: Interface) -> tuple[object, ...]:
    return (
        interface.implicit,
        _ROLES[interface.role],
        _place(interface.location),
        interface.name or "",
        interface.type or "",
    )


def _node_order(node: NodeType) -> tuple[object, ...]:
    return (node.name, node.kind, node.language, node.plugin or "", node.executable or "", _place(node.location))


_Result = TypeVar("_Result")
_ROS_UNKNOWN: Final = 0
_TREE: Final = b"<BehaviorTree "


def extract_package(reader: Reader, calls: tuple[str, ...] = ()) -> PackageFacts:
    """Return what the reader's package declares, without launch files; it never raises, errors are in `problems`.

    `calls` are the texts of the users' descriptions of framework calls, without errors (`kg.symbolic.checking`).
    """
    package = reader.package
    of_scan = Package(package.name, package.path, _ROS_UNKNOWN, Location(package.manifest or package.path, 1))
    described = guard(reader, manifests.read_manifest, of_scan, reader, package)
    build = guard(reader, manifests.read_build, BuildModel(), reader, package)
    no_definitions: tuple[InterfaceDefinition, ...] = ()
    nodes = _nodes(reader, package, build, calls)
    return PackageFacts(
        repository=reader.repository,
        package=described,
        nodes=nodes,
        definitions=tuple(
            sorted(
                guard(reader, definitions.read_definitions, no_definitions, reader, package),
                key=lambda definition: (definition.kind, definition.name, definition.location.path),
            )
        ),
        files=tuple(_files(reader, package)),
        descriptions=guard(reader, texts.read_descriptions, (), reader, package, build, nodes),
        # After all readers, since reading adds to both.
        problems=reader.sorted_problems(),
        inputs=reader.inputs,
        programs=_programs(package, build, nodes),
    )


def _programs(package: PackageFolder, build: BuildModel, nodes: tuple[NodeType, ...]) -> tuple[str, ...]:
    """Return what can be started by name: what is built or installed, and files that may be executed where they are.

    The classes that are registered, and in which no node was found, are among them.
    """
    classes = {one.name for one in build.plugins} - {one.plugin for one in nodes}
    built = (one.output_name or one.name for one in build.targets if one.kind is not TargetKind.LIBRARY)
    alone = (one.executable for one in build.plugins if one.executable)
    installed = [*(one.name for one in build.scripts), *(one.name for one in build.entry_points)]
    files = (PurePosixPath(entry.path).name for entry in package.files if entry.executable)
    return tuple(sorted({*built, *alone, *installed, *build.programs, *files, *classes}))


def _nodes(reader: Reader, package: PackageFolder, build: BuildModel, calls: tuple[str, ...]) -> tuple[NodeType, ...]:
    nothing: list[Extracted] = []
    described, of_python = merged(calls), merged(calls, "python")
    read = [
        *guard(reader, cpp.read_nodes, nothing, reader, package, build, described),
        *guard(reader, python.read_nodes, nothing, reader, package, build, of_python),
    ]
    whole = merge(read)
    complete = guard(reader, parameters.attach, whole, reader, package, build, whole)
    nodes = canonical(guard(reader, implicit.add, extracted.node, extracted) for extracted in complete)
    named = tuple(replace(node, aliases=_aliases(node, build)) for node in nodes)
    silent_methods = frozenset(described.silent_methods | of_python.silent_methods)
    sending = guard(reader, add_sending, named, named, reader, package, silent_methods)
    return guard(reader, add_imports, sending, reader, package, sending)


def _aliases(node: NodeType, build: BuildModel) -> tuple[str, ...]:
    """Return the other executables of a node, its target, and the library that it is the only plugin of."""
    targets = {t.name for t in build.targets if node.executable is not None and t.output_name == node.executable}
    libraries = Counter(plugin.library for plugin in build.plugins)
    own = {plugin.library for plugin in build.plugins if node.plugin is not None and plugin.name == node.plugin}
    alone = {PurePosixPath(library).name.removeprefix("lib") for library in own if library and libraries[library] == 1}
    return tuple(sorted(({*node.aliases} | targets | alone) - {node.name, node.executable or ""}))


def guard(reader: Reader, read: Callable[..., _Result], instead: _Result, *arguments: object) -> _Result:
    """Return what `read` makes of its arguments, or `instead` and a problem KG121 when it has a defect."""

    def report(words: str) -> _Result:
        name = f"{read.__module__.removeprefix('kg.').removeprefix('extract.')}.{read.__name__}"
        reader.problem("KG121", f"{name}: {words}", reader.package.manifest or reader.package.path)
        return instead

    return guarded(partial(read, *arguments), report)


def _files(reader: Reader, package: PackageFolder) -> Iterator[SourceFile]:
    """Yield the files of the package that could be read, by path."""
    files = [entry for entry in package.files if entry.kind is not FileKind.PROGRAM]
    ordered = sorted(files, key=lambda entry: entry.path)
    readable = [entry for entry in ordered if reader.read(entry.path) is not None]
    digests = dict(reader.inputs)
    for entry in readable:
        text = reader.read(entry.path) if entry.path.endswith(".xml") else None
        tree = text.decode("utf-8", "replace") if text is not None and _TREE in text else None
        yield SourceFile(entry.path, entry.kind, entry.bytes, digests[f"{reader.repository}:{entry.path}"], tree)
