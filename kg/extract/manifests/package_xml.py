"""package.xml in formats 1 to 3 (REP 127, 140, 149) and rosbuild's manifest.xml."""

from __future__ import annotations

import operator
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeVar

from kg.facts import Dependency, FileKind, Location, Package, Person
from kg.xmltext import line_of, parse_xml

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from lxml.etree import _Element

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader

_VALUE: Final = r"""("[^"]*"|'[^']*'|[$\w.+-]+)"""
_COMPARISON: Final = re.compile(rf"{_VALUE}\s*(<=|>=|==|!=|<|>)\s*{_VALUE}")
_INNERMOST: Final = re.compile(r"\(([^()]*)\)")
_COMPARE: Final[dict[str, Callable[[str, str], bool]]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
_TRUTHS: Final = {"True": True, "False": False}
_MOST_TEXT: Final = 1_000
_DEEPEST: Final = 50


def holds(condition: str | None, variables: Mapping[str, str]) -> bool:
    """Return whether a condition may hold; a comparison with a variable not in `variables`, or malformed, may."""
    if not condition or len(condition) > _MOST_TEXT:
        return True

    def compared(match: re.Match[str]) -> str:
        sides = [variables.get(one[1:]) if one.startswith("$") else one.strip("\"'") for one in (match[1], match[3])]
        values = [side for side in sides if side is not None]
        return str(len(values) < len(sides) or _COMPARE[match[2]](*values))

    formula = _COMPARISON.sub(compared, condition)
    try:
        for _ in range(_DEEPEST):
            formula = _INNERMOST.sub(lambda inner: str(_decided(inner[1])), formula)
        return _decided(formula)
    except KeyError:
        return True


def _decided(formula: str) -> bool:
    """Return the value of truth values that `and` and `or` join; `KeyError` for anything else."""
    return any(all(_TRUTHS[one.strip()] for one in row.split(" and ")) for row in formula.split(" or "))


Export = tuple[str, dict[str, str], str, int]
"""Element, attributes, text and line of a child of `<export>`."""

_Any = TypeVar("_Any")

_DEPENDENCIES: Final = frozenset(
    {
        "depend", "build_depend", "build_export_depend", "buildtool_depend", "buildtool_export_depend",
        "exec_depend", "run_depend", "test_depend", "doc_depend", "group_depend",
    }
)  # fmt: skip
_TOOLS: Final = {
    1: ("catkin", "rosbuild"),
    2: ("ament_cmake", "ament_python", "ament_cmake_auto", "ament_cmake_python", "ament_cmake_ros"),
}
_CLIENTS: Final = {
    1: ("roscpp", "rospy", "message_generation", "message_runtime", "nodelet", "roslib", "roslaunch"),
    2: (
        "rclcpp",
        "rclpy",
        "rosidl_default_generators",
        "rosidl_default_runtime",
        "rclcpp_components",
        "ament_index_cpp",
    ),
}


@dataclass(frozen=True, slots=True)
class Manifest:
    """A package with the exports of its manifest."""

    package: Package
    exports: tuple[Export, ...] = ()


def read_package_xml(reader: Reader, folder: PackageFolder) -> Manifest:
    """Return the manifest of a package; missing parts stay empty, malformed parts are problems."""
    root = _parse(reader, folder.manifest) if folder.manifest else None
    path = folder.manifest or folder.path
    if root is None or folder.manifest is None:
        ros, build_type = _by_build_files(reader, folder), None
        return Manifest(Package(folder.name, folder.path, ros, Location(path, 1), build_type=build_type))
    if folder.manifest.endswith("manifest.xml"):
        return _rosbuild(root, folder, path)
    needed, exported = list(_dependencies(root)), list(_exports(root))
    versions = _ros_versions(needed, exported)
    ros = max(versions) if versions else _by_build_files(reader, folder)
    dependencies, exports = tuple(_under(ros, needed)), tuple(_under(ros, exported))
    package = Package(
        name=folder.name,
        path=folder.path,
        ros=ros,
        location=Location(path, line_of(root)),
        version=_text(root, "version"),
        description=_text(root, "description"),
        format=int(attribute) if (attribute := str(root.get("format", "1"))).isdecimal() else None,
        build_type=_build_type(dependencies, exports),
        licenses=tuple(filter(None, (flat_text(element) for element in _all(root, "license")))),
        people=tuple(_people(root)),
        urls=tuple((str(e.get("type", "website")), text) for e in _all(root, "url") if (text := flat_text(e))),
        dependencies=dependencies,
        deprecated=next((text or "yes" for tag, _, text, _ in exports if tag == "deprecated"), None),
        also=next(iter(versions - {ros}), None),
    )
    return Manifest(package, exports)


def _parse(reader: Reader, path: str) -> _Element | None:
    text = reader.read(path)
    if text is None:
        return None
    result = parse_xml(text)
    if result.problem:
        code, message, line = result.problem
        reader.problem(code, f"the manifest {message}", path, line)
    return result.root


def _all(root: _Element, tag: str) -> Iterator[_Element]:
    return (element for element in root if element.tag == tag)


def flat_text(element: _Element) -> str:
    """Return the text of an element and its children, white space folded."""
    return " ".join("".join(str(part) for part in element.itertext("*")).split())


def _text(root: _Element, tag: str) -> str | None:
    return next((text for element in _all(root, tag) if (text := flat_text(element))), None)


def _people(root: _Element) -> Iterator[Person]:
    for role in ("maintainer", "author"):
        for element in _all(root, role):
            email = element.get("email")
            yield Person(flat_text(element) or str(email or ""), str(email) if email else None, role)


def _dependencies(root: _Element) -> Iterator[tuple[str | None, Dependency]]:
    """Yield the dependencies with their conditions."""
    for element in root:
        if element.tag in _DEPENDENCIES:
            name = flat_text(element)
            if name:
                yield element.get("condition"), Dependency(name, str(element.tag), line_of(element))


def _exports(root: _Element) -> Iterator[tuple[str | None, Export]]:
    """Yield the exports with their conditions."""
    for export in _all(root, "export"):
        for element in export:
            if not callable(element.tag):
                attributes = {str(key): str(value) for key, value in element.attrib.items()}
                yield element.get("condition"), (str(element.tag), attributes, flat_text(element), line_of(element))


def _under(ros: int, conditional: Iterable[tuple[str | None, _Any]]) -> Iterator[_Any]:
    """Yield the elements valid under a version of ROS."""
    variables = {"ROS_VERSION": str(ros)}
    return (value for condition, value in conditional if holds(condition, variables))


def _build_type(dependencies: tuple[Dependency, ...], exports: tuple[Export, ...]) -> str | None:
    """Return the exported build type, else that of the tool the package depends on; plain CMake is `cmake`."""
    exported = next((text for tag, _, text, _ in exports if tag == "build_type" and text), None)
    if exported:
        return exported
    tools = {dependency.name for dependency in dependencies if dependency.kind == "buildtool_depend"}
    if "catkin" in tools:
        return "catkin"
    return "ament_cmake" if any(tool.startswith("ament_cmake") for tool in tools) else "cmake"


def _ros_versions(
    needed: list[tuple[str | None, Dependency]], exported: list[tuple[str | None, Export]]
) -> frozenset[int]:
    """Return the versions of ROS that build tools show, or else client libraries; none if neither shows one."""
    for marks in (_TOOLS, _CLIENTS):
        versions = set()
        for ros in (1, 2):
            names = {dependency.name for dependency in _under(ros, needed)}
            types = {text for tag, _, text, _ in _under(ros, exported) if tag == "build_type"}
            if not (names | types).isdisjoint(marks[ros]):
                versions.add(ros)
        if versions:
            return frozenset(versions)
    return frozenset()


def _by_build_files(reader: Reader, folder: PackageFolder) -> int:
    """Return 1 or 2 by the build system that CMakeLists.txt or setup.py speak of, else by the rest of the source."""
    for name in ("CMakeLists.txt", "setup.py"):
        path = folder.join(name)
        text = reader.read(path) if reader.workspace.owner(reader.file(path)) else None
        if text and (b"ament" in text or b"rosidl_" in text):
            return 2
        if text and (b"catkin" in text or b"rosbuild" in text):
            return 1
    if folder.manifest is None and (version := _by_code(reader, folder)):
        return version
    return 2 if any(entry.path.endswith((".launch.py", ".launch.xml")) for entry in folder.files) else 1


def _by_code(reader: Reader, folder: PackageFolder) -> int | None:
    """Return the version of ROS whose client libraries the first file that names one names."""
    for entry in folder.files:
        text = reader.read(entry.path) if entry.kind in {FileKind.CPP, FileKind.PYTHON} else None
        if text and any(word in text for word in (b"rclcpp", b"rclpy")):
            return 2
        if text and any(word in text for word in (b"rospy", b"ros/ros.h")):
            return 1
    return None


def _rosbuild(root: _Element, folder: PackageFolder, path: str) -> Manifest:
    """Return the content of a manifest.xml (wiki.ros.org/Manifest)."""
    depends = tuple(
        Dependency(str(name), "depend", line_of(element))
        for element in _all(root, "depend")
        if (name := element.get("package") or element.get("stack"))
    )
    authors = next((flat_text(element) for element in _all(root, "author")), "")
    package = Package(
        name=folder.name,
        path=folder.path,
        ros=1,
        location=Location(path, line_of(root)),
        description=_text(root, "description"),
        build_type="rosbuild",
        licenses=tuple(part.strip() for part in (_text(root, "license") or "").split(",") if part.strip()),
        people=tuple(Person(name, role="author") for part in authors.split(",") if (name := part.strip())),
        urls=tuple(("website", text) for element in _all(root, "url") if (text := flat_text(element))),
        dependencies=depends,
    )
    return Manifest(package, tuple(_under(1, _exports(root))))
