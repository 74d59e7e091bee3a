"""Modules and attributes: imports of the build are run in their own scope, all others are known by their names."""

from __future__ import annotations

import ast
import builtins
import posixpath
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath
from kg.extract.launch.expressions.functions import CONSTANTS
from kg.extract.launch.expressions.functions import FUNCTIONS as PLAIN
from kg.extract.launch.expressions.texts import known, reason_of, simplify, to_text, words
from kg.extract.launch.expressions.values import (
    Choice,
    Frame,
    Function,
    Items,
    Library,
    Method,
    Module,
    Substitution,
    Table,
    Unknown,
    Words,
)
from kg.extract.launch.ros2.actions import ParameterFile
from kg.extract.launch.ros2.context import HOLE
from kg.extract.launch.ros2.python import paths
from kg.extract.launch.ros2.python.source import Broken, parse
from kg.extract.launch.ros2.python.statements import Statements
from kg.extract.launch.ros2.python.system import SYSTEM
from kg.extract.launch.ros2.python.values import ContextValue, Description, Instance, Klass, LoadedFile, PathValue

if TYPE_CHECKING:
    from kg.extract.launch.expressions.values import Value

__all__ = ["OUTSIDE", "Modules"]

OUTSIDE: Final = frozenset(
    {
        "launch",
        "launch_ros",
        "launch_testing",
        "launch_xml",
        "launch_yaml",
        "launch_param_builder",
        "ament_index_python",
        "os",
        "sys",
        "pathlib",
        "typing",
        "yaml",
        "json",
        "xacro",
        "nav2_common",
        "rclpy",
        "lifecycle_msgs",
        "moveit_configs_utils",
        "math",
        "subprocess",
        "tempfile",
        "copy",
        "re",
        "dataclasses",
        "enum",
        "unittest",
        "pytest",
        "__future__",
        "collections",
        "functools",
        "itertools",
        "random",
        "shutil",
        "time",
        "logging",
    }
)
"""First names of modules that are never looked for in the build: the tables know them, or nobody does."""


_CONSTANTS: Final[dict[str, Value]] = {
    **CONSTANTS,
    "os.sep": "/",
    "os.path.sep": "/",
    "os.pathsep": ":",
    "os.linesep": "\n",
    "sys.argv": Unknown("the command line"),
}


_MEANT: Final = frozenset(
    {
        "super", "type", "object", "property", "staticmethod", "classmethod", "hasattr", "setattr", "id", "hash",
        "input", "next", "exit", "quit", "eval", "exec",
    }
)  # fmt: skip
"""Names of Python's own that mean something to the reader besides those of functions; so do exceptions."""


