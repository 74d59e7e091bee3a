"""The code of one node: what can run from its entry, by the names that the code mentions.

A function is reached when its name stands in code that is reached; a method when, besides, its class is
live, that is, mentioned in reached code. Methods that override those of a base class are reached with their
class, and so are all methods of a class with a base that is not in the build, since that base may call them.
This is coarser than a call graph and needs no types; it keeps apart the executables that share sources.
"""

from __future__ import annotations

from collections import deque
from itertools import takewhile
from typing import TYPE_CHECKING

from kg.extract.cpp import syntax

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from tree_sitter import Node

    from kg.corpus.files import FilePath
    from kg.extract.cpp.project import Project
    from kg.extract.cpp.unit import Class, Function, Unit

__all__ = ["Program"]

_MOST_UNITS = 500


class Program:
    """The units, classes and functions of a node, and which of them are reached.

    `closed` names the classes that are never entered because a table knows what they make.
    """

    def __init__(self, project: Project, closed: frozenset[str]) -> None:
        self.project = project
        self.units: dict[FilePath, Unit] = {}
        self.live: dict[Class, None] = {}
        self.reached: dict[Function, None] = {}
        self.words: set[str] = set()
        self._entries: set[Function] = set()
        self._closed = closed
        self._aliases: dict[str, list[tuple[Unit, Node]]] = {}
        self._elsewhere: dict[str, list[FilePath]] = {}
        """Headers that were left out and give these names to types."""
        self._classes: dict[str, list[Class]] = {}
        self._functions: dict[str, list[Function]] = {}
        self._methods: dict[str, list[Function]] = {}
        self._owners: dict[Function, Class | None] = {}
        self._found: dict[tuple[FilePath, str], Class | None] = {}
        self._bases: dict[Class, tuple[list[Class], bool]] = {}
        self._queue: deque[tuple[frozenset[str], Unit, tuple[str, ...]]] = deque()

    def load(self, files: Iterable[FilePath]) -> None:
        """Add source files with the headers that bear on interfaces."""
        for file in files:
            unit = self.project.unit(file)
            if unit is None:
                continue
            self._add(unit)
            for header in self.project.headers(file):
                if header in self.units or len(self.units) >= _MOST_UNITS:
                    continue
                if self.project.relevant(header):
                    found = self.project.unit(header)
                    if found is not None:
                        self._add(found)
                else:
                    for name in self.project.alias_names(header):
                        self._elsewhere.setdefault(name, []).append(header)

    def _add(self, unit: Unit) -> None:
        if unit.file in self.units:
            return
        self.units[unit.file] = unit
        self._found.clear()
        for cls in unit.classes:
            self._classes.setdefault(cls.name, []).append(cls)
        for function in unit.functions:
            self._functions.setdefault(function.name, []).append(function)
            if function.owner is not None:
                self._methods.setdefault(function.owner, []).append(function)
        self._add_homes(unit)
        for name, kinds in unit.aliases.items():
            free = [(unit, kind) for kind in kinds if _at_namespace_scope(unit, kind)]
            self._aliases.setdefault(name, []).extend(free)
            if name in self.words:
                self._follow(name, free)
        for cls in unit.classes:
            if cls.name in self.words and self._meant(cls):
                self._enliven(cls)
        for function in unit.functions:
            self._consider(function)

    def _meant(self, cls: Class) -> bool:
        """Tell whether reached code that mentions the name of a class can mean that class."""
        places: list[Function | Class] = [*self.reached, *self.live]
        return len(self._classes[cls.name]) == 1 or any(
            self.find_class(cls.name, place.unit, place.scope) is cls for place in places if cls.name in place.words
        )

    def _add_homes(self, unit: Unit) -> None:
        """Add the headers of the classes whose methods a unit defines."""
        for name in dict.fromkeys(f.owner for f in unit.functions if f.inside is None and f.owner is not None):
            if name not in self._classes:
                for header in self.project.find(unit.file, name):
                    if any(cls.name == name for cls in header.classes):
                        self._add(header)

    def start(self, function: Function) -> None:
        """Reach a function, and all that follows from it."""
        self._entries.add(function)
        self._reach(function)
        self._run()

    def start_class(self, cls: Class) -> None:
        """Reach every method of a class that a framework makes and calls, and all that follows."""
        self._enliven(cls)
        for function in self.methods(cls):
            self._entries.add(function)
            self._reach(function)
        self._run()

    def start_globals(self, unit: Unit) -> None:
        """Reach what the objects at namespace scope of a unit are made of."""
        for node in unit.captured("global"):
            declarator = node.child_by_field_name("declarator")
            if declarator is not None and declarator.type != "function_declarator":
                self._queue.append((unit.words(node.start_byte, node.end_byte), unit, ()))
        self._run()

    def _run(self) -> None:
        while self._queue:
            words, unit, scope = self._queue.popleft()
            for word in sorted(words.intersection(self._classes)):
                one = self._classes[word]
                cls = one[0] if len(one) == 1 else self.find_class(word, unit, scope)
                if cls is not None:
                    self._enliven(cls)
            for word in sorted(words - self.words):
                self.words.add(word)
                self._follow(word, self._aliases.get(word, ()))
                self._open(word)
                for function in tuple(self._functions.get(word, ())):
                    self._consider(function)

    def _follow(self, name: str, kinds: Iterable[tuple[Unit, Node]]) -> None:
        """Reach what types are called by a name that reached code mentions (`typedef Filter<Ekf> EkfNode`)."""
        for unit, kind in kinds:
            words = unit.words(kind.start_byte, kind.end_byte) - {name}
            self._queue.append((words, unit, unit.scope_at(kind.start_byte)))

    def _open(self, name: str) -> None:
        """Add the headers that give types a name and have nothing else to do with nodes."""
        for header in self._elsewhere.pop(name, ()):
            unit = self.project.unit(header) if len(self.units) < _MOST_UNITS else None
            if unit is not None:
                self._add(unit)

    def _reach(self, function: Function) -> None:
        if function not in self.reached:
            self.reached[function] = None
            self._queue.append((function.words, function.unit, function.scope))

    def is_entry(self, function: Function) -> bool:
        """Tell whether a reached function runs without a call in the code: as entry, constructor or override."""
        if function in self._entries:
            return True
        cls = self.owner(function)
        return cls is not None and self._called_by_others(function, cls)

    def _consider(self, function: Function) -> None:
        if function in self.reached:
            return
        cls = self.owner(function)
        named = function.name in self.words
        if cls is not None:
            if cls in self.live and (named or self._called_by_others(function, cls)):
                self._reach(function)
        elif named and function.name != "main":
            self._reach(function)

    def _called_by_others(self, function: Function, cls: Class) -> bool:
        if function.name == cls.name or function.name.startswith(("~", "operator")):
            return True
        bases, complete = self.bases(cls)
        if not complete:
            return True
        return any(function.name in base.fields or self._called_by_others(function, base) for base in bases)

    def _enliven(self, cls: Class) -> None:
        if cls in self.live or cls.name in self._closed:
            return
        self.live[cls] = None
        self._queue.append((cls.words, cls.unit, (*cls.scope, cls.name)))
        for base in self.bases(cls)[0]:
            self._enliven(base)
        if not cls.unit.file.path.endswith((".cpp", ".cc", ".cxx")):
            for file in self.project.implementations(cls.unit.file, cls.name, self.units):
                if file not in self.units and cls.unit.file in self.project.headers(file):
                    self.load([file])
        for function in self.methods(cls):
            self._consider(function)

    def bases(self, cls: Class) -> tuple[list[Class], bool]:
        """Return the base classes that are in the build, and whether these are all."""
        known = self._bases.get(cls)
        if known is None:
            self._bases[cls] = known = ([], False)
            nodes = cls.bases
            found = [self.find_class(syntax.simple_name(node), cls.unit) for node in nodes]
            present = [base for base in found if base is not None and base is not cls]
            known = self._bases[cls] = (present, len(present) == len(nodes))
        return known

    def family(self, cls: Class) -> Iterator[Class]:
        """Yield a class and its bases in the build, the class first."""
        seen = {cls: None}
        pending = [cls]
        while pending:
            current = pending.pop(0)
            yield current
            for base in self.bases(current)[0]:
                if base not in seen:
                    seen[base] = None
                    pending.append(base)

    def derived(self, cls: Class) -> list[Class]:
        """Return the live classes that derive from a class, directly or not."""
        return [other for other in self.live if other is not cls and any(base is cls for base in self.family(other))]

    def methods(self, cls: Class) -> list[Function]:
        """Return the functions with bodies of a class."""
        return [function for function in self._methods.get(cls.name, ()) if self.owner(function) is cls]

    def functions(self, name: str, near: Unit | None = None) -> list[Function]:
        """Return the loaded functions of a name; if there are none, those in the headers of the unit `near`."""
        found = self._functions.get(name, [])
        if not found and near is not None:
            for header in self.project.find(near.file, name):
                found = [function for function in header.functions if function.name == name]
                if found:
                    self._functions[name] = found
                    break
        return found

    def owner(self, function: Function) -> Class | None:
        """Return the class that a function is a method of."""
        if function.inside is not None:
            return function.inside
        if function.owner is None:
            return None
        if function not in self._owners:
            self._owners[function] = self.find_class(function.owner, function.unit, function.scope[:-1])
        return self._owners[function]

    def find_class(self, name: str, near: Unit, scope: tuple[str, ...] = ()) -> Class | None:
        """Return the class that `name` means in the unit `near`; loaded units first, then headers on demand."""
        key = (near.file, "::".join((*scope, name)))
        if key not in self._found:
            self._found[key] = self._find_class(name, near, scope)
        return self._found[key]

    def _find_class(self, name: str, near: Unit, scope: tuple[str, ...]) -> Class | None:
        headers = self.project.headers(near.file)
        candidates = [cls for cls in self._classes.get(name, ()) if cls.unit is near or cls.unit.file in headers]
        if not candidates:
            candidates = [
                cls for unit in self.project.find(near.file, name) for cls in unit.classes if cls.name == name
            ]
        if not candidates:
            others = self._classes.get(name, ())
            candidates = [cls for cls in others if not cls.unit.file.path.endswith((".cpp", ".cc", ".cxx"))]
        return max(candidates, key=lambda cls: (cls.unit is near, _shared(cls.scope, scope)), default=None)

    def sites(self, name: str) -> Iterator[tuple[Unit, Node]]:
        """Yield where a word stands in reached functions, live classes and at namespace scope."""
        for unit in tuple(self.units.values()):
            for node in unit.occurrences(name):
                if self.runs(unit, node.start_byte):
                    yield unit, node

    def runs(self, unit: Unit, at: int) -> bool:
        """Tell whether the code at a byte of a unit is reached."""
        function = unit.function_at(at)
        if function is not None:
            return function in self.reached
        cls = unit.class_at(at)
        return cls is None or cls in self.live


def _at_namespace_scope(unit: Unit, node: Node) -> bool:
    return unit.class_at(node.start_byte) is None and unit.function_at(node.start_byte) is None


def _shared(one: tuple[str, ...], other: tuple[str, ...]) -> int:
    """Return how many names at the beginning or at the end of two scopes agree."""
    ahead = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(one, other, strict=False)))
    behind = takewhile(lambda pair: pair[0] == pair[1], zip(reversed(one), reversed(other), strict=False))
    return max(ahead, sum(1 for _ in behind))
