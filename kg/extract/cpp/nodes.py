"""Which nodes the C++ of a package makes, and the facts of each.

The entries come from the build: executables with a `main`, and classes that are registered as nodelet,
component or plugin. A component and the executable that the build makes for it are one node. Where no build
file was understood, each class that makes interfaces stands for itself.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.buildmodel import PluginClass, Registration, TargetKind
from kg.extract.cpp import syntax
from kg.extract.cpp.api import Api
from kg.extract.cpp.calls import Finder
from kg.extract.cpp.evaluate import Evaluator
from kg.extract.cpp.frameworks import framework_marks
from kg.extract.cpp.loaded import loaded_nodelets
from kg.extract.cpp.naming import given_name
from kg.extract.cpp.program import Program
from kg.extract.cpp.project import FRAMEWORKS, Project
from kg.extract.cpp.ros1 import Ros1
from kg.extract.cpp.ros2 import Ros2
from kg.extract.cpp.sites import call_around
from kg.extract.manifests import read_build
from kg.extract.marks import Extracted
from kg.facts import Location, NodeKind, NodeType
from kg.names import resolve

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.files import FilePath, PackageFolder
    from kg.corpus.reading import Reader
    from kg.extract.buildmodel import BuildModel, Target
    from kg.extract.cpp.unit import Class
    from kg.facts import Interface, Parameter

__all__ = ["read_nodes"]

_KINDS: Final = {
    Registration.NODELET: NodeKind.NODELET,
    Registration.COMPONENT: NodeKind.COMPONENT,
    Registration.PLUGIN: NodeKind.PLUGIN,
}
_EXPORTS: Final = {
    "PLUGINLIB_EXPORT_CLASS": 0,
    "PLUGINLIB_DECLARE_CLASS": 2,
    "PLUGINLIB_REGISTER_CLASS": 1,
    "RCLCPP_COMPONENTS_REGISTER_NODE": 0,
    "CLASS_LOADER_REGISTER_CLASS": 0,
}
"""Macros that register a class, with the place of the class among their arguments."""
_BASES: Final = {"Nodelet": Registration.NODELET}
_ROS2: Final = 2


def read_nodes(reader: Reader, package: PackageFolder, build: BuildModel) -> list[Extracted]:
    """Return the nodes that the C++ of a package makes; raises nothing for what stands in the sources."""
    return _Nodes(reader, package, build).read()


class _Nodes:
    """The reading of one package."""

    def __init__(self, reader: Reader, package: PackageFolder, build: BuildModel) -> None:
        self._project = Project(reader, package)
        self._package = package
        self.build = build
        self._api = Api((Ros1(), Ros2()))
        self._closed = self._api.closed if package.name in FRAMEWORKS else self._api.wrappers

    def read(self) -> list[Extracted]:
        """Return the nodes, in the order of the build files."""
        found = []
        plugins = list(self._plugins())
        made = {plugin.executable for plugin in plugins if plugin.executable}
        for target in self.build.targets:
            if target.kind is TargetKind.EXECUTABLE and (target.output_name or target.name) not in made:
                found += self._executable(target)
        for plugin in plugins:
            found += self.plugin(plugin)
        if not found and self._package.name not in FRAMEWORKS:
            found += self._classes()
        return found

    def _files(self, target: Target) -> list[FilePath]:
        """Return the sources of a target and of the libraries of this package that it links."""
        by_name = {other.name: other for other in self.build.targets}
        seen = {target.name: target}
        pending = [target]
        while pending:
            for link in pending.pop().links:
                linked = by_name.get(link)
                if linked is not None and link not in seen and linked.kind is TargetKind.LIBRARY:
                    seen[link] = linked
                    pending.append(linked)
        paths = [path for one in seen.values() for path in one.sources]
        return [self._project.own(path) for path in dict.fromkeys(paths)]

    def _executable(self, target: Target) -> list[Extracted]:
        program = Program(self._project, self._closed)
        program.load(self._files(target))
        own = [unit for unit in (self._project.unit(self._project.own(path)) for path in target.sources) if unit]
        mains = [f for unit in own for f in unit.functions if f.name == "main"]
        mains = mains or [f for f in program.functions("main") if f.owner is None]
        for unit in own:
            program.start_globals(unit)
        for function in mains or [f for unit in own for f in unit.functions]:
            program.start(function)
        name = target.output_name or target.name
        node = NodeType(name, NodeKind.EXECUTABLE, "cpp", 0, target.location, executable=name)
        location = Location(mains[0].unit.file.path, mains[0].unit.line(mains[0].start)) if mains else target.location
        return self._extract(program, replace(node, location=location), target.sources, None)

    def _plugins(self) -> Iterator[PluginClass]:
        """Yield the classes registered in the build files, then those registered in code only."""
        known = set()
        for plugin in self.build.plugins:
            known.add(_last(plugin.type))
            yield plugin
        for file in self._project.sources():
            for word in _EXPORTS:
                if self._project.contains(file, word.encode()):
                    yield from self._registered(file, word, known)

    def _registered(self, file: FilePath, word: str, known: set[str]) -> Iterator[PluginClass]:
        unit = self._project.unit(file)
        for node in unit.occurrences(word) if unit is not None else ():
            call = call_around(node)
            given = syntax.arguments(call.child_by_field_name("arguments")) if call is not None else []
            if unit is None or not given:
                continue
            shown = [syntax.text(argument) for argument in given]
            kind = shown[min(_EXPORTS[word], len(shown) - 1)]
            base = shown[-1] if len(shown) > 1 else None
            component = word == "RCLCPP_COMPONENTS_REGISTER_NODE"
            registration = Registration.COMPONENT if component else _BASES.get(_last(base or ""), Registration.PLUGIN)
            if _last(kind) not in known:
                known.add(_last(kind))
                place = Location(file.path, unit.line(node.start_byte))
                yield PluginClass(kind, kind, registration, place, base_type=base)

    def plugin(self, plugin: PluginClass) -> list[Extracted]:
        """Return the node of a registered class; none if the class is not found."""
        for files in self._libraries(plugin):
            program = Program(self._project, self._closed)
            program.load(files)
            cls = self._class(program, plugin.type)
            if cls is None:
                continue
            program.start_class(cls)
            name = plugin.executable or _last(plugin.name)
            place = Location(cls.unit.file.path, cls.unit.line(cls.start))
            node = NodeType(
                name,
                _KINDS[plugin.registration],
                "cpp",
                0,
                place,
                executable=plugin.executable,
                plugin=plugin.name,
                base_class=plugin.base_type,
            )
            sources = sorted({f.unit.file.path for f in program.methods(cls)} | {cls.unit.file.path})
            return self._extract(program, node, tuple(sources), cls)
        return []

    def _libraries(self, plugin: PluginClass) -> Iterator[list[FilePath]]:
        """Yield sets of files that may define a plugin: its library, the file that registers it, all of the package."""
        for target in self.build.targets:
            if plugin.library is not None and _library(plugin.library) in (target.name, target.output_name):
                yield self._files(target)
        pattern = _last(plugin.type).encode()
        sources = [file for file in self._project.sources() if "/test" not in file.path]
        yield [file for file in sources if self._project.contains(file, pattern)]

    def _class(self, program: Program, name: str) -> Class | None:
        wanted = tuple(part for part in name.replace(" ", "").split("::") if part)
        found = [
            cls
            for unit in program.units.values()
            for cls in unit.classes
            if wanted and cls.name == wanted[-1].partition("<")[0] and self._project.is_own(unit.file)
        ]
        return max(found, key=lambda cls: cls.scope[-len(wanted) + 1 :] == wanted[:-1], default=None)

    def _classes(self) -> list[Extracted]:
        """Return the classes that make interfaces, of a package that makes no node or is not understood."""
        found = []
        program = Program(self._project, self._closed)
        program.load(file for file in self._project.sources() if "/test" not in file.path)
        for unit in list(program.units.values()):
            for cls in unit.classes if self._project.is_own(unit.file) else ():
                if not self._declares(program, cls):
                    continue
                alone = Program(self._project, self._closed)
                alone.load([unit.file])
                alone.start_class(cls)
                place = Location(unit.file.path, unit.line(cls.start))
                node = NodeType(cls.name, NodeKind.CLASS, "cpp", 0, place)
                found += [e for e in self._extract(alone, node, (unit.file.path,), cls) if e.node.interfaces]
        return found

    def _declares(self, program: Program, cls: Class) -> bool:
        """Tell whether a class or its methods mention a call or type that makes an interface."""
        known = self._api.calls.keys() | self._api.types.keys()
        return bool(known & cls.words) or any(known & function.words for function in program.methods(cls))

    def _extract(
        self, program: Program, node: NodeType, sources: tuple[str, ...], cls: Class | None
    ) -> list[Extracted]:
        evaluator = Evaluator(program, self._api)
        finder = Finder(evaluator)
        finder.run()
        found, more = self._loaded(evaluator) if cls is None else ([], [])
        interfaces = _settled([*finder.interfaces.values(), *found])
        parameters = (*finder.parameters.values(), *more)
        if not interfaces and not parameters and not finder.marks and not _initialises(program, node):
            return []
        ros = _ros(program, finder)
        named = given_name(evaluator, cls)
        alone = named or node.name
        interfaces = tuple(
            replace(
                i,
                resolved=resolve(i.name, alone) if i.name is not None and "{}" not in i.name else None,
                qos=i.qos if ros == _ROS2 else None,
            )
            for i in interfaces
        )
        whole = replace(
            node, ros=ros, node_name=named, sources=sources, interfaces=interfaces, parameters=_once(parameters)
        )
        marks = dict.fromkeys([*finder.marks, *framework_marks(program, cls)])
        return [Extracted(whole, tuple(marks))]

    def _loaded(self, evaluator: Evaluator) -> tuple[list[Interface], list[Parameter]]:
        """Return what the nodelets that a program loads into itself make."""
        interfaces: list[Interface] = []
        parameters: list[Parameter] = []
        for loaded in loaded_nodelets(evaluator):
            package, _, _ = loaded.plugin.partition("/")
            home = self._reading(package)
            plugin = (
                next((p for p in home.build.plugins if p.name == loaded.plugin), None) if home is not None else None
            )
            for extracted in home.plugin(plugin) if home is not None and plugin is not None else ():
                kept = [i for i in extracted.node.interfaces if loaded.own or not (i.name or "").startswith("~")]
                interfaces += [replace(i, name=loaded.renamed(i.name)) for i in kept]
                parameters += extracted.node.parameters if loaded.own else ()
        return interfaces, parameters

    def _reading(self, package: str) -> _Nodes | None:
        """Return the reading of a package of the build by its name."""
        if package == self._package.name:
            return self
        reader = self._project.reader
        found = reader.workspace.package(package)
        if found is None or found.repository != reader.repository:
            return None
        folder = reader.workspace.folder(found)[1]
        return _Nodes(reader, folder, read_build(reader, folder))


def _last(name: str) -> str:
    return name.replace(" ", "").rpartition("::")[2].rpartition("/")[2]


def _library(path: str) -> str:
    name = path.rpartition("/")[2]
    return name.removeprefix("lib") if path.startswith(("lib/lib", "lib")) else name


def _settled(everything: list[Interface]) -> tuple[Interface, ...]:
    """Return interfaces without those of unknown type whose name is known with a type as well."""
    typed = {(i.role, i.name) for i in everything if i.type is not None}
    return tuple(i for i in everything if i.type is not None or i.name is None or (i.role, i.name) not in typed)


def _once(found: tuple[Parameter, ...]) -> tuple[Parameter, ...]:
    return tuple(dict.fromkeys(found))


def _initialises(program: Program, node: NodeType) -> bool:
    if node.kind not in (NodeKind.EXECUTABLE, NodeKind.COMPONENT, NodeKind.NODELET):
        return False
    words = (b"ros::init", b"rclcpp::init", b"nodelet", b"rclcpp::Node", b"LifecycleNode")
    return any(word in function.unit.source for function in program.reached for word in words)


def _ros(program: Program, finder: Finder) -> int:
    """Return the version of ROS that the calls tell, else the one whose headers more of the reached code includes."""
    told = finder.ros - {0}
    if len(told) == 1:
        return next(iter(told))
    units = {function.unit for function in program.reached}
    second = sum(any(path.startswith("rclcpp") for path in unit.includes) for unit in units)
    first = sum("ros/ros.h" in unit.includes or b"ros::NodeHandle" in unit.source for unit in units)
    return _ROS2 if second > first else 1
