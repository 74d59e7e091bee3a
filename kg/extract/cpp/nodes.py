"""The nodes in the C++ of a package, and the facts of each.

The entries come from the build: executables with a `main`, and classes that are registered as nodelet, component or
plugin. A component and the executable that the build generates for it are one node. If no build file was understood,
each class that declares interfaces is an entry.
"""

from __future__ import annotations

import re
from contextlib import closing, contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Final, cast

from kg.extract.buildmodel import BuildModel, PluginClass, Registration, Target, TargetKind, last_part
from kg.extract.cpp import syntax
from kg.extract.cpp.kinds import inside
from kg.extract.cpp.language import Cpp
from kg.extract.cpp.linking import Linker
from kg.extract.cpp.macros import EXPORTS
from kg.extract.cpp.project import FRAMEWORKS, Project
from kg.extract.cpp.syntax import line_of
from kg.extract.cpp.units import CppClass, CppUnit
from kg.extract.declared import bounds_of, facts_of, mark_of, names_of
from kg.extract.manifests import read_build
from kg.extract.marks import Extracted, Mark
from kg.extract.slots import slots_of
from kg.facts import TREE_NODE, Interface, Location, NodeKind, NodeType, Parameter
from kg.holes import is_known
from kg.names import normalise
from kg.symbolic import form
from kg.symbolic.containers import COMMAND_LINE
from kg.symbolic.effects import Framework
from kg.symbolic.machine import Machine
from kg.symbolic.names import EMPTY, NODE_NAME, below
from kg.symbolic.state import Arguments, Frame, Site, deep_recursion
from kg.symbolic.trees import FACTORY, Registered
from kg.symbolic.values import Bound, Kind, Mapping, Object, Text, TypeValue, Unknown, Value

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.files import FilePath, PackageFolder
    from kg.corpus.reading import Reader
    from kg.symbolic.descriptions import Descriptions
    from kg.symbolic.form import Class, Function

_KINDS: Final = {
    Registration.NODELET: NodeKind.NODELET,
    Registration.COMPONENT: NodeKind.COMPONENT,
    Registration.PLUGIN: NodeKind.PLUGIN,
}
_MAKER: Final = re.compile(
    rb'\bextern\s+"C"\s*(?:\{\s*)?(?:[A-Z_]+\s+)?([\w:]+)\s*\*\s*\w+\s*\([^()]*\)\s*\{\s*return\s+new\s+([\w:]+)\s*[({;]'
)
"""A function of a library that creates an object of a class for the program that loads it, and its base class."""
_CLIENT_OF_C: Final = re.compile(rb"\brclc?[_/]")
"""What programs in C contain that start a node. Those of large libraries take long, and never do."""
_TREE_NODES: Final = "BT_REGISTER_NODES"
"""The macro whose body registers nodes of behavior trees with a factory."""
_BASES: Final = {"Nodelet": Registration.NODELET}
_ROS2: Final = 2
_COMMON: Final = 6
"""The length of names of calls that occur in most sources."""
_STARTING: Final = (("rclcpp", "init"), ("rclcpp", "spin"), ("rclcpp", "shutdown"))
"""Functions that declare nothing, of which programs consist that only start a node."""


def read_nodes(reader: Reader, package: PackageFolder, build: BuildModel, calls: Descriptions) -> list[Extracted]:
    """Return the nodes in the C++ of a package; no content of the sources raises an error."""
    project = Project(reader, package, build, calls)
    with deep_recursion(), closing(project):
        return _Nodes(project, build, calls).read()


