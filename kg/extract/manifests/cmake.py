"""Declarations of the CMakeLists.txt of a package."""

from __future__ import annotations

import posixpath
import re
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Final

from kg.extract.buildmodel import PluginClass, Registration, Target, TargetKind
from kg.extract.manifests.cmake_builtins import HANDLERS
from kg.extract.manifests.cmake_run import BINARY, PROGRAM_OF_A_LIBRARY, SOURCE, CMakeFiles, Run, macros_of
from kg.extract.manifests.cmake_scope import Scope, strip_generators

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.facts import Location, Package

_TARGET_WORDS: Final = frozenset(
    {"WIN32", "MACOSX_BUNDLE", "EXCLUDE_FROM_ALL", "STATIC", "SHARED", "MODULE", "OBJECT", "INTERFACE", "UNKNOWN"}
    | {"PUBLIC", "PRIVATE", "LINK_PUBLIC", "LINK_PRIVATE", "LINK_INTERFACE_LIBRARIES", "SYSTEM"}
    | {
        "SRCS",
        "SOURCES",
        "HDRS",
        "debug",
        "optimized",
        "general",
        "GLOBAL",
        "BEFORE",
        "FILE_SET",
        "TYPE",
        "HEADERS",
        "BASE_DIRS",
        "FILES",
    }
)
_INSTALL_WORDS: Final = frozenset(
    {"DESTINATION", "PERMISSIONS", "CONFIGURATIONS", "COMPONENT", "RENAME", "OPTIONAL", "EXCLUDE_FROM_ALL", "TYPE"}
    | {"USE_SOURCE_PERMISSIONS", "FILE_PERMISSIONS", "DIRECTORY_PERMISSIONS", "FILES_MATCHING", "PATTERN", "REGEX"}
)
_MACRO_PROPERTIES: Final = {
    "COMPILE_DEFINITIONS": "target_compile_definitions",
    "COMPILE_FLAGS": "target_compile_options",
    "COMPILE_OPTIONS": "target_compile_options",
}
"""The properties that define macros, with the commands that add to them."""
_ENDINGS: Final = "cpp cc cxx c c++ C cu h hpp hh hxx h++ ipp tpp inl cuh"
_CODE_ENDINGS: Final = tuple(f".{ending}" for ending in _ENDINGS.split())


@dataclass(slots=True)
class _Target:
    kind: TargetKind
    location: Location
    sources: dict[str, None] = field(default_factory=dict)
    links: dict[str, None] = field(default_factory=dict)
    output_name: str | None = None
    generated: list[str] = field(default_factory=list)
    """The texts of sources that are made while building."""
    macros: dict[str, str] = field(default_factory=dict)
    """The macros that are defined for this target, with what they stand for."""


