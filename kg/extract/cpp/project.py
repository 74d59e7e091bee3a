"""The files of C++ that the extraction of one package sees: its own, and on demand those of other packages.

The header of a parameter library (`generate_parameter_library`) is made of its YAML file and has the path of that.
Files are read through `kg.corpus.reading.Reader`, which records them. Parsed files of other packages are
kept for the next package of the same process, within a bound.
"""

from __future__ import annotations

import re
from collections import OrderedDict, defaultdict
from functools import lru_cache
from itertools import chain, islice
from typing import TYPE_CHECKING, Any, Final, cast

from kg.corpus.files import FilePath, PackageFolder, Place
from kg.extract.constants import Constants
from kg.extract.cpp.macros import DECLARING, Macro, Registrations
from kg.extract.cpp.units import COMMENT, CppClass, CppFunction, CppUnit, assigned_in, words_of
from kg.extract.manifests import read_build
from kg.extract.parameters import listener
from kg.facts import FileKind
from kg.symbolic.form import Class, Function
from kg.symbolic.reach import Reach

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator

    from kg.corpus.reading import Reader
    from kg.extract.buildmodel import BuildModel
    from kg.symbolic.descriptions import Descriptions

FRAMEWORKS: Final = frozenset(
    {
        "autoware_agnocast_wrapper", "autoware_component_interface_utils", "roscpp", "rclcpp", "rclcpp_lifecycle",
        "rclcpp_action", "rclcpp_components", "image_transport", "message_filters", "tf", "tf2", "tf2_ros",
        "actionlib", "nodelet", "dynamic_reconfigure", "diagnostic_updater", "bondcpp", "bond", "pluginlib",
        "class_loader", "camera_info_manager", "interactive_markers", "pcl_ros", "point_cloud_transport",
        "realtime_tools", "self_test", "roslib", "rosconsole", "rostime", "roscpp_core", "roscpp_serialization",
        "roscpp_traits", "cpp_common", "xmlrpcpp", "rosbag", "rosbag_storage", "topic_tools_interface", "cv_bridge",
        "image_geometry", "laser_geometry", "tf2_eigen", "tf2_geometry_msgs", "tf2_sensor_msgs", "tf2_kdl",
        "tf_conversions", "eigen_conversions", "rcutils", "rmw", "rcl", "rcpputils", "rosidl_runtime_cpp",
        "ament_index_cpp", "lifecycle_msgs", "hardware_interface_testing",
    }
)  # fmt: skip
"""Packages that the descriptions of calls cover; their headers are never read."""
_CALLED: Final = re.compile(r"\b([A-Za-z_]\w*)\s*\(")
COVERED: Final = FRAMEWORKS | {"ros", "std", "boost", "auto"}
"""Namespaces of code outside of the sources that does nothing with a node that no description names."""

_OF_ROS: Final = frozenset(
    {
        *(
            f"ros/{name}.h"
            for name in ("ros", "node_handle", "publisher", "subscriber", "service_client", "service_server")
        ),
        "rclcpp/rclcpp.hpp",
        "rclcpp/node.hpp",
    }
)
"""Headers of the frameworks that projects copy, for builds without ROS; a copy is never read either."""

_INCLUDED: Final = re.compile(rb"^[ \t]*#[ \t]*include[ \t]*[<\"]([^>\"\n]+)", re.MULTILINE)
_DEFINED: Final = re.compile(rb"^[ \t]*#[ \t]*define[ \t]+(\w+)", re.MULTILINE)
_LEFT_OUT: Final = re.compile(rb"^[ \t]*//+[ \t]*#[ \t]*define[ \t]+(\w+)[ \t]*(?://.*)?\r?$", re.MULTILINE)
"""A macro without a value whose definition is a comment: a switch that is off."""
_GENERATOR: Final = b"generate_parameter_library"
_CACHE_BYTES: Final = 12 << 20
_MOST_HEADERS: Final = 600
_MARKS: Final = b"_:("
_NAMES: Final = bytes(code if code < 128 and (chr(code).isalnum() or code in _MARKS) else 32 for code in range(256))  # noqa: PLR2004 - ASCII
"""A table that replaces by spaces what is not part of a name, `::` or `(`."""
_OF_TEMPLATE: Final = re.compile(rb"(\w+)<[^;{}()<>]*(?:<[^;{}()<>]*>[^;{}()<>]*)*>\Z")
"""A name with template arguments."""
_LONGEST: Final = 200
"""So many bytes before a `::` are searched for such a name."""