class _Nodes:
    """The reading of one package."""

    def __init__(self, project: Project, build: BuildModel, calls: Descriptions) -> None:
        self._calls = calls
        self._project = project
        self._package = project.package
        self._plugins_read: dict[PluginClass, list[Extracted]] = {}
        self._alone: dict[Class, Extracted] = {}
        """The components that declare everything while they are constructed without arguments."""
        self._in_trees: set[tuple[str, Kind | None]] = set()
        self._by_plugins: list[Extracted] = []
        """The nodes of behavior trees that plugins register."""
        self.build = build

    def read(self) -> list[Extracted]:
        """Return the nodes, in the order of the build files."""
        extracted: list[Extracted] = []
        plugins = list(self._plugins())
        started = {plugin.executable for plugin in plugins if plugin.executable}
        for target in self.build.targets:
            if target.kind is TargetKind.EXECUTABLE and (target.output_name or target.name) not in started:
                with self._compiled(target) as nodes:
                    extracted += nodes.executable(target, plugins)
        for plugin in plugins:
            extracted += self.plugin(plugin)
        extracted += self._by_plugins
        for file in self._project.sources():
            if self._project.contains(file, _TREE_NODES.encode()):
                extracted += self._tree_nodes(file)
        if not extracted and self._package.name not in FRAMEWORKS:
            extracted += self._classes()
        return extracted

    @contextmanager
    def _compiled(self, target: Target) -> Iterator[_Nodes]:
        """Give the reading of the package as it is compiled for one target, until the end of a `with` statement."""
        files = [self._project.own(path) for path in target.sources]
        macros = {*target.absent, *dict(target.values)}
        used = {name for name in macros if any(self._project.contains(file, name.encode()) for file in files)}
        absent = [name for name in target.absent if name in used]
        values = [(name, text) for name, text in target.values if name in used]
        if not absent and not values:
            yield self
            return
        build = replace(self.build, absent=(*self.build.absent, *absent), values=(*self.build.values, *values))
        with closing(Project(self._project.reader, self._package, build, self._calls)) as project:
            yield _Nodes(project, build, self._calls)

    def _classes(self) -> list[Extracted]:
        """Return the classes that declare interfaces, of a package without nodes that were understood.

        An abstract class is not a node, nor is one whose interfaces all get their names from the code that uses it.
        """
        named: list[Extracted] = []
        words = [word.encode() for word in self._calls.calls if len(word) > _COMMON]
        for file in self._project.sources():
            unit = self._project.unit(file) if "/test" not in file.path else None
            classes = [cls for listed in unit.classes.values() for cls in listed] if unit is not None else []
            for cls in classes:
                if isinstance(cls, CppClass) and cls.abstract:
                    continue
                with self._program([file]) as language:
                    methods = (f for listed in language.linker.methods(cls).values() for f in listed)
                    units = {cls.unit, *(method.unit for method in methods)}
                    sources = [cast("CppUnit", one).source for one in units]
                    if not any(word in source for source in sources for word in words):
                        continue
                    root, _ = self._started(language, cls)
                    node = NodeType(
                        cls.name, NodeKind.CLASS, "cpp", 0, Location(file.path, cls.line), sources=(file.path,)
                    )
                    extracted = self._extracted(language.machine.framework, node, root)
                    named += [one for one in extracted if any(i.name or i.parameter for i in one.node.interfaces)]
        return named

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

    @contextmanager
    def _program(self, files: list[FilePath]) -> Iterator[Cpp]:
        """Interpret some files, until the end of a `with` statement.

        Language, machine and framework refer to each other. Emptied, they are freed at once: the collector of cycles
        would take a tenth of the time of extraction to find them.
        """
        language = Cpp(Linker(self._project, files))
        framework = Framework(self._calls)
        machine = Machine(language, framework)
        language.machine = framework.machine = machine
        yield language
        for part in (machine, language, framework):
            vars(part).clear()

    def executable(self, target: Target, plugins: list[PluginClass]) -> list[Extracted]:
        """Return the nodes that the program of a target starts; `plugins` are those of the package."""
        with self._program(self._files(target)) as language:
            own = [unit for unit in (language.linker.load(self._project.own(path)) for path in target.sources) if unit]
            units = own + [unit for unit in language.linker.units.values() if unit not in own]
            mains = [f for unit in units for f in unit.functions.get("main", ()) if not f.scope]
            if not mains:
                return []
            main = mains[0]
            if main.unit.path.endswith(".c") and not any(_CLIENT_OF_C.search(unit.source) for unit in units):
                return []
            name = target.output_name or target.name
            place = Location(main.unit.path, main.line)
            node = NodeType(name, NodeKind.EXECUTABLE, "cpp", 0, place, executable=name, sources=target.sources)
            component = self._component(main, language, plugins)
            if component is not None:  # running the program would run all of the component again
                return [replace(component, node=_as_executable(component.node, node))]
            if not self._project.reach.reaches(main):
                return []
            machine = language.machine
            machine.stack.append(Site(main.unit, main.line))
            arguments: list[Value] = [Unknown("it is the number of arguments", "argc"), COMMAND_LINE]
            machine.invoke(main, Frame(main.unit, ()), arguments[: len(main.parameters)])
            machine.drain()
            alone = self._extracted(machine.framework, node, None)
            return [*alone, *self._of_trees(machine.framework, self._files(target))]

    def _component(self, main: Function, language: Cpp, plugins: list[PluginClass]) -> Extracted | None:
        """Return the component that declares all that a program declares; None if there is none."""
        started = _started_by(main)
        resolved = language.kind(started, Frame(main.unit, ())) if started is not None else None
        if not isinstance(resolved, Kind) or resolved.cls is None:
            return None
        for plugin in plugins:
            if last_part(plugin.type) == resolved.name:
                self.plugin(plugin)
        return self._alone.get(resolved.cls)

    def _plugins(self) -> Iterator[PluginClass]:
        """Yield the classes registered in the build files, then those registered in code only."""
        yield from self.build.plugins
        names = {last_part(plugin.type) for plugin in self.build.plugins}
        for file in self._project.sources():
            for plugin in self._registered(file):
                if last_part(plugin.type) not in names:
                    names.add(last_part(plugin.type))
                    yield plugin

    def _registered(self, file: FilePath) -> Iterator[PluginClass]:
        """Yield the classes that a file registers by macros, or creates in functions for a program that loads it."""
        words = [word for word in EXPORTS if self._project.contains(file, word.encode())]
        makes = self._project.contains(file, b'extern "C"')
        unit = self._project.unit(file) if words or makes else None
        if unit is None:
            return
        for word in words:
            for call in unit.registrations:
                function = call.child_by_field_name("function")
                given = syntax.arguments(call.child_by_field_name("arguments"))
                if not given or function is None or syntax.text(function) != word:
                    continue
                shown = [syntax.text(argument) for argument in given]
                kind = shown[min(EXPORTS[word], len(shown) - 1)]
                base = shown[1 if "ADD_PLUGIN" in word else -1] if len(shown) > 1 else None
                registration = _BASES.get(last_part(base or ""), Registration.PLUGIN)
                if word == "RCLCPP_COMPONENTS_REGISTER_NODE":
                    registration = Registration.COMPONENT
                yield PluginClass(kind, kind, registration, Location(file.path, line_of(call)), base_type=base)
        for match in _MAKER.finditer(unit.source) if makes else ():
            base, kind = (name.decode() for name in match.groups())
            place = Location(file.path, unit.source.count(b"\n", 0, match.start()) + 1)
            yield PluginClass(kind, kind, Registration.PLUGIN, place, base_type=base)

    def plugin(self, plugin: PluginClass) -> list[Extracted]:
        """Return the node of a registered class; none if the class is not found."""
        if plugin not in self._plugins_read:
            self._plugins_read[plugin] = self._read_plugin(plugin)
        return self._plugins_read[plugin]

    def _read_plugin(self, plugin: PluginClass) -> list[Extracted]:
        for files in self._libraries(plugin):
            with self._program(files) as language:
                found = self._class(language.linker, plugin.type) if "<" not in plugin.type else None
                kind = _kind_of(found) if found is not None else self._aliased(language, plugin.type)
                if kind is None or (cls := kind.cls) is None:
                    continue
                root, complete = self._started(language, cls, plugin.registration, kind)
                name = plugin.executable or last_part(plugin.name)
                place = Location(cls.unit.path, cls.line)
                node = NodeType(
                    name,
                    _KINDS[plugin.registration],
                    "cpp",
                    0,
                    place,
                    executable=plugin.executable,
                    plugin=plugin.name,
                    base_class=plugin.base_type,
                    sources=_sources_of(language, cls),
                    exported=plugin.location,
                )
                framework = language.machine.framework
                nodes = self._extracted(framework, node, root)
                if nodes and complete and is_known(nodes[0].node.node_name):
                    self._alone[cls] = nodes[0]
                self._by_plugins += self._of_trees(framework, files)
                return nodes
        return []

    def _tree_nodes(self, file: FilePath) -> Iterator[Extracted]:
        """Yield the nodes of behavior trees that a file registers and that have interfaces."""
        target = next((one for one in self.build.targets if file.path in one.sources), None)
        files = self._files(target) if target is not None else [file]
        with self._program([file, *(one for one in files if one != file)]) as language:
            machine, unit = language.machine, language.linker.load(file)
            for function in unit.functions.get(_TREE_NODES, ()) if unit is not None else ():
                frame = Frame(function.unit, function.scope)
                kind = function.parameters[0].type if function.parameters else None
                frame.variables[kind.names[-1] if kind is not None else "factory"] = Object(FACTORY)
                machine.stack.append(Site(function.unit, function.line))
                machine.invoke(function, frame, [])
                machine.stack.pop()
            yield from self._of_trees(machine.framework, files)

    def _of_trees(self, framework: Framework, files: list[FilePath]) -> Iterator[Extracted]:
        """Yield the nodes of behavior trees that a run registered, each once, and that have interfaces."""
        for one in framework.registered:
            name = one.name.exact if isinstance(one.name, Text) else None
            if name and (name, one.kind) not in self._in_trees:
                self._in_trees.add((name, one.kind))
                yield from self._tree_node(one, name, files)

    def _tree_node(self, registered: Registered, name: str, files: list[FilePath]) -> list[Extracted]:
        """Return a node of behavior trees, created as its factory does."""
        with self._program(files) as language:
            site = registered.stack[-1]
            language.machine.stack.append(site)
            given: list[Value] = [Text.of(name), Unknown("it is the configuration of the node")]
            if registered.kind is not None:
                language.calls.value(Bound("providedPorts", registered.kind), Arguments([]))
            if registered.builder is not None:
                root = language.calls.value(registered.builder, Arguments(given))
            elif registered.kind is not None:
                frame = Frame(site.unit, ())
                root = language.construct(registered.kind, [*given, *registered.given], frame, site.line)
            else:
                return []
            cls = root.kind.cls if isinstance(root, Object) else None
            if not isinstance(root, Object) or cls is None:
                return []
            self._run_from_outside(language, root, node=False)
            node = NodeType(
                name,
                NodeKind.PLUGIN,
                "cpp",
                0,
                Location(cls.unit.path, cls.line),
                plugin=name,
                base_class=TREE_NODE,
                sources=_sources_of(language, cls),
                exported=Location(site.unit.path, site.line),
            )
            nodes = self._extracted(language.machine.framework, node, root)
            return [one for one in nodes if one.node.interfaces]

    def _started(
        self, language: Cpp, cls: Class, registration: Registration | None = None, kind: Kind | None = None
    ) -> tuple[Object, bool]:
        """Create an object of a class, and run the methods that its loader may call.

        Return the object, and whether it declared everything while it was created without arguments.
        A registered class gets its default arguments; a class of a library gets unknown ones. The loader of a nodelet
        calls virtual methods only, as that of a node.
        """
        machine, framework = language.machine, language.machine.framework
        loaded, nodelet = registration is not None, registration is Registration.NODELET
        kind = kind or _kind_of(cls)
        bound = dict(language.chain(kind)[0][0][1])
        frame = inside(cls, bound)
        constructors = language.kinds.own_methods(cls, bound, language.linker.methods(cls).get(cls.name, []))
        machine.stack.append(Site(cls.unit, cls.line))
        root = Object(kind, line=cls.line)
        if registration is Registration.COMPONENT:
            framework.presume_node(kind)
        if any(d.is_a == "node" for d in framework.described(kind)):
            framework.host = root
        chosen = min(constructors, key=lambda f: len(f.parameters), default=None)
        given = (
            [language.unknown(p.type, frame, p.name) for p in chosen.parameters if p.default is None or not loaded]
            if chosen
            else []
        )
        language.initialise(root, kind, given)
        framework.constructed(root)
        machine.drain()
        before = (framework.results(), list(framework.declared))
        self._run_from_outside(language, root, node=nodelet or framework.host is root)
        return root, not given and before == (framework.results(), framework.declared)

    def _run_from_outside(self, language: Cpp, root: Object, *, node: bool) -> None:
        """Run the methods of an object that its loader may call, except for those on which no effect depends.

        Those that get a node, and that none of the others calls, come first: the others use it.
        """
        machine = language.machine
        machine.drain()
        described = bool(machine.framework.described(root.kind))
        names = _called_from_outside(language, root.kind, node=node, described=described)
        overloads = [(name, [function for function, _ in language.methods(root.kind, name)]) for name in names]
        listed = [(name, max(functions, key=self._project.reach.reaches)) for name, functions in overloads if functions]
        getting = {name for name, function in listed if _gets_node(language, function)}
        for name in names if getting else ():
            for function, _ in language.methods(root.kind, name):  # also those that it overrides, which it may call
                getting -= (self._project.words(function) or frozenset()) - {name}
        pending = dict(sorted(listed, key=lambda one: one[0] not in getting))
        while needed := self._needed(language, root.kind, pending):  # what runs may create objects with effects
            for name in needed:
                if (id(pending.pop(name)), id(root)) not in machine.executed:
                    language.enter(Bound(name, root))
                    machine.drain()

    def _needed(self, language: Cpp, kind: Kind, methods: dict[str, Function]) -> list[str]:
        """Return the methods that reach an effect, and those that write a field which such a method uses."""
        reach = self._project.reach
        reaching = {name for name, function in methods.items() if reach.reaches(function)}
        if not reaching:
            return []
        fields = {name for cls, _ in language.chain(kind)[0] for name in cls.fields}
        used = fields & reach.uses(methods[name] for name in reaching)
        return [name for name, one in methods.items() if name in reaching or not used.isdisjoint(reach.changes(one))]

    def _libraries(self, plugin: PluginClass) -> Iterator[list[FilePath]]:
        """Yield sets of files that may define a plugin: its library, the file that registers it, all of the package."""
        for target in self.build.targets:
            if plugin.library is not None and _library(plugin.library) in (target.name, target.output_name):
                yield self._files(target)
        pattern = last_part(plugin.type).partition("<")[0].encode()
        sources = [file for file in self._project.sources() if "/test" not in file.path]
        yield [file for file in sources if self._project.contains(file, pattern)]

    def _class(self, linker: Linker, name: str) -> Class | None:
        wanted = tuple(part for part in name.replace(" ", "").split("::") if part)
        if not wanted:
            return None
        last = wanted[-1]
        classes: list[Class] = []
        for unit in tuple(linker.units.values()):
            classes += unit.classes.get(last, ())
            for header in self._project.find(unit.key, "class", last):
                classes += header.classes.get(last, ())
        own = [cls for cls in classes if self._project.is_own(cls.unit.key)]
        return max(own, key=lambda cls: cls.scope[-len(wanted) + 1 :] == wanted[:-1], default=None)

    def _aliased(self, language: Cpp, name: str) -> Kind | None:
        """Return what `name` is another name of: a class of the package, or a template for one or of the package."""
        for unit in tuple(language.linker.units.values()):
            kind = language.kind(unit.written(name), Frame(unit, ()))
            if isinstance(kind, Kind) and kind.cls is not None and self._is_own(kind):
                return kind
        return None

    def _is_own(self, kind: Kind) -> bool:
        inner = [one.kind for one in kind.arguments if isinstance(one, TypeValue)]
        return (kind.cls is not None and self._project.is_own(kind.cls.unit.key)) or any(map(self._is_own, inner))

    def _loaded(self, framework: Framework) -> tuple[list[Interface], list[Parameter]]:
        """Return the facts of the nodelets that a program loads into itself, with the names that it gives them."""
        interfaces: list[Interface] = []
        parameters: list[Parameter] = []
        for row in framework.loaded:
            name, kind = row[0], row[1]
            shown = kind.exact if isinstance(kind, Text) else None
            home, plugin = self._plugin_of(shown) if shown is not None else (None, None)
            private = "~" if isinstance(name, Text) and name.parts == (NODE_NAME,) else None
            private = name.exact if private is None and isinstance(name, Text) else private
            renamed = dict(_remappings(row[2])) if len(row) > 2 else {}  # noqa: PLR2004 - the third argument
            for extracted in home.plugin(plugin) if home is not None and plugin is not None else ():
                for one in extracted.node.interfaces:
                    if one.name is None or private is not None or not one.name.startswith("~"):
                        own = renamed.get(one.name, _below(private, one.name)) if one.name is not None else None
                        interfaces.append(replace(one, name=own))
                if private is not None:
                    parameters += [replace(one, name=_below(private, one.name)) for one in extracted.node.parameters]
        return interfaces, parameters

    def _plugin_of(self, name: str) -> tuple[_Nodes | None, PluginClass | None]:
        """Return the plugin of a name and the reading of its package: this one, or that in the name."""
        for home in (self, self._reading(name.partition("/")[0])):
            plugin = next((p for p in home.build.plugins if p.name == name), None) if home is not None else None
            if plugin is not None:
                return home, plugin
        return None, None

    def _reading(self, package: str) -> _Nodes | None:
        """Return the reading of a package of the build by its name."""
        if package == self._package.name:
            return self
        reader = self._project.reader
        place = reader.workspace.package(package)
        if place is None or place.repository != reader.repository:
            return None
        folder = reader.workspace.folder(place)[1]
        build = read_build(reader, folder)
        return _Nodes(Project(reader, folder, build, self._calls), build, self._calls)

    def _extracted(self, framework: Framework, node: NodeType, root: Object | None) -> list[Extracted]:
        declared, loadings = framework.declared, framework.loadings
        if root is None or framework.host is root:
            declared = [one for one in declared if _belongs(one.node, root)]
            loadings = [one for one in loadings if _belongs(one.node, root)]
        ros = _version(framework)
        named, namespace = names_of(framework, [root] if root is not None else framework.nodes, ros, node.kind)
        alone = named or node.name, namespace or "/"
        interfaces, parameters = facts_of(declared, self._project, ros, alone)
        loaded_interfaces, loaded_parameters = self._loaded(framework)
        interfaces, parameters = (*interfaces, *loaded_interfaces), (*parameters, *loaded_parameters)
        slots = slots_of(loadings, declared, self._project)
        loads = bool(slots) and root is not None
        if not (interfaces or parameters or loads or framework.marks or framework.nodes or framework.node_names):
            return []
        whole = replace(
            node,
            ros=ros,
            node_name=named,
            node_namespace=namespace,
            interfaces=interfaces,
            parameters=parameters,
            bounds=bounds_of(framework.machine.bounds, self._project),
            slots=slots,
        )
        marks = [mark_of(one, self._project) for one in framework.marks]
        if any(framework.is_a(made, "rclcpp_lifecycle::LifecycleNode") for made in framework.nodes):
            marks.append(Mark("ros2.lifecycle", node.location))
        return [Extracted(whole, tuple(dict.fromkeys(marks)))]


