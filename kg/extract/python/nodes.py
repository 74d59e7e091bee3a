"""From the build model to nodes: every script, entry point and program of a package, run in outline from its root."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from kg.extract.marks import Extracted
from kg.extract.python.declare import declare, plugin_asked
from kg.extract.python.entities import ClassRef, Dotted, FunctionRef
from kg.extract.python.evaluate import Evaluator
from kg.extract.python.program import Program, mentions_ros
from kg.extract.python.reach import reach
from kg.extract.python.walk import Walk
from kg.facts import FileKind, Location, NodeKind, NodeType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.reading import Reader
    from kg.corpus.workspace import PackageFolder
    from kg.extract.buildmodel import BuildModel, PluginClass
    from kg.extract.python.declare import Declarations
    from kg.extract.python.entities import Frame
    from kg.extract.python.unit import Scope, Unit
    from kg.extract.python.walk import Site

__all__ = ["read_nodes"]


@dataclass(frozen=True, slots=True)
class _Root:
    """Where a node begins: the top level of a file, or a function of an entry point."""

    name: str
    executable: str | None
    kind: NodeKind
    path: str
    function: str | None = None
    plugin: str | None = None


@dataclass(frozen=True, slots=True)
class _Start:
    """All that the run of one root begins with."""

    root: _Root
    evaluator: Evaluator
    scopes: list[Scope]
    frames: list[Frame]
    hosted: bool = False
    """Whether it runs in a node that something outside of the build makes."""


def read_nodes(reader: Reader, package: PackageFolder, build: BuildModel) -> list[Extracted]:
    """Return the Python nodes of a package: scripts, entry points, other programs, then node classes nobody starts."""
    program = Program(reader)
    found: list[Extracted] = []
    started: set[int] = set()
    for root in _roots(reader, package, build):
        unit = program.unit(reader.file(root.path))
        if unit is not None:
            extracted = _read_root(program, unit, root, started) or _read_gui(program, unit, root, build, started)
            if extracted is not None:
                found.append(extracted)
    found.extend(_plugins(program, package, build, started))
    found.extend(_classes(program, reader, package, started))
    return found


def _roots(reader: Reader, package: PackageFolder, build: BuildModel) -> Iterator[_Root]:
    seen: set[str] = set()
    for entry in build.entry_points:
        if entry.path is not None:
            seen.add(entry.path)
            yield _Root(entry.name, entry.name, NodeKind.EXECUTABLE, entry.path, entry.function)
    for script in build.scripts:
        if script.path not in seen:
            seen.add(script.path)
            yield _Root(script.name.removesuffix(".py"), script.name, NodeKind.SCRIPT, script.path)
    for path in _python_files(package):
        data = reader.read(path) if path not in seen else None
        if data is not None and b"__main__" in data and mentions_ros(data):
            yield _Root(PurePosixPath(path).stem, None, NodeKind.SCRIPT, path)


def _python_files(package: PackageFolder) -> Iterator[str]:
    for entry in package.files:
        if entry.kind is FileKind.PYTHON:
            yield entry.path


def _read_root(program: Program, unit: Unit, root: _Root, started: set[int]) -> Extracted | None:
    start = _start(program, unit, root)
    return _extract(start, _run(start), started)


def _start(program: Program, unit: Unit, root: _Root) -> _Start:
    module = program.module_frame(unit)
    start = _Start(root, Evaluator(program), [unit.module], [module])
    function = program.global_name(unit, root.function) if root.function else None
    if isinstance(function, FunctionRef):
        start.scopes.append(function.scope)
        start.frames.append(start.evaluator.frame_for(function, None, module))
    elif root.function is None:
        start.evaluator.main = unit
    return start


def _run(start: _Start) -> list[Site]:
    found = reach(start.evaluator.program, start.scopes)
    start.evaluator.sites = found.sites()
    walk = Walk(start.evaluator, found)
    walk.run(start.frames)
    return walk.sites


def _extract(start: _Start, sites: list[Site], started: set[int]) -> Extracted | None:
    evaluator, root = start.evaluator, start.root
    made = [site for site in sites if site.api.kind == "node"]
    if not made and not start.hosted:
        return None
    started.update(id(instance.klass) for instance in evaluator.instances.values())
    declared = declare(sites, evaluator, evaluator.program.reader.repository)
    sources = {site.frame.scope.unit.file.path for site in sites} | {root.path}
    ros = _ros_version(made or sites, start.scopes)
    return Extracted(_node(root, declared, ros, tuple(sorted(sources))), tuple(declared.marks))


def _ros_version(sites: list[Site], scopes: list[Scope]) -> int:
    known = {site.api.ros for site in sites} - {None}
    if known:
        return 1 if 1 in known else 2
    return 2 if any(b"rclpy" in scope.unit.source for scope in scopes) else 1


def _node(root: _Root, declared: Declarations, ros: int, sources: tuple[str, ...]) -> NodeType:
    lines = [
        site.call.start_point.row + 1 for site, _ in declared.nodes if site.frame.scope.unit.file.path == root.path
    ]
    return NodeType(
        name=root.name,
        kind=root.kind,
        language="python",
        ros=ros,
        location=Location(root.path, lines[0] if lines else 1),
        executable=root.executable,
        plugin=root.plugin,
        node_name=declared.name,
        sources=sources,
        interfaces=tuple(declared.interfaces),
        parameters=tuple(declared.parameters),
    )


def _classes(program: Program, reader: Reader, package: PackageFolder, started: set[int]) -> Iterator[Extracted]:
    """Yield the ROS 2 node classes of a package that none of its programs starts."""
    for path in _python_files(package):
        data = reader.read(path)
        if data is None or b"rclpy" not in data or b"class " not in data:
            continue
        unit = program.unit(reader.file(path))
        for klass in unit.classes if unit is not None else ():
            lineage = program.lineage(klass)
            if id(klass) not in started and any(isinstance(base, Dotted) and _is_node(base) for base in lineage):
                extracted = _read_class(program, klass, started)
                if extracted is not None:
                    yield extracted


def _is_node(base: Dotted) -> bool:
    return base.path.startswith("rclpy.") and base.path.rpartition(".")[2] in ("Node", "LifecycleNode")


def _read_class(program: Program, klass: Scope, started: set[int]) -> Extracted | None:
    root = _Root(klass.name, None, NodeKind.CLASS, klass.unit.file.path)
    return _read_object(program, klass, root, started)


def _read_object(
    program: Program, klass: Scope, root: _Root, started: set[int], *, hosted: bool = False
) -> Extracted | None:
    start = _Start(root, Evaluator(program), [klass], [], hosted)
    instance = start.evaluator.open_instance(klass)
    if instance.frame is not None:
        start.frames.append(instance.frame)
    return _extract(start, _run(start), started)


def _plugins(program: Program, package: PackageFolder, build: BuildModel, started: set[int]) -> Iterator[Extracted]:
    """Yield the plugins written in Python: they run in the node of the program that loads them."""
    for plugin in build.plugins:
        klass = _plugin_class(program, package, plugin)
        if klass is not None:
            root = _Root(klass.name, None, NodeKind.PLUGIN, klass.unit.file.path, plugin=plugin.name)
            extracted = _read_object(program, klass, root, started, hosted=True)
            if extracted is not None:
                yield replace(extracted, node=replace(extracted.node, base_class=plugin.base_type))


def _plugin_class(program: Program, package: PackageFolder, plugin: PluginClass) -> Scope | None:
    module, _, name = plugin.type.rpartition(".")
    near = program.reader.file(package.manifest or f"{package.path}/package.xml")
    file = program.reader.workspace.module(module, near=near) if module else None
    unit = program.unit(file) if file is not None else None
    value = program.global_name(unit, name) if unit is not None else None
    return value.scope if isinstance(value, ClassRef) else None


def _read_gui(program: Program, unit: Unit, root: _Root, build: BuildModel, started: set[int]) -> Extracted | None:
    """Return the node of a program that hands a plugin to rqt, named by its name or by its class."""
    if b"rqt_gui" not in unit.source:
        return None
    start = _start(program, unit, root)
    package = program.reader.package
    for site in _run(start):
        if site.api.kind == "gui":
            wanted = plugin_asked(site, start.evaluator)
            for plugin in build.plugins:
                klass = _plugin_class(program, package, plugin) if wanted in (plugin.name, plugin.type) else None
                if klass is not None:
                    return _read_object(program, klass, replace(root, plugin=plugin.name), started, hosted=True)
    return None