class _Cache:
    """Units with their contents, kept for later packages until they are those least recently used."""

    def __init__(self) -> None:
        self._units_by_file: OrderedDict[FilePath, tuple[bytes, CppUnit]] = OrderedDict()
        self._bytes = 0

    def get(self, file: FilePath, content: bytes, ros: int, absent: frozenset[str]) -> CppUnit | None:
        """Return the unit of a file with these contents, as a package of ROS 1 or 2 without some macros compiles it."""
        cached = self._units_by_file.get(file)
        if cached is None or cached[0] != content or (cached[1].ros, cached[1].absent) != (ros, absent):
            return None
        self._units_by_file.move_to_end(file)
        return cached[1]

    def keep(self, content: bytes, unit: CppUnit) -> None:
        """Add a unit, and evict others."""
        self._bytes += len(content) - len(self._units_by_file.pop(unit.key, (b"",))[0])
        self._units_by_file[unit.key] = (content, unit)
        while self._bytes > _CACHE_BYTES and len(self._units_by_file) > 1:
            self._bytes -= len(self._units_by_file.popitem(last=False)[1][0])


_cache: Final = _Cache()


class Project:
    """The C++ of one package and its includes."""

    def __init__(self, reader: Reader, package: PackageFolder, build: BuildModel, calls: Descriptions) -> None:
        self.reader = reader
        self.constants = Constants(reader)
        self.reach = Reach(calls, self)
        self.revision = 0
        self._methods: dict[str, dict[int, Function]] = defaultdict(dict)
        """The methods of classes that programs of the package use, by name."""
        self._used: dict[FilePath, CppUnit] = {}
        """The files of all programs of the package."""
        self._declared_in: dict[tuple[str, str], list[CppUnit]] = defaultdict(list)
        """These files by the functions, classes and aliases in them."""
        self._definable: set[str] = set()
        """The names of functions and classes of all programs and of the headers that they include."""
        self._defined: dict[str, tuple[int, tuple[Function | Class, ...]]] = {}
        """What names stand for, with the revision of which that is true."""
        self._words: dict[Function | Class, tuple[int, frozenset[str]]] = {}
        """The words in some code, with the number of expansions for which that is true."""
        self._expansions = 0
        self._mentioned: dict[str, tuple[int, int] | None] = {}
        """How many files of programs and headers do not contain a word; None if another one does."""
        self.package = package
        self.repository = reader.repository
        self.ros = build.ros
        self._build = build
        self._undefined: frozenset[str] | None = None
        self._place = Place(reader.repository, package.path, package.name)
        self._units: dict[FilePath, CppUnit | None] = {}
        self._alone: list[CppUnit] = []
        """The sources of the package, which are not kept for others."""
        self._headers: dict[FilePath, tuple[FilePath, ...]] = {}
        self._direct: dict[FilePath, tuple[FilePath, ...]] = {}
        self._nearness: dict[FilePath, dict[CppUnit, int]] = {}
        self._holding: dict[tuple[str, str, CppUnit], tuple[CppUnit, ...]] = {}
        """The files that can give a name of a kind its meaning in a file."""
        self.meanings: dict[tuple[object, ...], list[Any]] = {}
        """What names mean that are declared in these files alone: the same in all programs of the package."""
        self._listed: dict[CppUnit, None] = {}
        """The headers in the index that follows."""
        self._stand_for: dict[str, frozenset[str]] = defaultdict(frozenset)
        """The words that the macros, and the other names of types, of these and of all programs stand for, by name."""
        self._declaring: dict[tuple[str, str], list[CppUnit]] = defaultdict(list)
        self._implementations: dict[Place, dict[bytes, list[FilePath]]] = {}
        """For each package its sources, by the names in them with the `::` or `(` that follows."""
        self._libraries = {self._place: self._headers_of(self._place, build)}
        """The YAML files of parameter libraries by the names of their headers, for each package."""
        self._converted: dict[FilePath, bytes] = {}
        """The headers made of YAML files, and the sources whose macros that register classes are expanded."""
        contents = {file: data for file in self.sources() if (data := reader.read(file)) is not None}
        registrations = Registrations([*contents.values(), *self._headers_with_macros(contents)])
        for file, data in contents.items():
            if (expanded := registrations.expanded(data)) is not data:
                self._converted[file] = expanded

    def _headers_with_macros(self, contents: dict[FilePath, bytes]) -> Iterator[bytes]:
        """Yield the headers of other packages that define macros which files call as declarations."""
        called = {file: names for file, data in contents.items() if (names := DECLARING.findall(data))}
        own = {name for data in contents.values() for name in _DEFINED.findall(data)} if called else set[bytes]()
        for file, names in called.items():
            if not own.issuperset(names):
                paths = _INCLUDED.findall(contents[file])
                headers = (self.include(file, path.decode("utf-8", "replace")) for path in paths)
                yield from filter(None, map(self._content, filter(None, headers)))

    def close(self) -> None:
        """Free what was read, before a collection of cycles does; the project cannot be used any more."""
        vars(self.reach).clear()
        for unit in self._alone:
            vars(unit).clear()
        vars(self).clear()

    def own(self, path: str) -> FilePath:
        """Return the key of a file of this source."""
        return FilePath(self.repository, path)

    def is_own(self, file: FilePath) -> bool:
        """Return whether a file belongs to the package that is read."""
        return self.reader.workspace.owner(file) == self._place

    def sources(self) -> list[FilePath]:
        """Return the C++ files of the package."""
        return [self.own(entry.path) for entry in self.package.files if entry.kind is FileKind.CPP]

    def unit(self, file: FilePath) -> CppUnit | None:
        """Return the parsed file; None if it cannot be read."""
        if file not in self._units:
            data = self._content(file)
            self._units[file] = None if data is None else self._parse(file, data)
        return self._units[file]

    def _parse(self, file: FilePath, data: bytes) -> CppUnit:
        own = self.is_own(file)  # always looked up: the record must not depend on the cache
        undefined = self._absent() if own else self._build.absent
        absent = frozenset(name for name in undefined if name.encode() in data)
        cached = _cache.get(file, data, self.ros, absent)
        if cached is not None:
            return cached
        unit = CppUnit(file, data, self.ros, absent)
        if not own or not _is_source(file.path):
            _cache.keep(data, unit)
        else:
            self._alone.append(unit)
        return unit

    def _absent(self) -> frozenset[str]:
        """Return the macros without a definition: those of the build files, and those whose `#define` is a comment."""
        if self._undefined is None:
            left_out, defined = set[bytes](), set[bytes]()
            for data in map(self._content, self.sources()):
                if data is not None and b"define" in data:
                    left_out.update(_LEFT_OUT.findall(data))
                    defined.update(_DEFINED.findall(data))
            undefined = {name.decode() for name in left_out - defined}
            self._undefined = frozenset(self._build.absent) | undefined.difference(self._build.defined)
        return self._undefined

    def macro(self, name: str, unit: CppUnit) -> Macro | None:
        """Return the macro that the build files define with a text, for a file; None for other names."""
        text = dict(self._build.values).get(name)
        return Macro(unit, name, None, text, 0) if text is not None else None

    def contains(self, file: FilePath, word: bytes) -> bool:
        """Return whether a file contains some bytes."""
        data = self._content(file)
        return data is not None and word in data

    def include(self, file: FilePath, path: str) -> FilePath | None:
        """Return what `#include "path"` means in `file`, unless it is of a framework or not in the build."""
        header = self.reader.workspace.include(path, near=file)
        if header is None:
            return self._parameter_library(file, path)
        owner = self.reader.workspace.owner(header)
        of_framework = owner is not None and owner.name in FRAMEWORKS
        if owner != self._place and (of_framework or path.partition("/")[0] in FRAMEWORKS):
            return None
        return None if path in _OF_ROS and not of_framework else header

    def _content(self, file: FilePath) -> bytes | None:
        return self._converted[file] if file in self._converted else self.reader.read(file)

    def _parameter_library(self, file: FilePath, path: str) -> FilePath | None:
        """Return the YAML file of the parameter library whose header `path` is, `library.hpp` or `package/library.hpp`.

        Its content is the header from then on.
        """
        folder, _, name = path.rpartition("/")
        workspace = self.reader.workspace
        home = workspace.package(folder, near=file.repository) if folder else workspace.owner(file)
        if home is None or not name.endswith(".hpp"):
            return None
        if home not in self._libraries:
            package = workspace.folder(home)[1]
            makefile = self.reader.read(FilePath(home.repository, package.join("CMakeLists.txt")))
            build = read_build(self.reader, package) if _GENERATOR in (makefile or b"") else None
            self._libraries[home] = self._headers_of(home, build) if build is not None else {}
        source = self._libraries[home].get(name)
        if source is not None and source not in self._converted:
            self._converted[source] = listener(self.reader.read(source) or b"", source.path)
        return source

    def _headers_of(self, place: Place, build: BuildModel) -> dict[str, FilePath]:
        return {f"{name}.hpp": FilePath(place.repository, yaml) for name, yaml in build.parameter_libraries}

    def _includes(self, file: FilePath) -> tuple[FilePath, ...]:
        direct = self._direct.get(file)
        if direct is None:
            unit = self.unit(file)
            headers = (self.include(file, path) for path in (unit.includes if unit is not None else ()))
            direct = self._direct[file] = tuple(dict.fromkeys(header for header in headers if header is not None))
        return direct

    def headers(self, file: FilePath) -> tuple[FilePath, ...]:
        """Return all headers of the build that a file includes, directly or not, nearest first."""
        headers = self._headers.get(file)
        if headers is None:
            seen = {file: None}
            pending = [file]
            while pending and len(seen) < _MOST_HEADERS:
                level = [header for current in pending for header in self._includes(current)]
                pending = [header for header in dict.fromkeys(level) if header not in seen]
                seen.update(dict.fromkeys(pending))
            headers = self._headers[file] = tuple(seen)[1:]
        return headers

    # For `Reach`: names without their scopes, of all programs of the package

    def add_unit(self, unit: CppUnit) -> None:
        """Add a file of a program."""
        if unit.key not in self._used:
            self._used[unit.key] = unit
            self.revision += 1
            for kind in ("function", "inline", "class", "alias"):
                for name in unit.names[kind]:
                    self._declared_in[kind, name].append(unit)
            self._index(unit)

    def add_methods(self, methods: dict[str, list[Function]]) -> None:
        """Add the methods of a class that a program uses."""
        for name, functions in methods.items():
            present = self._methods[name]
            before = len(present)
            present.update((id(one), one) for one in functions)
            self.revision += len(present) > before
        self._add_names(methods)

    def words(self, code: Function | Class) -> frozenset[str] | None:
        """Return the identifiers in the code of a function, or in what the creation of an object runs."""
        expansions, words = self._words.get(code, (-1, frozenset()))
        if expansions != self._expansions:
            unit = cast("CppUnit", code.unit)
            self._near(unit.key)  # which makes its headers known
            if isinstance(code, (CppFunction, CppClass)):
                words = code.words
            else:
                words = words_of(unit.code(cast("Function", code)))
            if words:
                words = self._expanded(words.union(*unit.uses))
            self._words[code] = (self._expansions, words)
        return words

    def _expanded(self, words: frozenset[str]) -> frozenset[str]:
        """Return some words, and those of what macros and other names of types among them stand for."""
        new = words
        while names := new & self._stand_for.keys():
            new = frozenset().union(*(self._stand_for[name] for name in names)) - words
            words |= new
        return words

    def assigned(self, code: Function | Class) -> frozenset[str]:
        """Return the names of variables and fields that the code of a function changes."""
        if isinstance(code, CppFunction):
            return code.assigned
        return assigned_in(cast("CppUnit", code.unit).code(code)) if isinstance(code, Function) else frozenset()

    def called(self, code: Function) -> frozenset[str]:
        """Return the names of what the code of a function calls, not those in its texts."""
        text = code.code if isinstance(code, CppFunction) else cast("CppUnit", code.unit).code(code)
        return frozenset(_CALLED.findall(COMMENT.sub(" ", text)))

    def definitions(self, words: frozenset[str]) -> Iterator[Function | Class]:
        """Yield the functions and classes of the programs that have one of some names.

        They are in an order of their own: with that of the set, other files would be looked up in each process.
        """
        for word in sorted(words & self._definable):
            revision, result = self._defined.get(word, (-1, ()))
            if revision != self.revision:
                result = tuple(self._definitions(word))
                self._defined[word] = (self.revision, result)
            yield from result

    def _definitions(self, word: str) -> Iterator[Function | Class]:
        yield from self._methods.get(word, {}).values()
        for units in (self._declaring, self._declared_in):
            for unit in units.get(("function", word), ()):
                yield from unit.functions[word]
            for unit in units.get(("inline", word), ()):
                for cls in (one for name in sorted(unit.inline[word]) for one in unit.classes.get(name, ())):
                    yield from cls.methods.get(word, ())
            for unit in tuple(units.get(("class", word), ())):
                yield from unit.classes[word]
                for file in self.implementations(unit.key, word, self._used, "::"):
                    parsed = self.unit(file)
                    yield from parsed.functions.get(word, ()) if parsed is not None else ()

    def is_alias(self, word: str) -> bool:
        """Check whether a word is also declared as another name of something."""
        return ("alias", word) in self._declaring or ("alias", word) in self._declared_in

    def mentions(self, word: str) -> bool:
        """Check whether a file of a program contains a word."""
        without = self._mentioned.get(word, (0, 0))
        if without is not None:
            used, listed = without  # files are only added, so only the new ones are searched
            units = chain(islice(self._used.values(), used, None), islice(self._listed, listed, None))
            mentioned = any(word.encode() in one.source for one in units)
            self._mentioned[word] = None if mentioned else (len(self._used), len(self._listed))
        return self._mentioned[word] is None

    # Names

    def implementations(self, header: FilePath, name: str, seen: Container[FilePath], end: str) -> list[FilePath]:
        """Return the sources of the package of a header that contain a name followed by `end`, except for `seen` ones.

        They define the methods of a class if `end` is `::`, or a function if it is `(`.
        """
        owner = self.reader.workspace.owner(header)
        if owner is None:
            return []
        index = self._implementations.get(owner)
        if index is None:
            index = self._implementations[owner] = defaultdict(list)
            for entry in self.reader.workspace.files(owner, FileKind.CPP):
                file = FilePath(owner.repository, entry.path)
                data = self._content(file) if _is_source(entry.path) else None
                for word in _followed(data) if data else ():
                    index[word].append(file)
        sources = index.get(f"{name}{end}".encode(), ())
        return [file for file in sources if file != header and file not in seen]

    def find(self, file: FilePath, kind: str, name: str) -> list[CppUnit]:
        """Return the headers of a file that declare a name of a kind, nearest first; see `CppUnit.names`."""
        near = self._near(file)
        listed = self._declaring.get((kind, name))
        if not listed:
            return []
        units = [one for one in listed if one in near]
        return sorted(units, key=near.__getitem__) if len(units) > 1 else units

    def holding(self, unit: CppUnit, kind: str, name: str) -> tuple[CppUnit, ...]:
        """Return those of a file and its headers that declare a name of a kind, nearest first.

        All programs of the package get the same object.
        """
        key = (kind, name, unit)
        units = self._holding.get(key)
        if units is None:
            near = self.find(unit.key, kind, name)
            own = (unit,) if name in unit.names[kind] else ()
            units = self._holding[key] = (*own, *(one for one in near if one is not unit))
        return units

    def defining(self, file: FilePath, name: str) -> list[CppUnit]:
        """Return the headers of a file that define methods outside of their class, which has a name."""
        return [one for one in self._near(file) if name in one.methods]

    def _near(self, file: FilePath) -> dict[CppUnit, int]:
        """Return the headers of a file that can be read, each with its place in the order of nearness."""
        nearness = self._nearness.get(file)
        if nearness is None:
            units = (self.unit(header) for header in self.headers(file))
            nearness = self._nearness[file] = {one: place for place, one in enumerate(units) if one is not None}
            for one in nearness:
                if one not in self._listed:
                    self._listed[one] = None
                    for kind, names in one.names.items():
                        for name in names:
                            self._declaring[kind, name].append(one)
                    self._index(one)
        return nearness

    def _index(self, unit: CppUnit) -> None:
        """Add what the macros and other names of types in a file stand for, and the names that it defines."""
        for name, words in unit.stand_for:
            self._expansions += not words <= self._stand_for[name]
            self._stand_for[name] |= words
        self._add_names((*unit.functions, *unit.inline, *unit.classes))

    def _add_names(self, names: Iterable[str]) -> None:
        self._definable.update(name for name in names if name != "main")


@lru_cache(maxsize=512)  # the sources of a library are searched for each package that uses it
def _followed(source: bytes) -> frozenset[bytes]:
    """Return the names in a source with the `::` or `(` that follows, also after template arguments."""
    spaced = source.translate(_NAMES).replace(b"::", b":: ").replace(b"(", b"( ")
    names = frozenset(word for word in spaced.split() if word.endswith((b"::", b"(")))
    ends = (one.end() - len(b"::") for one in re.finditer(b">::", source))
    templates = (_OF_TEMPLATE.search(source, max(0, end - _LONGEST), end) for end in ends)
    return names.union(one[1] + b"::" for one in templates if one is not None)


def _is_source(path: str) -> bool:
    return path.endswith((".cpp", ".cc", ".cxx", ".c++", ".hxx", "_impl.hpp", "_impl.h", ".C", ".tpp", ".ipp"))