def _below(private: str | None, name: str | None) -> str | None:
    """Return a name of a nodelet in the program that loads it, where `~` is `private`."""
    return f"{private}{name[1:]}" if private is not None and name is not None and name.startswith("~") else name


def _started_by(main: Function) -> form.Type | None:
    """Return the class of the only object that a program creates, without arguments, to spin it and to end."""
    types: list[form.Type] = []
    pending: list[object] = [main.body]
    while pending:
        one = pending.pop()
        if isinstance(one, form.Block):
            pending += one.body
        elif isinstance(one, form.Declare) and (one.type is None or one.type.names != ("auto",)):
            return None  # its type may be a class that the value is converted to
        elif isinstance(one, form.Step | form.Return | form.Declare) and one.value is not None:
            pending.append(one.value)
        elif isinstance(one, form.Call) and isinstance(one.function, form.Name):
            names, template = one.function.names, one.function.template
            if names == ("std", "make_shared") and not one.arguments:
                types += [given for given in template if isinstance(given, form.Type)]
            elif names not in _STARTING:
                return None
            pending += one.arguments
        elif isinstance(one, form.Call) and isinstance(one.function, form.Member):
            if one.function.name != "get_node_base_interface" or not isinstance(one.function.of, form.Name):
                return None
        elif not isinstance(one, form.Name | form.Literal):
            return None
    return types[0] if len(types) == 1 else None


