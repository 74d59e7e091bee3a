"""The modules of a build: files read once, imports, and names of message types."""

from __future__ import annotations

import builtins
import posixpath
import re
from functools import cache, cached_property
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath, PackageFolder, Place
from kg.extract.constants import Constants
from kg.extract.python.expressions import Expressions
from kg.extract.python.importing import imported
from kg.extract.python.statements import Statements
from kg.extract.python.syntax import first_error, parse
from kg.resources import table_of
from kg.symbolic.form import Block, Function, Unit

if TYPE_CHECKING:
    from tree_sitter import Node

    from kg.corpus.reading import Reader

_SEARCHED: Final = re.compile(r"^[ \t]*sys\.path\.(?:append|insert)\((.*__file__.*)\)", re.MULTILINE)
"""What is added to the search path in terms of the place of the file."""
_PARTS: Final = re.compile(r"(['\"])(.*?)\1|\bpardir\b")
_PARENT: Final = re.compile(r"\bdirname\(|\.parent\b")
_UP: Final = ".."


class PythonUnit(Unit):
    """A lowered file. `error` is the line of the first part that does not parse, `sources` as of `Expressions`."""

    def __init__(self, key: FilePath, source: bytes, sources: dict[object, Node] | None = None) -> None:
        self.key = key
        self.source = source
        self.sources = sources
        self.root: Node = parse(source).root_node
        self._statements = Statements(self, Expressions(self, sources))
        self.error = first_error(self.root)

    @property
    def is_package(self) -> bool:
        """Whether the file is that of a package, which contains other modules."""
        return self.path.endswith("/__init__.py")

    @property
    def name(self) -> str:
        """The last part of the name of the module."""
        return self.path.removesuffix("/__init__.py").removesuffix(".py").rpartition("/")[2]

    @cached_property
    def body(self) -> Block:
        """The statements of the module."""
        return self._statements.module(self.root)

    @cached_property
    def search_path(self) -> tuple[str, ...]:
        """The folders that the module adds to the search path, from where its own file is."""
        folders = []
        for added in _SEARCHED.findall(self.source.decode("utf-8", "replace")):
            parts = [_UP if quoted is None else quoted for quoted in (one[2] or None for one in _PARTS.finditer(added))]
            up = len(_PARENT.findall(added))
            folders.append(posixpath.normpath(posixpath.join(self.path, *[_UP] * up, *(p.lstrip("/") for p in parts))))
        return tuple(folders)

    @property
    def too_deep(self) -> int | None:
        """The line of the first statement, of those lowered so far, that is nested too deep to be read."""
        return self._statements.too_deep

    def lower_body(self, function: Function) -> Block:
        """Return the statements of a function of this file."""
        return self._statements.body(function, function.source)  # type: ignore[arg-type]  # a node of this file


FRAMEWORKS: Final = frozenset(
    {
        "rospy", "rclpy", "tf", "tf2_ros", "tf2_py", "actionlib", "message_filters", "diagnostic_updater",
        "dynamic_reconfigure", "interactive_markers", "bondpy", "roslib", "genpy", "image_transport", "rosgraph",
        "ddynamic_reconfigure_python", "launch", "launch_ros", "rosidl_runtime_py", "std_msgs", "numpy", "cv_bridge",
        "rostest", "rosunit",
    }
)  # fmt: skip
"""Packages that the descriptions of calls cover; their sources are not followed."""
PLAIN: Final = frozenset({"builtins", "abc", "enum", "typing", "object", "collections", "dataclasses"})
"""Packages whose classes call no methods of those that derive from them."""
_TOOLS: Final = frozenset(
    {
        "roslaunch", "rosmaster", "rosnode", "rostopic", "rosservice", "rosparam", "rosmsg",
        "rosbag", "rospkg", "genmsg", "launch_testing", "launch_testing_ros", "rosidl_parser", "roswtf",
    }
)  # fmt: skip
"""Packages of tools that create no interfaces of others; only they themselves follow their sources."""
GENERATED: Final = frozenset({"msg", "srv", "action", "cfg"})
"""Modules that are generated from interface definitions."""
BUILTINS: Final = frozenset(vars(builtins)) | {"unicode", "xrange", "raw_input", "basestring", "long", "unichr"}
_ROS_WORDS: Final = (b"rospy", b"rclpy", b"roslib", b"actionlib", b"tf2_ros", b"message_filters", b"jsk_topic_tools")
_STARTERS: Final = (
    b"init_node", b"rclpy", b"rqt_gui", b"rospy.Publisher", b"rospy.Subscriber", b"rospy.Service",
    b".create_publisher(", b".create_subscription(", b".create_service(", b".create_client(",
)  # fmt: skip
"""One of these words is in a module of every program that starts a node, or uses one that others start."""
_GENERATED_FILE: Final = re.compile(r"(?:(?<=\.msg|\.srv)|(?<=\.action))\._\w+\Z")
"""What follows the module of a kind of interface in the name of a file that the build generates for one of them."""
_SUFFIXES: Final = ("Request", "Response", "Goal", "Result", "Feedback", "Action")


