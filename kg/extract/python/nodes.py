"""The nodes in the Python of a package, and the facts of each.

Programs come from the build: entry points, installed scripts, other files with a main part, and programs that give a
plugin to rqt. Plugins run in the node of the program that loads them. Node classes of ROS 2 that no program of the
package creates are entries of their own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import chain
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from kg.extract.declared import bounds_of, facts_of, mark_of, names_of
from kg.extract.marks import Extracted
from kg.extract.python.language import Python
from kg.extract.python.modules import Modules, PythonUnit, mentions_ros
from kg.extract.slots import slots_of
from kg.facts import FileKind, Location, NodeKind, NodeType, Role
from kg.names import normalise
from kg.symbolic.effects import Framework
from kg.symbolic.machine import Machine
from kg.symbolic.state import Arguments, Site, deep_recursion
from kg.symbolic.values import Closure, Kind, Object, Text, TypeValue

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.extract.buildmodel import BuildModel, PluginClass
    from kg.symbolic.descriptions import Descriptions
    from kg.symbolic.form import Class


@dataclass(frozen=True, slots=True)
class _Root:
    """Where a node begins: the statements of a file, a function of an entry point, or a class at `line`."""

    name: str
    executable: str | None
    kind: NodeKind
    path: str
    line: int | None = None
    function: str | None = None
    plugin: str | None = None


def read_nodes(reader: Reader, package: PackageFolder, build: BuildModel, calls: Descriptions) -> list[Extracted]:
    """Return the nodes in the Python of a package; no content of the sources raises an error."""
    with deep_recursion():
        return list(_Nodes(reader, package, build, calls).read())


class _Nodes:
    """The reading of one package."""

    def __init__(self, reader: Reader, package: PackageFolder, build: BuildModel, calls: Descriptions) -> None:
        self._calls = calls
        self._reader = reader
        self._package = package
        self._build = build
        self._modules = Modules(reader, package)
        self._started: set[Class | None] = set()

    def read(self) -> Iterator[Extracted]:
        """Yield the nodes: programs, plugins, then classes."""
        for root in self._roots():
            unit = self._modules.unit(self._reader.file(root.path))
            if unit is not None and self._modules.may_start(unit):
                yield from self._program(unit, root)
        for plugin in self._build.plugins:
            cls = self._plugin_class(plugin)
            if cls is not None:
                root = _Root(cls.name, None, NodeKind.PLUGIN, cls.unit.path, cls.line, plugin=plugin.name)
                yield from self._plugin(cls, plugin, root)
        for path in self._files():
            yield from self._classes(path)
        self._modules.report()

    def _roots(self) -> Iterator[_Root]:
        seen: set[str] = set()
        for entry in self._build.entry_points:
            if entry.path is not None:
                seen.add(entry.path)
                yield _Root(entry.name, entry.name, NodeKind.EXECUTABLE, entry.path, function=entry.function)
        for script in self._build.scripts:
            if script.path not in seen:
                seen.add(script.path)
                yield _Root(script.name.removesuffix(".py"), script.name, NodeKind.SCRIPT, script.path)
        for path in self._files():
            data = self._reader.read(path) if path not in seen else None
            if data is not None and b"__main__" in data and mentions_ros(data):
                yield _Root(PurePosixPath(path).stem, None, NodeKind.SCRIPT, path)

    def _files(self) -> Iterator[str]:
        for entry in self._package.files:
            if entry.kind is FileKind.PYTHON:
                yield entry.path

    def _language(self, main: PythonUnit | None = None) -> tuple[Python, Framework]:
        """Return a new interpretation, in which the module `main` runs first."""
        language, framework = Python(self._modules, main), Framework(self._calls)
        language.machine = framework.machine = Machine(language, framework)
        return language, framework

    # Programs

    def _program(self, unit: PythonUnit, root: _Root) -> Iterator[Extracted]:
        language, framework = self._language(None if root.function else unit)
        language.machine.stack.append(Site(unit, 1))
        module = language.module(unit)
        if root.function:
            function = language.member(module, root.function)
            if isinstance(function, Closure) and function.function.unit is unit:
                root = replace(root, line=function.function.line)
            language.calls.value(function)
        language.machine.drain()
        if framework.nodes or framework.node_names or _uses_a_node(framework):
            yield self._extracted(framework, root)
            return
        for row in framework.loaded:
            requested = row[1].exact if isinstance(row[1], Text) else None
            for plugin in self._build.plugins:
                cls = self._plugin_class(plugin) if requested in (plugin.name, plugin.type) else None
                if cls is not None:
                    yield from self._plugin(cls, plugin, replace(root, plugin=plugin.name))
                    return

    # Plugins and classes

    def _plugin_class(self, plugin: PluginClass) -> Class | None:
        """Return the class of a plugin that is written in Python."""
        module, _, name = plugin.type.rpartition(".")
        near = self._reader.file(self._package.manifest or f"{self._package.path}/package.xml")
        file = self._reader.workspace.module(module, near=near) if module else None
        unit = self._modules.unit(file) if file is not None else None
        if unit is None:
            return None
        language, _ = self._language()
        member = language.member(language.module(unit), name)
        return member.kind.cls if isinstance(member, TypeValue) else None

    def _plugin(self, cls: Class, plugin: PluginClass, root: _Root) -> Iterator[Extracted]:
        """Yield the node that runs a plugin, which gets it with its context."""
        extracted = self._created(cls, root, hosted=True)
        base = plugin.base_type if root.kind is NodeKind.PLUGIN else None
        if extracted is not None:
            yield replace(extracted, node=replace(extracted.node, base_class=base, exported=plugin.location))

    def _classes(self, path: str) -> Iterator[Extracted]:
        """Yield the node classes of ROS 2 in a file that no program of the package creates."""
        data = self._reader.read(path)
        if data is None or b"rclpy" not in data or b"class " not in data:
            return
        unit = self._modules.unit(self._reader.file(path))
        language, framework = self._language()
        module = language.module(unit) if unit is not None else Object(Kind(()))
        for value in list(module.fields.values()):
            cls = value.kind.cls if isinstance(value, TypeValue) else None
            if not isinstance(value, TypeValue) or cls is None or cls.unit is not unit or cls in self._started:
                continue
            if any(one.is_a == "node" for one in framework.described(value.kind)):
                extracted = self._created(cls, _Root(cls.name, None, NodeKind.CLASS, path, cls.line))
                if extracted is not None:
                    yield extracted

    def _created(self, cls: Class, root: _Root, *, hosted: bool = False) -> Extracted | None:
        """Return the node of an object of a class."""
        language, framework = self._language()
        unit = self._modules.unit(cls.unit.key)
        if unit is None:
            return None
        language.machine.stack.append(Site(unit, cls.line))
        constructor = language.member(language.module(unit), cls.name)
        context = Object(Kind(("qt_gui", "PluginContext")), fields={"node": framework.host_node()}) if hosted else None
        language.calls.value(constructor, Arguments([context] if context is not None else []))
        language.machine.drain()
        if not framework.nodes and not hosted:
            return None
        return self._extracted(framework, root)

    # Facts

    def _extracted(self, framework: Framework, root: _Root) -> Extracted:
        self._started.update(made.kind.cls for made in framework.nodes)
        ros = self._version(framework, root)
        named, namespace = names_of(framework, framework.nodes, ros, root.kind)
        alone = named or root.name, namespace or "/"
        interfaces, parameters = facts_of(framework.declared, self._modules, ros, alone)
        interfaces = tuple(replace(one, name=_clean(one.name)) for one in interfaces)
        parameters = tuple(replace(one, name=_clean(one.name)) for one in parameters)
        stacks = [one.stack for one in framework.declared] + [stack for _, _, stack, _ in framework.marks]
        places = [stack[-1] for stack in (*stacks, *framework.node_sites)]
        node = NodeType(
            name=root.name,
            kind=root.kind,
            language="python",
            ros=ros,
            location=Location(root.path, _line(root, framework.node_sites, stacks)),
            executable=root.executable,
            plugin=root.plugin,
            node_name=named,
            node_namespace=namespace,
            sources=tuple(sorted({place.unit.path for place in places} | {root.path})),
            interfaces=interfaces,
            parameters=parameters,
            bounds=bounds_of(framework.machine.bounds, self._modules),
            slots=slots_of(framework.loadings, framework.declared, self._modules),
        )
        return Extracted(node, tuple(dict.fromkeys(mark_of(one, self._modules) for one in framework.marks)))

    def _version(self, framework: Framework, root: _Root) -> int:
        """Return the version of ROS that a node uses."""
        if framework.node_names or framework.nodes:
            return 1 if framework.node_names else 2
        versions = {one.effect.ros for one in framework.declared} - {0}
        data = self._reader.read(root.path) or b""
        return min(versions, default=2 if b"rclpy" in data else 1)


def _line(root: _Root, nodes: Iterable[tuple[Site, ...]], interfaces: Iterable[tuple[Site, ...]]) -> int:
    """Return the line of a file that creates its node, or calls what does; else the call that leads to an interface.

    The first site of a stack is the root itself.
    """
    created = (stack[-1] for stack in nodes)
    called = (site for stack in nodes for site in reversed(stack[1:]))
    led = (site for stack in interfaces for site in stack[1:]) if root.line is None else ()
    lines = (site.line for site in chain(created, called, led) if site.unit.path == root.path)
    return next(lines, root.line or 1)


def _uses_a_node(framework: Framework) -> bool:
    """Return whether a program has interfaces that need a node, which code outside of the sources may start.

    rospy calls services without one.
    """
    effects = [one.effect for one in framework.declared if one.effect.role is not None]
    return any(one.ros != 1 or one.role is not Role.CLIENTS for one in effects)


def _clean(name: str | None) -> str | None:
    """Return a name without doubled slashes and without one at its end, as rospy and rclpy resolve it."""
    return normalise(name) if name is not None and name != "~" else name