class Modules(Statements):
    """The part of the interpreter that imports and finds attributes."""

    modules: dict[FilePath, Module]

    def module_named(self, dotted: str, near: Module) -> Value:
        """Return a module as imported in the module `near`."""
        file = self._module_file(dotted, near)
        return self.module(file, dotted) if file is not None else Library(dotted.lstrip("."))

    def module(self, file: FilePath, name: str) -> Module:
        """Return a module of the build, run once."""
        if file in self.modules:
            return self.modules[file]
        module = self.modules[file] = Module(file, name)
        module.scope.names.update({"__file__": self.files.text(file), "__name__": name})
        tree = parse(self.files.read(file) or b"")
        if not isinstance(tree, Broken):
            self.run_module(tree, module)
        return module

    def run_module(self, tree: ast.Module, module: Module) -> None:
        """Run the statements of a module."""
        self.depth += 1
        guards, self.guards = self.guards, []
        try:
            self.run_block(tree.body, Frame(module, module.scope))
        finally:
            self.depth -= 1
            self.guards = guards

    def _module_file(self, dotted: str, near: Module) -> FilePath | None:
        if dotted.partition(".")[0] in OUTSIDE or not dotted.strip("."):
            return None
        workspace = self.files.reader.workspace
        file = workspace.module(dotted, near=near.file)
        beside = FilePath(
            near.file.repository, posixpath.join(posixpath.dirname(near.file.path), f"{dotted.lstrip('.')}.py")
        )
        if file is None and self.files.exists(beside):
            file = beside  # launch files often extend the search path by their own folder
        return file if file != near.file else None

    def member_of_module(self, module: str, name: str, near: Module) -> Value:
        """Return a name of another module, which may be a module below it."""
        outside = Library(f"{module.lstrip('.')}.{name}".lstrip("."))
        found = self.module_named(module, near) if module.strip(".") else None
        if isinstance(found, Module) and name in found.scope.names:
            return found.scope.names[name]
        below = self._module_file(f"{module}{'' if module.endswith('.') else '.'}{name}", near)
        return self.module(below, name) if below is not None else outside

    def star(self, module: str, near: Module) -> dict[str, Value]:
        """Return all names of a module of the build; of others those that the tables know."""
        found = self.module_named(module, near)
        if isinstance(found, Module):
            return {name: value for name, value in found.scope.names.items() if not name.startswith("_")}
        return {name: Library(f"{module}.{name}") for name in self.exported(module)}

    def exported(self, module: str) -> list[str]:
        """Return the names that a module outside of the build may have and the tables know."""
        from kg.extract.launch.ros2.python.library import FUNCTIONS  # noqa: PLC0415 - which needs this module

        return [name for name in FUNCTIONS if "." not in name] if module.startswith("launch") else []

    def unbound(self, name: str) -> Value:
        """Return what a name of Python itself means."""
        path = f"builtins.{name}"
        if name in _MEANT or path in PLAIN or path in SYSTEM or _is_exception(name):
            return Library(path)
        return Unknown(f"the name `{name}` is not bound to anything known")

    def item(self, receiver: Value, key: Value, words_of: str) -> Value:
        """Return `receiver[key]`, also of the environment and of the configurations of a context."""
        if isinstance(receiver, Library):
            name = known(key, self.context)
            if receiver.path == "os.environ" and name is not None:
                return Words((Substitution("env", ((name,),)),))
            return Unknown(f"`{words_of}` is known only when it runs")
        if isinstance(receiver, Method) and isinstance(receiver.receiver, ContextValue):
            return self.configuration(receiver.receiver, known(key, self.context))
        return super().item(receiver, key, words_of)

    def configuration(self, receiver: ContextValue, name: str | None) -> Value:
        """Return `context.launch_configurations[name]`."""
        if receiver.context is None or name is None:
            return Unknown("a launch configuration is read where none is known")
        value = receiver.context.configuration(name)
        if value is None:
            return Unknown(f"the launch configuration `{name}` is not set")
        return words(value, f"the launch configuration `{name}` is not known", HOLE)

    def attribute(self, receiver: Value, name: str) -> Value:
        """Return an attribute of a value."""
        if isinstance(receiver, Library):
            path = f"{receiver.path}.{name}"
            return _CONSTANTS.get(path, Library(path))
        if isinstance(receiver, Module):
            missing = self.member_of_module(receiver.name, name, receiver) if name not in receiver.scope.names else None
            return receiver.scope.names.get(name, missing)
        if isinstance(receiver, Instance | Klass):
            return self._of_class(receiver, name)
        if isinstance(receiver, Description) and name == "entities":
            return receiver.entities
        if isinstance(receiver, PathValue):
            return self._path_attribute(receiver, name)
        if isinstance(receiver, Choice):
            return Choice(tuple((condition, self.attribute(each, name)) for condition, each in receiver.options))
        if isinstance(receiver, Unknown):
            return receiver
        kinds = (str, Words, Items, tuple, Table, LoadedFile, Description, ContextValue, Method, ParameterFile)
        return (
            Method(receiver, name)
            if isinstance(receiver, kinds) or name == "evaluate"
            else self._unknown(receiver, name)
        )

    def _unknown(self, receiver: Value, name: str) -> Unknown:
        return Unknown(f"the attribute `{name}`: {reason_of(receiver)}")

    def _of_class(self, receiver: Instance | Klass, name: str) -> Value:
        if isinstance(receiver, Instance) and name in receiver.attributes:
            return receiver.attributes[name]
        klass = receiver.klass if isinstance(receiver, Instance) else receiver
        found, value = klass.find(name)
        if not found:
            return Unknown(f"`{klass.name}` has no attribute `{name}` that is known")
        if not isinstance(value, Function) or isinstance(value.node, ast.Lambda):
            return value
        marks = {each.id for each in value.node.decorator_list if isinstance(each, ast.Name)}
        if "staticmethod" in marks:
            return value
        if "classmethod" in marks:
            return self.bound(value, klass)
        if isinstance(receiver, Klass):
            return value
        method = self.bound(value, receiver)
        if "property" in marks:
            return self.invoke(method, [], {}, ast.Constant(None), Frame(value.module, value.scope))
        return method

    def bound(self, function: Function, receiver: Value) -> Function:
        """Return a function as a method of an object."""
        return replace(function, receiver=receiver, bound=True)

    def _path_attribute(self, receiver: PathValue, name: str) -> Value:
        if name == "parent":
            return PathValue(paths.parent(receiver.text))
        if name == "parents":
            found: list[Value] = []
            text = receiver.text
            for _ in range(8):
                text = paths.parent(text)
                found.append(PathValue(text))
            return tuple(found)
        if name in {"name", "stem", "suffix"}:
            last = paths.base(receiver.text)
            if isinstance(last, Words) or name == "name":
                return last
            return posixpath.splitext(last)[0 if name == "stem" else 1]
        return Method(receiver, name)

    def normal_path(self, value: Value) -> Value:
        """Return a path without `..`."""
        text = paths.normal(simplify(to_text(value)))
        return PathValue(text) if isinstance(value, PathValue) else text

    def find_file(self, text: str) -> FilePath | None:
        """Return the file that a path names, where the build or an installed package has it."""
        file = self.files.at(text)
        return file if file is not None and self.files.exists(file) else None

    def exists(self, value: Value) -> Value:
        """Return whether a file exists; what is not in the build may still be there when it runs."""
        text = known(value, self.context)
        if text is not None and self.find_file(text) is not None:
            return True
        return Unknown(f"whether the file {text or 'named here'} exists")


def _is_exception(name: str) -> bool:
    kind = getattr(builtins, name, None)
    return isinstance(kind, type) and issubclass(kind, BaseException)
