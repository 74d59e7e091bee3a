"""The modules of a build as far as they are asked for: files read once, imports and base classes resolved."""

from __future__ import annotations

import builtins
import tomllib
from functools import cache
from typing import TYPE_CHECKING, Final

from kg.extract.python.entities import ClassRef, Dotted, Frame, FunctionRef, ModuleRef
from kg.extract.python.index import index_file
from kg.extract.python.syntax import code, first_error
from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tree_sitter import Node

    from kg.corpus.reading import Reader
    from kg.corpus.workspace import FilePath
    from kg.extract.python.entities import Thing
    from kg.extract.python.unit import Import, Scope, Unit

__all__ = ["FRAMEWORKS", "GENERATED", "ROS_WORDS", "Program", "mentions_ros"]

FRAMEWORKS: Final = frozenset(
    {
        "rospy", "rclpy", "tf", "tf2_ros", "tf2_py", "actionlib", "message_filters", "diagnostic_updater",
        "dynamic_reconfigure", "interactive_markers", "bondpy", "roslib", "genpy", "image_transport", "rosgraph",
        "ddynamic_reconfigure_python", "launch", "launch_ros", "rosidl_runtime_py", "std_msgs", "numpy", "cv_bridge",
    }
)  # fmt: skip
"""Packages whose Python interface is known by name, so that their own sources are not followed."""

GENERATED: Final = frozenset({"msg", "srv", "action", "cfg"})
"""Modules that are generated from interface definitions."""

ROS_WORDS: Final = (b"rospy", b"rclpy", b"roslib", b"actionlib", b"tf2_ros", b"message_filters", b"jsk_topic_tools")


def mentions_ros(source: bytes) -> bool:
    """Tell whether a file can hold anything of ROS at all."""
    return any(word in source for word in ROS_WORDS)


_MAX_LINEAGE: Final = 200

_BUILTINS: Final = frozenset(vars(builtins)) | {"unicode", "xrange", "raw_input", "basestring", "long", "unichr"}


@cache
def _standard_types() -> dict[str, frozenset[str]]:
    """Return the names of the message types that every distribution of ROS carries, by package."""
    with (folder("ontology") / "standard_messages.toml").open("rb") as stream:
        return {package: frozenset(names) for package, names in tomllib.load(stream).items()}


def _interface_name(name: str) -> str:
    for suffix in ("Request", "Response", "Goal", "Result", "Feedback", "Action"):
        if name.endswith(suffix) and name != suffix:
            return name.removesuffix(suffix)
    return name