@dataclass(slots=True)
class Collected:
    """Declarations of a run over CMake files so far; `programs` pairs names and paths of installed programs."""

    targets: dict[str, _Target] = field(default_factory=dict)
    aliases: dict[str, str] = field(default_factory=dict)
    divided: dict[str, str] = field(default_factory=dict)
    """The libraries that have the name of a program, by that name."""
    plugins: list[PluginClass] = field(default_factory=list)
    programs: dict[tuple[str, str], Location] = field(default_factory=dict)
    program_names: dict[str, None] = field(default_factory=dict)
    """Under which names files are installed as programs, whatever they are and whether the source has them."""
    parameter_libraries: dict[tuple[str, str], None] = field(default_factory=dict)
    reconfigure_files: dict[str, None] = field(default_factory=dict)
    plugin_executables: dict[str, str] = field(default_factory=dict)
    """Names of plugins and of the executables that run them alone."""
    plugin_files: dict[str, None] = field(default_factory=dict)
    absent: tuple[str, ...] = ()
    """The macros that only commands define that are not run."""
    common: Mapping[str, str] = field(default_factory=dict)
    """The macros that are defined for all targets, with what they stand for."""
    installed: dict[tuple[str, str], None] = field(default_factory=dict)
    """Pairs of an installed file or folder and its source; folders end in a slash."""

    def run_alone(self, plugins: Iterable[PluginClass]) -> list[PluginClass]:
        """Return the plugins with the executables that run them; those are then no targets of their own.

        An executable runs a plugin when its only sources are generated and name the plugin in a string.
        """
        complete = []
        for plugin in plugins:
            for name, target in list(self.targets.items()):
                alone = target.generated and len(target.generated) == len(target.sources)
                if alone and any(f'"{plugin.name}"' in text for text in target.generated):
                    self.plugin_executables.setdefault(plugin.name, target.output_name or name)
                    del self.targets[name]
            executable = plugin.executable or self.plugin_executables.get(plugin.name)
            complete.append(replace(plugin, executable=executable))
        for plugin in complete:
            built = self.targets.get(plugin.executable or "")
            if built and not built.sources:
                del self.targets[plugin.executable or ""]
        return complete

    def divide(self, name: str, kind: TargetKind) -> None:
        """Set a library apart that has the name of a program, which files of rosbuild may give both of them."""
        before = self.targets.get(name)
        if before is not None and before.kind is TargetKind.LIBRARY and kind is TargetKind.EXECUTABLE:
            self.divided[name] = f"lib{name}"
            self.targets[f"lib{name}"] = replace(before, output_name=before.output_name or name)
            del self.targets[name]

    def finished(self) -> tuple[Target, ...]:
        """Return the targets, the names of aliases in their links replaced."""
        names = {**self.divided, **{alias: self.divided.get(name, name) for alias, name in self.aliases.items()}}
        links = {
            name: tuple(dict.fromkeys(names.get(link, link) for link in target.links if link != name))
            for name, target in self.targets.items()
        }
        macros = set[str]().union(*(target.macros for target in self.targets.values())).difference(self.common)
        own = {name: self._macros_of(name, links) for name in self.targets}
        return tuple(
            Target(
                name,
                target.kind,
                tuple(target.sources),
                links[name],
                target.location,
                target.output_name,
                tuple(sorted(macros.difference(own[name]))),
                valued(own[name]),
            )
            for name, target in self.targets.items()
        )

    def _macros_of(self, name: str, links: Mapping[str, tuple[str, ...]]) -> dict[str, str]:
        """Return the macros that are defined for a target, or for one that it links, with what they stand for."""
        reached = {name: None}
        pending = [name]
        while pending:
            following = [link for link in links[pending.pop()] if link in links and link not in reached]
            reached.update(dict.fromkeys(following))
            pending += following
        return {macro: text for one in reversed(reached) for macro, text in self.targets[one].macros.items()}