def mentions_ros(source: bytes) -> bool:
    """Check whether a file can contain anything of ROS."""
    return any(word in source for word in _ROS_WORDS)


class Modules:
    """The modules that the reading of one package sees."""

    def __init__(self, reader: Reader, package: PackageFolder) -> None:
        self.reader = reader
        self.constants = Constants(reader)
        self.repository = reader.repository
        self._place = Place(reader.repository, package.path, package.name)
        self._units: dict[FilePath, PythonUnit | None] = {}
        self._outside = FRAMEWORKS | _TOOLS - {package.name}

    def is_own(self, file: FilePath) -> bool:
        """Return whether a file belongs to the package that is read."""
        return self.reader.workspace.owner(file) == self._place

    def unit(self, file: FilePath) -> PythonUnit | None:
        """Return a file; None if it cannot be read."""
        if file not in self._units:
            source = self.reader.read(file)
            unit = self._units[file] = PythonUnit(file, source) if source is not None else None
            if unit is not None and unit.error is not None:
                self.reader.problem("KG115", "part of the file does not parse as Python", file.path, unit.error)
        return self._units[file]

    def loaded(self) -> list[PythonUnit]:
        """Return the files that were read so far."""
        return [unit for unit in self._units.values() if unit is not None]

    def report(self) -> None:
        """Report the files that are nested too deep, after they were lowered."""
        for file, unit in self._units.items():
            if unit is not None and unit.too_deep is not None:
                self.reader.problem("KG114", "functions and classes are nested too deeply", file.path, unit.too_deep)

    def find(self, dotted: str, unit: PythonUnit) -> PythonUnit | None:
        """Return the module of a name as imported in a file; None if it is of a framework or not in the build."""
        if not dotted.strip("."):
            dotted += "__init__"
        elif not self._follows(dotted):
            return None
        file = self.reader.workspace.module(dotted, near=unit.key) or self._on_path(dotted, unit)
        return self.unit(file) if file and file != unit.key else None

    def _on_path(self, dotted: str, unit: PythonUnit) -> FilePath | None:
        """Return the module in a folder that a file adds to the search path, relative to itself."""
        for folder_ in unit.search_path if not dotted.startswith(".") else ():
            stem = posixpath.join(folder_, *dotted.split("."))
            for path in (f"{stem}.py", f"{stem}/__init__.py"):
                file = unit.key._replace(path=posixpath.normpath(path))
                if not file.path.startswith("..") and self.reader.workspace.is_file(file):
                    return file
        return None

    def may_start(self, unit: PythonUnit) -> bool:
        """Check whether a program can start a node: one of its modules, directly or not, names what starts one."""
        seen = {unit.key: unit.source}
        pending = [unit.key]
        while pending:
            file = pending.pop()
            if any(word in seen[file] for word in _STARTERS):
                return True
            for names, _ in imported(seen[file]):
                for dotted in names:
                    module = self.reader.workspace.module(dotted, near=file) if dotted.strip(".") else None
                    data = self.reader.read(module) if module and module not in seen and self._follows(dotted) else None
                    if module and data is not None:
                        seen[module] = data
                        pending.append(module)
        return False

    def _follows(self, dotted: str) -> bool:
        return dotted.partition(".")[0] not in self._outside

    def starred(self, name: str, modules: list[str]) -> tuple[str, ...] | None:
        """Return the full name of what `from module import *` of one of the modules outside of the build gives.

        Message types are looked up among the definitions of the build; else the name must be that of one package alone.
        """
        if not name[:1].isalpha():
            return None
        modules = [*dict.fromkeys(_GENERATED_FILE.sub("", module) for module in modules)]
        generated = [module for module in modules if module.rpartition(".")[2] in GENERATED]
        for module in generated:
            if self._defines(module, name):
                return (*module.split("."), name)
        if not name[0].isupper():
            return (*modules[0].split("."), name) if len(modules) == 1 and not generated else None
        for module in generated if len(generated) > 1 else ():
            if name in _standard_types().get(module.partition(".")[0], ()):
                return (*module.split("."), name)
        alone = len({module.partition(".")[0] for module in generated}) == 1
        others = [module for module in generated if self._may_define(module, alone=alone)]
        packages = {module.partition(".")[0] for module in others}
        return (*others[0].split("."), name) if len(packages) == 1 else None

    def _defines(self, module: str, name: str) -> bool:
        """Check whether a package of the build defines an interface; an action's messages are among the messages."""
        package, _, kind = module.rpartition(".")
        kinds = (kind, "action") if kind == "msg" else (kind,)
        suffix = next((one for one in _SUFFIXES if name.endswith(one) and name != one), "")
        return any(self.reader.workspace.definition(package, name.removesuffix(suffix), each) for each in kinds)

    def _may_define(self, module: str, *, alone: bool) -> bool:
        """Check whether a package could have interfaces that are not known here."""
        package = module.partition(".")[0]
        return self.reader.workspace.package(package) is None and (alone or package not in _standard_types())


@cache
def _standard_types() -> dict[str, frozenset[str]]:
    """Return the names of the message types that every distribution of ROS has, by package."""
    return {package: frozenset(names) for package, names in table_of("ontology", "standard_messages.toml").items()}