def _kind_of(cls: Class) -> Kind:
    return Kind((*cls.scope, cls.name), (), cls)


def _as_executable(loaded: NodeType, executable: NodeType) -> NodeType:
    """Return the node that a program starts, whose class was read as a component."""
    return replace(
        executable,
        ros=loaded.ros,
        node_name=loaded.node_name,
        node_namespace=loaded.node_namespace,
        interfaces=loaded.interfaces,
        parameters=loaded.parameters,
        bounds=loaded.bounds,
        slots=loaded.slots,
    )


def _sources_of(language: Cpp, cls: Class) -> tuple[str, ...]:
    """Return the files with a class and its methods."""
    methods = language.linker.methods(cls).values()
    return tuple(sorted({f.unit.path for listed in methods for f in listed} | {cls.unit.path}))


def _version(framework: Framework) -> int:
    """Return the version of ROS that a node uses."""
    versions = {one.effect.ros for one in framework.declared} - {0}
    if len(versions) == 1:
        return versions.pop()
    host = framework.host
    plain = any(key == "rcl.node" for key, *_ in framework.marks)
    second = plain or bool(framework.nodes) or (host is not None and host.kind.name in ("Node", "LifecycleNode"))
    return _ROS2 if second else 1


def _remappings(value: Value) -> Iterator[tuple[str, str]]:
    for key, given in value.items if isinstance(value, Mapping) else ():
        names = (below(EMPTY, one) for one in (key, given))
        old, new = (one.exact if isinstance(one, Text) else None for one in names)
        if old is not None and new is not None:
            yield normalise(old), normalise(new)