def valued(macros: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    """Return the macros that stand for something, with that."""
    return tuple(sorted((name, text) for name, text in macros.items() if text))


class _Targets:
    """Handlers that fill a `Collected`."""

    def __init__(self, model: Collected) -> None:
        self.model = model

    def add(self, run: Run, words: list[str], kind: TargetKind) -> None:
        name = strip_generators(words[0]) if words else ""
        if not name or "IMPORTED" in words[1:4]:
            return
        if words[1:2] == ["ALIAS"]:
            self.model.aliases[name] = words[2] if words[2:] else name
            return
        self.model.divide(name, kind)
        target = self.model.targets.setdefault(name, _Target(kind, run.location))
        if name in self.model.divided:
            target.links.setdefault(self.model.divided[name])
        self._take(run, target, words[1:])

    def _take(self, run: Run, target: _Target, words: list[str]) -> None:
        """Add sources; generated or missing ones are left out, objects of another library are linked."""
        for word in words:
            if word in _TARGET_WORDS:
                continue
            if word.startswith("$<TARGET_OBJECTS:"):
                target.links[word[len("$<TARGET_OBJECTS:") :].rstrip(">")] = None
                continue
            for part in strip_generators(word).split(";"):
                path = run.files.source_file(part, run.folder) if part else None
                if path and path.endswith(_CODE_ENDINGS):
                    target.sources[path] = None
                elif part:
                    self._take_generated(run, target, part)

    def _take_generated(self, run: Run, target: _Target, written: str) -> None:
        """Take a source that configure_file makes: its template is read in its place."""
        binary = run.scope.variables.get("CMAKE_CURRENT_BINARY_DIR", "")
        generated = run.files.generated.get(posixpath.normpath(posixpath.join(binary, written)))
        if generated:
            template, text = generated
            target.sources[template] = None
            target.generated.append(text)

    def target_sources(self, run: Run, words: list[str]) -> None:
        target = self._target(words)
        if target:
            self._take(run, target, words[1:])

    def target_link_libraries(self, _: Run, words: list[str]) -> None:
        target = self._target(words)
        if target is None:
            return
        for word in words[1:]:
            for part in strip_generators(word).split(";"):
                if part and part not in _TARGET_WORDS and not part.startswith("-"):
                    target.links[part] = None

    def _target(self, words: list[str]) -> _Target | None:
        name = strip_generators(words[0]) if words else ""
        return self.model.targets.get(self.model.aliases.get(name, name))

    def set_target_properties(self, _: Run, words: list[str]) -> None:
        if "PROPERTIES" not in words:
            return
        middle = words.index("PROPERTIES")
        pairs = dict(zip(words[middle + 1 :: 2], words[middle + 2 :: 2], strict=False))
        self._rename(words[:middle], pairs.get("OUTPUT_NAME"))
        for name, value in pairs.items():
            self._define_by_property(words[:middle], name, [value])

    def set_property(self, _: Run, words: list[str]) -> None:
        if words[:1] == ["TARGET"] and "PROPERTY" in words:
            middle = words.index("PROPERTY")
            if words[middle + 1 : middle + 2] == ["OUTPUT_NAME"]:
                self._rename(words[1:middle], "".join(words[middle + 2 :]))
            elif words[middle + 1 :]:
                self._define_by_property(words[1:middle], words[middle + 1], words[middle + 2 :])

    def define(self, _: Run, words: list[str], command: str) -> None:
        """target_compile_definitions(target PRIVATE NAME=1), target_compile_options(target PRIVATE -DNAME)."""
        target = self._target(words)
        if target:
            target.macros.update(macros_of(command, (word for word in words[1:] if word not in _TARGET_WORDS)))

    def _define_by_property(self, names: list[str], name: str, values: list[str]) -> None:
        command = _MACRO_PROPERTIES.get(name)
        parts = [part for value in values for part in re.split(r"[;\s]+", value) if part]
        for target in map(self._target, ([one] for one in names)) if command else ():
            if target:
                target.macros.update(macros_of(command or "", parts))

    def _rename(self, names: list[str], output: str | None) -> None:
        for name in names if output else ():
            target = self._target([name])
            if target:
                target.output_name = output

    def register_node(self, run: Run, words: list[str]) -> None:
        """rclcpp_components_register_node(target PLUGIN class EXECUTABLE name)."""
        target = self._target(words)
        values = dict(zip(words[1::2], words[2::2], strict=False))
        if values.get("PLUGIN"):
            self._component(run, words[0], values["PLUGIN"], values.get("EXECUTABLE"), target)

    def register_nodes(self, run: Run, words: list[str]) -> None:
        """rclcpp_components_register_nodes(target class...)."""
        for plugin in words[1:]:
            if plugin != "RESOURCE_INDEX":
                self._component(run, words[0], plugin, None, self._target(words))

    def _component(self, run: Run, name: str, plugin: str, executable: str | None, target: _Target | None) -> None:
        library = (target.output_name if target else None) or name
        component = PluginClass(
            name=plugin,
            type=plugin,
            registration=Registration.COMPONENT,
            location=run.location,
            library=library,
            executable=executable or None,
        )
        if component not in self.model.plugins:
            self.model.plugins.append(component)

    def plugin_executable(self, _: Run, words: list[str]) -> None:
        """kg_plugin_executable(executable plugin): the build makes a program that runs the plugin alone."""
        if len(words) > 1:
            self.model.plugin_executables[words[1]] = words[0]

    def export_plugins(self, run: Run, words: list[str]) -> None:
        """pluginlib_export_plugin_description_file(category path)."""
        path = run.files.locate(words[1], run.folder) if len(words) > 1 else None
        if path:
            self.model.plugin_files[path] = None

    def install(self, run: Run, words: list[str]) -> None:
        if words[:1] in (["PROGRAMS"], ["FILES"], ["DIRECTORY"]):
            self._installed(run, words)
        if words[:1] in (["PROGRAMS"], ["FILES"]):
            self.install_programs(run, words)
        elif words[:1] == ["DIRECTORY"] and words[1:]:
            self._install_folders(run, words[1:])

    def _installed(self, run: Run, words: list[str]) -> None:
        """Record where files or folders are installed."""
        given = dict(pairwise(words))
        destination = given.get("DESTINATION", "").strip("/")
        for written in _until_keyword(words[1:]):
            path = run.files.locate(strip_generators(written), run.folder)
            if path is None:
                continue
            if words[0] == "DIRECTORY":
                name = "" if written.endswith("/") else f"/{posixpath.basename(path)}"
                self.model.installed[f"{destination}{name}/", "" if path == "." else f"{path}/"] = None
            else:
                name = given.get("RENAME") or posixpath.basename(path)
                self.model.installed[f"{destination}/{name}", path] = None

    def install_programs(self, run: Run, words: list[str]) -> None:
        """install(PROGRAMS file... RENAME name) and catkin_install_python(PROGRAMS file...)."""
        rename = words[words.index("RENAME") + 1] if "RENAME" in words[:-1] else None
        for written in _until_keyword(words[1:]):
            path = run.files.locate(strip_generators(written), run.folder)
            name = rename or posixpath.basename(written)
            if words[0] == "PROGRAMS" and name and "$" not in name:
                self.model.program_names.setdefault(name)
            if path and run.files.exists(path):
                self.model.programs.setdefault((name, path), run.location)

    def _install_folders(self, run: Run, words: list[str]) -> None:
        destination = words[words.index("DESTINATION") + 1] if "DESTINATION" in words[:-1] else ""
        if not destination.startswith(("lib/", "@bin")):
            return
        for written in _until_keyword(words):
            for path in run.files.glob(f"{written.rstrip('/')}/*", run.folder, recurse=True):
                self.model.programs.setdefault((posixpath.basename(path), path), run.location)
        for word, name, then in zip(words, words[1:], [*words[2:], ""], strict=False):
            if word == "PATTERN" and then != "EXCLUDE" and not set(name) & set("*?[$/"):
                self.model.program_names.setdefault(name)

    def parameter_library(self, run: Run, words: list[str]) -> None:
        """generate_parameter_library(target file.yaml) and generate_parameter_module(module file.yaml)."""
        path = run.files.locate(words[1], run.folder) if len(words) > 1 else None
        if path:
            self.model.parameter_libraries[(words[0], path)] = None

    def reconfigure_options(self, run: Run, words: list[str]) -> None:
        """generate_dynamic_reconfigure_options(file...)."""
        for word in words:
            path = run.files.locate(word, run.folder)
            if path and run.files.exists(path):
                self.model.reconfigure_files[path] = None


def _until_keyword(words: list[str]) -> list[str]:
    end = next((index for index, word in enumerate(words) if word in _INSTALL_WORDS), len(words))
    return words[:end]


def target_handlers(model: Collected) -> dict[str, Callable[[Run, list[str]], None]]:
    """Return the handlers that fill `model`, by command in lower case."""
    targets = _Targets(model)
    return {
        "add_executable": partial(targets.add, kind=TargetKind.EXECUTABLE),
        "add_library": partial(targets.add, kind=TargetKind.LIBRARY),
        PROGRAM_OF_A_LIBRARY: partial(targets.add, kind=TargetKind.EXECUTABLE),
        "kg_plugin_executable": targets.plugin_executable,
        "kg_add_test": partial(targets.add, kind=TargetKind.TEST),
        "target_sources": targets.target_sources,
        "target_link_libraries": targets.target_link_libraries,
        "ament_target_dependencies": targets.target_link_libraries,
        "target_compile_definitions": partial(targets.define, command="target_compile_definitions"),
        "target_compile_options": partial(targets.define, command="target_compile_options"),
        "set_target_properties": targets.set_target_properties,
        "set_property": targets.set_property,
        "rclcpp_components_register_node": targets.register_node,
        "rclcpp_components_register_nodes": targets.register_nodes,
        "pluginlib_export_plugin_description_file": targets.export_plugins,
        "install": targets.install,
        "catkin_install_python": targets.install_programs,
        "generate_parameter_library": targets.parameter_library,
        "generate_parameter_module": targets.parameter_library,
        "generate_dynamic_reconfigure_options": targets.reconfigure_options,
    }


_PLATFORM: Final = {
    **dict.fromkeys(("UNIX", "LINUX", "CMAKE_COMPILER_IS_GNUCXX"), "1"),
    **dict.fromkeys(("WIN32", "APPLE", "MSVC", "ANDROID", "CYGWIN", "MINGW", "IOS"), "0"),
    "CMAKE_SYSTEM_NAME": "Linux",
    "CMAKE_CXX_COMPILER_ID": "GNU",
    "CMAKE_SOURCE_DIR": SOURCE,
    "CMAKE_BINARY_DIR": BINARY,
    "PROJECT_BINARY_DIR": BINARY,
    "CMAKE_CURRENT_BINARY_DIR": BINARY,
    "EXECUTABLE_OUTPUT_PATH": BINARY,
}
_CORES: Final = {"catkin": 1, "roscpp": 1, "ament_cmake": 2, "rclcpp": 2}
"""Packages that each version of ROS has, by which a file finds out the version."""
_BY_CATKIN: Final = (
    "CATKIN_DEVEL_PREFIX",
    "CATKIN_TOPLEVEL",
    "CATKIN_BUILD_BINARY_PACKAGE",
    "CATKIN_ENABLE_TESTING",
    "CATKIN_SKIP_TESTING",
)
"""What only builds by catkin set, by which a file for both versions finds out the version."""
_BUILD_DEPENDENCIES: Final = frozenset({"depend", "build_depend", "build_export_depend"})


def read_cmake(reader: Reader, folder: PackageFolder, package: Package) -> Collected:
    """Run the package's CMakeLists.txt, if it has one, and return its declarations."""
    model = Collected()
    files = CMakeFiles(reader, folder)
    names = [dependency.name for dependency in package.dependencies]
    files.packages.update(dict.fromkeys(names))
    run = Run(files, _scope(folder, package), HANDLERS | target_handlers(model))
    for path in _entrances(files, folder):
        run.run_file(path, own_folder=True)
    if run.stopped:
        reader.problem("KG122", "the file computes more than is followed", run.stopped.path, run.stopped.line)
    model.common = run.macros
    model.absent = tuple(sorted(run.left_out.difference(run.macros, *(one.macros for one in model.targets.values()))))
    if run.too_deep:
        reader.problem("KG114", "blocks nested deeper are left out", run.too_deep.path, run.too_deep.line)
    return model


def _entrances(files: CMakeFiles, folder: PackageFolder) -> list[str]:
    """Return the CMakeLists.txt to run: the package's own; of loose code without one, the topmost of its folders."""
    path = folder.join("CMakeLists.txt")
    if folder.manifest:
        return [path] if files.exists(path) else []
    paths = [entry.path for entry in folder.files if posixpath.basename(entry.path) == "CMakeLists.txt"]
    if path in paths:
        return [path]
    tops: list[str] = []
    for path in sorted(paths, key=lambda path: path.count("/")):
        if not any(path.startswith(posixpath.dirname(top) + "/") for top in tops):
            tops.append(path)
    return tops


def _scope(folder: PackageFolder, package: Package) -> Scope:
    """Return the variables that are known before the first command."""
    top = SOURCE if folder.path == "." else posixpath.join(SOURCE, folder.path)
    needed = [d.name for d in package.dependencies if d.kind in _BUILD_DEPENDENCIES]
    variables = _PLATFORM | {
        "CMAKE_SOURCE_DIR": top,
        "PROJECT_SOURCE_DIR": top,
        "PROJECT_NAME": folder.name,
        "CATKIN_PACKAGE_BIN_DESTINATION": f"lib/{folder.name}",
        "CATKIN_PACKAGE_LIB_DESTINATION": "lib",
        "CATKIN_PACKAGE_SHARE_DESTINATION": f"share/{folder.name}",
        "CATKIN_GLOBAL_BIN_DESTINATION": "bin",
        "ROS_VERSION": str(package.ros),
        "ENV{ROS_VERSION}": str(package.ros),
        **{f"{name}_FOUND": str(int(package.ros == ros)) for name, ros in _CORES.items()},
        **({"CATKIN_DEVEL_PREFIX": BINARY} if package.ros == 1 else dict.fromkeys(_BY_CATKIN, "")),
        "kg_build_dependencies": ";".join(needed),
    }
    return Scope(variables, set())