class Program:
    """All modules read for one package, by file."""

    def __init__(self, reader: Reader) -> None:
        self.reader = reader
        self.units: dict[FilePath, Unit | None] = {}
        self.named: dict[int, tuple[Scope, ...]] = {}
        """What `kg.extract.python.naming` found out about scopes, by their id."""
        self._frames = 0
        self._module_frames: dict[int, Frame] = {}
        self._globals: dict[tuple[int, str], Thing | None] = {}
        self._submodules: dict[tuple[int, str], Thing | None] = {}
        self._mro: dict[int, list[Scope | Dotted]] = {}

    def unit(self, file: FilePath) -> Unit | None:
        """Return the index of a file; None when it cannot be read."""
        if file not in self.units:
            source = self.reader.read(file)
            self.units[file] = None if source is None else self._index(file, source)
        return self.units[file]

    def _index(self, file: FilePath, source: bytes) -> Unit:
        unit = index_file(file, source)
        if unit.too_deep is not None:
            self.reader.problem("KG114", "functions and classes stand too deep in each other", file.path, unit.too_deep)
        line = first_error(unit.module.node)
        if line is not None:
            self.reader.problem("KG115", "part of the file does not parse as Python", file.path, line)
        return unit

    def new_frame(self, scope: Scope, lexical: Frame | None = None) -> Frame:
        """Return a new frame of a scope."""
        self._frames += 1
        return Frame(self._frames, scope, lexical=lexical)

    def module_frame(self, unit: Unit) -> Frame:
        """Return the one run of a module's top level."""
        key = id(unit)
        if key not in self._module_frames:
            self._module_frames[key] = self.new_frame(unit.module)
        return self._module_frames[key]

    def scope_frame(self, scope: Scope) -> Frame:
        """Return a frame for what stands around a scope: the module's, or one of a function with unknown caller."""
        if scope.kind == "module":
            return self.module_frame(scope.unit)
        frame = self.new_frame(scope, self.scope_frame(scope.parent) if scope.parent else None)
        frame.open = True
        return frame

    def find_module(self, dotted: str, unit: Unit) -> Unit | None:
        """Return the module of that name as imported in `unit`; None when it is not in the build."""
        first = dotted.partition(".")[0]
        if first in FRAMEWORKS or not dotted.strip("."):
            return self._folder_module(dotted, unit)
        file = self.reader.workspace.module(dotted, near=unit.file)
        return self.unit(file) if file and file != unit.file else None

    def _folder_module(self, dotted: str, unit: Unit) -> Unit | None:
        if dotted.strip("."):
            return None
        file = self.reader.workspace.module(dotted + "__init__", near=unit.file)
        return self.unit(file) if file and file != unit.file else None

    def imported(self, item: Import, unit: Unit) -> Thing:
        """Return what an import binds its name to."""
        if item.attribute is None:
            module = self.find_module(item.module, unit)
            return ModuleRef(module) if module else Dotted(item.module)
        return self.member_of_module(item.module, item.attribute, unit)

    def member_of_module(self, module: str, attribute: str, unit: Unit) -> Thing:
        """Return `attribute` of the module `module` as seen from `unit`."""
        outside = Dotted(f"{module.lstrip('.')}.{attribute}".lstrip("."))
        if GENERATED & set(module.split(".")[1:]) or (attribute in GENERATED and not module.startswith(".")):
            return outside
        found = self.find_module(module, unit)
        if found:
            inside = self.global_name(found, attribute)
            if inside is not None:
                return inside
        separator = "" if module.endswith(".") else "."
        below = self.find_module(f"{module}{separator}{attribute}", unit)
        return ModuleRef(below) if below else outside

    def global_name(self, unit: Unit, name: str) -> Thing | None:
        """Return the function, class or import of a module; None for anything else (variables are evaluated)."""
        key = (id(unit), name)
        if key not in self._globals:
            self._globals[key] = None
            self._globals[key] = self._find_global(unit, name)
        return self._globals[key]

    def _find_global(self, unit: Unit, name: str) -> Thing | None:
        scope = unit.module
        if name in scope.classes:
            return ClassRef(scope.classes[name])
        if name in scope.functions:
            return FunctionRef(scope.functions[name], self.module_frame(unit))
        if name in scope.bindings:
            return None
        if name in unit.imports:
            return self.imported(unit.imports[name], unit)
        return self._starred(unit, name)

    def _starred(self, unit: Unit, name: str) -> Thing | None:
        for module in unit.stars:
            found = self.find_module(module, unit) if not GENERATED & set(module.split(".")) else None
            inside = self.global_name(found, name) if found else None
            if inside is not None:
                return inside
        return None

    def star_modules(self, unit: Unit) -> Iterator[Unit]:
        """Yield the modules of the build whose names are all imported."""
        for module in unit.stars:
            found = self.find_module(module, unit) if not GENERATED & set(module.split(".")) else None
            if found:
                yield found

    def starred_path(self, name: str, modules: list[str]) -> str | None:
        """Return the full name of what `from module import *` of one of the modules outside of the build gives.

        Interface types are looked up among the definitions of the build; else one module alone is taken for it.
        """
        if name in _BUILTINS or not name[:1].isalpha():
            return None
        generated = list(dict.fromkeys(module for module in modules if module.rpartition(".")[2] in GENERATED))
        if not name[0].isupper():
            return f"{modules[0]}.{name}" if len(modules) == 1 and not generated else None
        for module in generated:
            if self._defines(module, name):
                return f"{module}.{name}"
        for module in generated if len(generated) > 1 else ():
            if name in _standard_types().get(module.partition(".")[0], ()):
                return f"{module}.{name}"
        others = [module for module in generated if self._may_define(module, alone=len(generated) == 1)]
        return f"{others[0]}.{name}" if len(others) == 1 else None

    def _defines(self, module: str, name: str) -> bool:
        """Tell whether a package of the build defines the interface; an action's messages stand with the messages."""
        package, _, kind = module.rpartition(".")
        kinds = (kind, "action") if kind == "msg" else (kind,)
        return any(self.reader.workspace.definition(package, _interface_name(name), each) for each in kinds)

    def _may_define(self, module: str, *, alone: bool) -> bool:
        """Tell whether a package could have interfaces that are not known here."""
        package = module.partition(".")[0]
        return self.reader.workspace.package(package) is None and (alone or package not in _standard_types())

    def lineage(self, klass: Scope) -> list[Scope | Dotted]:
        """Return a class with its bases, nearest first; bases outside of the build are `Dotted`."""
        key = id(klass)
        if key not in self._mro:
            found: dict[Scope | Dotted, None] = {}
            pending: list[Scope | Dotted] = [klass]
            while pending and len(found) < _MAX_LINEAGE:
                item = pending.pop()
                if item not in found:
                    found[item] = None
                    if not isinstance(item, Dotted):
                        pending.extend(reversed([self._base(item, base) for base in item.bases()]))
            self._mro[key] = list(found)
        return self._mro[key]

    def _base(self, klass: Scope, base: Node) -> Scope | Dotted:
        named = self.static(base, klass)
        if isinstance(named, ClassRef):
            return named.scope
        return named if isinstance(named, Dotted) else Dotted(f"?.{code(base)}")

    def static(self, node: Node, scope: Scope) -> Thing | None:
        """Return what a plain or dotted name means, without looking at variables."""
        attributes: list[str] = []
        held: Node | None = node
        while held is not None and held.type == "attribute":
            attributes.append(code(held.child_by_field_name("attribute")))
            held = held.child_by_field_name("object")
        if held is None or held.type != "identifier":
            return None
        value = self._static_name(code(held), scope)
        for attribute in reversed(attributes):
            value = self.static_member(value, attribute, scope.unit)
            if value is None:
                return None
        return value

    def _static_name(self, name: str, scope: Scope) -> Thing | None:
        around: Scope | None = scope.parent
        while around is not None and around.kind != "module":
            if name in around.classes and around.classes[name] is not scope:
                return ClassRef(around.classes[name])
            around = around.parent
        return self.global_name(scope.unit, name)

    def static_member(self, value: Thing | None, attribute: str, unit: Unit) -> Thing | None:
        """Return an attribute of a module or of something outside of the build."""
        if isinstance(value, Dotted):
            path = f"{value.path}.{attribute}"
            if value.path.partition(".")[0] in FRAMEWORKS or GENERATED & set(path.split(".")[1:]):
                return Dotted(path)
            found = self.find_module(value.path, unit)
            inside = self.global_name(found, attribute) if found else None
            return inside or Dotted(path)
        if isinstance(value, ModuleRef):
            inside = self.global_name(value.unit, attribute)
            if inside is not None:
                return inside
            return self.submodule(value.unit, attribute)
        return None

    def submodule(self, unit: Unit, name: str) -> Thing | None:
        """Return the module `name` of a package that is a folder, or a generated module of it."""
        key = (id(unit), name)
        if key not in self._submodules:
            self._submodules[key] = self._find_submodule(unit, name)
        return self._submodules[key]

    def _find_submodule(self, unit: Unit, name: str) -> Thing | None:
        path = unit.file.path
        if name in GENERATED:
            return Dotted(f"{path.removesuffix('/__init__.py').rpartition('/')[2]}.{name}")
        if not path.endswith("/__init__.py"):
            return None
        below = self.find_module(f".{name}", unit)
        return ModuleRef(below) if below else None