def _called_from_outside(language: Cpp, kind: Kind, *, node: bool, described: bool) -> list[str]:
    """Return the methods that the loader of a class may call: those of its bases, then those that override.

    Methods of outer bases come first: they call those that classes between add.
    The loader of a `node` calls virtual methods only; the others of its bases are for the class itself.
    Any public method can override one of a base that is not in the sources.
    """
    chain, outside = language.chain(kind)
    overrides = own.public if outside and not (node or described) and isinstance(own := chain[0][0], CppClass) else ()
    inherited: dict[str, None] = {}
    overriding: dict[str, None] = {}
    possible: dict[str, None] = {}
    for cls, _ in reversed(chain):
        methods = language.linker.methods(cls)
        for name, listed in (*cls.declared.items(), *methods.items()):
            if name.startswith("~") or name == cls.name or not language.methods(kind, name):
                continue
            if any(function.virtual for function in listed):
                overriding[name] = None
            elif cls is chain[0][0] and name in overrides:
                possible[name] = None
            elif cls is not chain[0][0] and not node:
                inherited[name] = None
    first = [name for name in inherited if name not in overriding and name not in possible]
    return [*first, *overriding, *(name for name in possible if name not in overriding)]


def _gets_node(language: Cpp, function: Function) -> bool:
    """Check whether one of the arguments of a function is a node, or a handle of one."""
    frame = Frame(function.unit, function.scope)
    given = (language.unknown(parameter.type, frame, parameter.name) for parameter in function.parameters)
    return any(map(language.machine.framework.is_node, given))


def _belongs(owner: Object | None, root: Object | None) -> bool:
    """Return whether the declarations of an object are those of the root.

    The object is the root, a plain node that the root uses, or not a node itself.
    """
    for _ in range(8):
        if owner is None or owner is root:
            return True
        outer = owner.native.get("of")
        if not isinstance(outer, Object):
            return owner.kind.cls is None or (root is None and "within" not in owner.native)
        owner = outer
    return False


def _library(path: str) -> str:
    """Return the name of the library at a path: `lib/libfoo` or `foo`."""
    name = path.rpartition("/")[2]
    return name.removeprefix("lib") if path.startswith("lib") else name
