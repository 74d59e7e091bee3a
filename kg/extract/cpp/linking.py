"""Resolves names of C++ at their place: namespaces, `using`, includes, classes and their members across packages."""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final, TypeAlias, TypeVar, cast

from kg.extract.cpp.specialising import same_text
from kg.symbolic.kinds import POINTER_NAME
from kg.symbolic.messages import GENERATED
from kg.symbolic.values import Enumerator

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kg.corpus.files import FilePath
    from kg.extract.cpp.macros import Macro
    from kg.extract.cpp.project import Project
    from kg.extract.cpp.units import CppFunction, CppUnit
    from kg.symbolic.form import Class, Declare, Function, Type, Unit

_Item = TypeVar("_Item")
_Scope: TypeAlias = tuple[str, ...]
Variable: TypeAlias = "tuple[Declare, CppUnit, _Scope]"
"""The declaration of a variable, with its file and scope."""
Alias: TypeAlias = "tuple[_Scope, Type, _Scope, CppUnit]"
"""Another name of a type: its scope, the type, the template parameters, and the file."""
_IMPLEMENTATION: Final = re.compile(r"(?:^|[/_-])(?:impl|inl|implementation)[/_.-]|\.(?:tpp|ipp|txx|inl|hxx)$")
"""The paths of files with the bodies of templates."""
_OF_FRAMEWORKS: Final = frozenset({"ros", "rclcpp", "rclcpp_action", "rclcpp_lifecycle", "nodelet", "tf", "tf2_ros"})
"""Namespaces whose meaning the descriptions of calls give."""
_HEADERS: Final = (".h", ".hpp", ".hh", ".hxx", ".yaml", ".yml")
"""Endings of headers, and of the YAML files of which some are made."""
_SNAKE: Final = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_PART: Final = re.compile(r"(?<=.)(?:Request|Response)(?:Const)?(?:Ptr)?\Z")
"""The suffixes of the classes that ROS 1 generates for the parts of a service."""


class Linker:
    """The names of a program: its files, and the headers of the build that they include, read on demand.

    Files of units that the methods take are those of this front end.
    """

    def __init__(self, project: Project, files: Iterable[FilePath]) -> None:
        self.project = project
        self.units: dict[FilePath, CppUnit] = {}
        self._bodies: dict[tuple[str, str], list[CppUnit]] = defaultdict(list)
        """The files that are not headers, by the kinds and names that they declare."""
        self._defining: dict[str, list[CppUnit]] = defaultdict(list)
        """The files that define methods outside of a class, by its name."""
        self._methods: dict[Class, dict[str, list[Function]]] = {}
        self._meanings: dict[tuple[object, ...], list[Any]] = {}
        self._holders: dict[tuple[str, str, Unit], tuple[CppUnit, ...]] = {}
        self._generated: dict[tuple[str, Unit, _Scope], _Scope | None] = {}
        self._macros: dict[tuple[str, Unit], Macro | None] = {}
        self._defined: set[tuple[object, ...]] = set()
        self._special: dict[tuple[_Scope, str], tuple[int, tuple[Class | None, list[Class]]]] = {}
        """Templates and their specialisations, with the number of files of which that is true."""
        for file in files:
            self.load(file)

    def load(self, file: FilePath) -> CppUnit | None:
        """Read a file into the program; None if it cannot be read."""
        if file not in self.units:
            unit = self.project.unit(file)
            if unit is None:
                return None
            self.units[file] = unit
            for kind, names in unit.names.items() if not unit.path.endswith(_HEADERS) else ():
                for name in names:
                    self._bodies[kind, name].append(unit)
            for name in unit.methods:
                self._defining[name].append(unit)
            self.project.add_unit(unit)
        return self.units[file]

    # Names

    def find_class(self, names: _Scope, unit: Unit, scope: _Scope) -> Class | None:
        """Return the class that a qualified name means in a scope of a file, of specialisations the one around it."""
        classes = self._named("class", _classes, names, unit, scope)
        if len(classes) > 1:
            around = (one for one in classes if one.pattern and one.inside == scope[: len(one.inside)])
            general = (one for one in classes if not one.pattern)
            return next(around, None) or next(general, None) or classes[0]
        return classes[0] if classes else None

    def family(self, cls: Class) -> tuple[Class | None, list[Class]]:
        """Return a class template, None if it has no body, and its specialisations in all files of the program."""
        key = (cls.scope, cls.name)
        cached = self._special.get(key)
        if cached is None or cached[0] != len(self.units):
            own = cast("CppUnit", cls.unit)
            units = dict.fromkeys(self.project.holding(own, "class", cls.name))
            for unit in self.units.values():
                units |= dict.fromkeys(self.project.holding(unit, "class", cls.name))
            listed = (one for unit in units for one in unit.classes.get(cls.name, ()))
            family = [one for one in listed if one.scope == cls.scope]
            general = next((one for one in family if not one.pattern), None)
            cached = self._special[key] = (len(self.units), (general, [one for one in family if one.pattern]))
        return cached[1]

    def find_functions(self, names: _Scope, unit: Unit, scope: _Scope) -> list[Function]:
        """Return the functions, all overloads, that a qualified name means in a scope of a file."""
        functions = self._named("function", _functions, names, unit, scope)
        if not functions and (names, unit, scope) not in self._defined:
            # A function that a header only declares is defined in a file of its package.
            self._defined.add((names, unit, scope))
            loaded = len(self.units)
            for prototype in self.find_prototypes(names, unit, scope):
                for file in self.project.implementations(prototype.unit.key, names[-1], self.units, "("):
                    self.load(file)
            if len(self.units) > loaded:
                self._meanings.pop(("function", names, unit, scope), None)
                self._holders.pop(("function", names[-1], unit), None)
                functions = self._named("function", _functions, names, unit, scope)
        return functions

    def find_prototypes(self, names: _Scope, unit: Unit, scope: _Scope) -> list[Function]:
        """Return the declarations without body that a qualified name means."""
        return self._named("prototype", _prototypes, names, unit, scope)

    def find_alias(self, names: _Scope, unit: Unit, scope: _Scope) -> Alias | None:
        """Return the meaning of the name of a type that `using` or `typedef` declares."""
        aliases = self._named("alias", _aliases, names, unit, scope)
        return aliases[0] if aliases else None

    def find_adapted(self, names: _Scope, unit: Unit) -> tuple[Type, CppUnit] | None:
        """Return the message that a type stands for, as written, with the file that states it."""
        adapted = self._named("adapted", _adapted, names, unit, ())
        return adapted[0] if adapted else None

    def find_variable(self, names: _Scope, unit: Unit, scope: _Scope) -> Variable | None:
        """Return the declaration of a variable at namespace scope, or of a static member."""
        variables = self._named("variable", _variables, names, unit, scope)
        valued = (one for one in variables if one[0].value is not None)
        defined = (one for one in variables if one[0].name not in one[1].external)
        return next(valued, None) or next(defined, None) or (variables[0] if variables else None)

    def special_variables(self, cls: Class, name: str) -> list[Variable]:
        """Return the definitions of a static member of a class template for some template arguments."""
        scope, begin = cls.scope, f"{cls.name}<"
        named = (two for one in self._holding(cls.unit, "variable", name) for two in _variables(one, name))
        return [one for at, one in named if at and at[:-1] == scope and at[-1].startswith(begin)]

    def find_macro(self, name: str, unit: Unit, line: int) -> Macro | None:
        """Return a macro that is visible at a line of a file."""
        key = (name, unit)
        if key not in self._macros:
            macros = (u.macros[name] for u in self._holding(unit, "macro", name))
            self._macros[key] = next(macros, None) or self.project.macro(name, cast("CppUnit", unit))
        macro = self._macros[key]
        while macro is not None and macro.unit is unit and macro.line > line and macro.earlier is not None:
            macro = macro.earlier
        return macro

    def find_enumerator(self, name: str, unit: Unit) -> Enumerator | None:
        """Return the constant of a name that an enumeration defines which is visible in a file."""
        units = self._holding(unit, "enumerator", name)
        return Enumerator(name, number=units[0].enumerators[name]) if units else None

    def within(self, names: _Scope, unit: Unit, scope: _Scope) -> _Scope | None:
        """Return the full name of `msg::Type`, a message of the package whose namespace is around it or used."""
        kind, name, *_ = names
        file = f"{_SNAKE.sub('_', name).lower()}.hpp"
        workspace = self.project.reader.workspace
        for package in dict.fromkeys((*scope[:1], *(used[0] for used in cast("CppUnit", unit).uses))):
            path = f"{package}/{kind}/{file}"
            if any(path in one.includes for one in self._holding(unit, "include", file)) or workspace.definition(
                package, name, kind
            ):
                return (package, *names)
        return None

    def generated(self, name: str, unit: Unit, scope: _Scope) -> _Scope | None:
        """Return the qualified name of a class, a part of it or pointers to it, whose generated header is included."""
        around = scope[:1]
        key = (name, unit, around)
        if key not in self._generated:
            self._generated[key] = next(
                (
                    (*path.split("/")[:-1], name)
                    for stem in dict.fromkeys((name, POINTER_NAME.sub("", name), _PART.sub("", name)))
                    for file in (f"{_SNAKE.sub('_', stem).lower()}.hpp", f"{stem}.h")
                    for one in self._holding(unit, "include", file)
                    for path in one.includes
                    if path.endswith("/" + file) and (name.encode() in one.source or (path.split("/")[0],) == around)
                ),
                None,
            ) or self._used(name, unit)
        return self._generated[key]

    def _used(self, name: str, unit: Unit) -> _Scope | None:
        """Return the qualified name of a class that the build generates, in a namespace that the file uses."""
        defined = self.project.reader.workspace.definition
        stem = _PART.sub("", POINTER_NAME.sub("", name))
        namespaces = (used for used in cast("CppUnit", unit).uses if used[1:] and used[-1] in GENERATED)
        return next(((*used, name) for used in namespaces if defined(used[-2], stem, used[-1])), None)

    def _holding(self, unit: Unit, kind: str, name: str) -> tuple[CppUnit, ...]:
        """Return the files, nearest first, that can give a name of a kind its meaning in a file."""
        units = self._holders.get((kind, name, unit))
        if units is None:
            own = cast("CppUnit", unit)
            units = self.project.holding(own, kind, name)
            if bodies := self._bodies.get((kind, name)):
                # A name that a header only declares is defined in another file of the program.
                units = (*units, *(one for one in bodies if one not in units))
            if not units and ((kind == "class" and own.declares(name)) or _IMPLEMENTATION.search(own.path)):
                # The whole class is in a header that other files of the program include; so are the names that the
                # bodies of templates use, in a file that their header includes at its end.
                files = [one.key for one in self.units.values()]
                units = tuple(dict.fromkeys(one for file in files for one in self.project.find(file, kind, name)))
            self._holders[kind, name, unit] = units
        return units

    def _named(
        self,
        kind: str,
        listed: Callable[[CppUnit, str], Iterable[tuple[_Scope, _Item]]],
        names: _Scope,
        unit: Unit,
        scope: _Scope,
    ) -> list[_Item]:
        """Return the nearest declarations of one kind that a qualified name means."""
        key = (kind, names, unit, scope)
        cached = self._meanings.get(key)
        if cached is not None:
            return cached
        near = self._holding(unit, kind, names[-1].partition("<")[0]) if names else ()
        if not near:
            return []
        meanings = self._meanings
        if len(names) == 1 and near is self.project.holding(cast("CppUnit", unit), kind, names[0]):
            meanings = self.project.meanings
            if key in meanings:
                return meanings[key]
        ranked: list[tuple[float, _Item]] = []
        if names[:1] == ("",):
            scope = ()
        *outer, last = [name for name in names if name]
        for wanted in self._without_aliases(tuple(outer), unit, scope):
            for one in near:
                for at, item in listed(one, last):
                    rank = _rank(at, wanted, scope, unit)
                    if rank is not None:
                        ranked.append((rank, item))
            if ranked:
                break
        best = max((rank for rank, _ in ranked), default=0.0)
        nearest = meanings[key] = [item for rank, item in ranked if rank == best]
        return nearest

    def spelled(self, names: _Scope, unit: Unit, scope: _Scope) -> _Scope:
        """Return a qualified name of a type without aliases of namespaces."""
        if len(names) == 1:
            return names
        spellings = [(*outer, names[-1]) for outer in self._without_aliases(names[:-1], unit, scope)]
        declared = (one for one in spellings if self.find_alias(one, unit, scope) or self.find_class(one, unit, scope))
        return spellings[-1] if len(spellings) == 1 else next(declared, spellings[-1])

    def _without_aliases(self, names: _Scope, unit: Unit, scope: _Scope) -> tuple[_Scope, ...]:
        """Return what the qualifiers of a name can mean without aliases of namespaces, likeliest first.

        An alias names a namespace from its own scope or from the global one. One that replaces a framework, for builds
        without it, is not followed.
        """
        for place, name in enumerate(names):
            for one in self._holding(unit, "namespace", name) if name not in _OF_FRAMEWORKS else ():
                for at, target in one.namespaces.get(name, ()):
                    rank = _rank(at, names[:place], scope, unit)
                    if rank is not None and (rank >= 1 or not at) and target != (name,):
                        rest = names[place + 1 :]
                        return tuple(dict.fromkeys(((*names[:place], *target, *rest), (*target, *rest))))
        return (names,)

    # Members

    def methods(self, cls: Class) -> dict[str, list[Function]]:
        """Return the methods of a class that have bodies, by name, also those that are defined outside of it."""
        cached = self._methods.get(cls)
        if cached is not None:
            return cached
        by_name = {name: list(functions) for name, functions in cls.methods.items()}
        self._methods[cls] = by_name
        for file in self.project.implementations(cls.unit.key, cls.name, self.units, "::"):
            self.load(file)
        inside = (*cls.scope, cls.name)
        own = cast("CppUnit", cls.unit)
        others = [one.inside[-1] for one in self.family(cls)[1]] if cls.template and not cls.pattern else []
        defining = dict.fromkeys((own, *self._defining.get(cls.name, ()), *self.project.defining(own.key, cls.name)))
        for other in defining:
            listed = other.methods.get(cls.name, ())
            fitting = [
                function
                for function in listed
                if _same(function, inside, other) and _is_of(cast("CppFunction", function), cls, others)
            ]
            # Asked in any case, so that the record of look-ups does not depend on what other packages found.
            if fitting and self._sees(other, own):
                for function in fitting:
                    function.owner = function.owner or cls
                    if cls.pattern:
                        function.scope, function.within = cls.inside, ()
            for function in listed:
                if function.owner is cls:
                    by_name.setdefault(function.name, []).append(function)
        for function in (one for functions in by_name.values() for one in functions):
            _declare(function, cls)
        self.project.add_methods(by_name)
        return by_name

    def _sees(self, one: CppUnit, other: CppUnit) -> bool:
        """Return whether one of two files includes the other, directly or not, or both are the same."""
        return one is other or other.key in self.project.headers(one.key) or one.key in self.project.headers(other.key)


def _is_of(function: CppFunction, cls: Class, others: list[str]) -> bool:
    """Return whether a method for some template arguments is one of a class, and not of another specialisation."""
    written = f"{cls.name}{function.given}"
    if cls.pattern:
        return bool(function.given) and same_text(written, cls.inside[-1])
    return not function.given or not any(same_text(written, one) for one in others)


def _declare(function: Function, cls: Class) -> None:
    """Add to a method the parts that only its declaration in the class has."""
    for declared in cls.declared.get(function.name, ()):
        if len(declared.parameters) == len(function.parameters):
            function.virtual = function.virtual or declared.virtual
            function.template = function.template or declared.template
            for own, given in zip(function.parameters, declared.parameters, strict=True):
                if own.default is None:
                    own.default = given.default
            return


def _same(function: Function, inside: _Scope, unit: CppUnit) -> bool:
    """Return whether a function outside of a class is a method of the class with these scopes."""
    first, *rest = function.scope
    return (
        _ends(inside, function.scope)
        or _repeats(function.scope, inside)
        or any((*used, *function.scope) == inside for used in unit.uses)
        or any(_ends(inside, (*target, *rest)) for _, target in unit.namespaces.get(first, ()))
    )


def _repeats(scope: _Scope, inside: _Scope) -> bool:
    """Return whether a scope is `inside` with a part twice: `a::Class::method` within the namespace `a`."""
    more = len(scope) - len(inside)
    places = range(len(inside) if more > 0 else 0)
    return any(scope[at] == scope[at + more] and inside == (*scope[:at], *scope[at + more :]) for at in places)


def _ends(scope: _Scope, part: _Scope) -> bool:
    return scope[-len(part) :] == part


def _rank(at: _Scope, wanted: _Scope, scope: _Scope, unit: Unit) -> float | None:
    """Return how near a name in the scope `at` is to a use of `wanted::name` within `scope`.

    None if the use does not mean the name.
    """
    for depth in range(len(scope), -1, -1):
        if at == (*scope[:depth], *wanted):
            return depth + 2.0
    if any(at == (*used, *wanted) for used in unit.uses):
        return 1.5
    if wanted and at[-len(wanted) :] == wanted:
        return 1.0
    return 0.5 if not wanted else None


def _classes(unit: CppUnit, name: str) -> list[tuple[_Scope, Class]]:
    stem, special, _ = name.partition("<")
    listed = unit.classes.get(stem, ())
    return [(one.scope, one) for one in listed if not special or one.inside[-1] == name]


def _functions(unit: CppUnit, name: str) -> list[tuple[_Scope, Function]]:
    return [(one.scope, one) for one in unit.functions.get(name, ())]


def _prototypes(unit: CppUnit, name: str) -> list[tuple[_Scope, Function]]:
    return [(one.scope, one) for one in unit.prototypes.get(name, ())]


def _aliases(unit: CppUnit, name: str) -> list[tuple[_Scope, Alias]]:
    return [(at, (at, kind, template, unit)) for at, kind, template in unit.aliases(name)]


def _adapted(unit: CppUnit, name: str) -> list[tuple[_Scope, tuple[Type, CppUnit]]]:
    return [(at, (message, unit)) for at, message in unit.adapted.get(name, ())]


def _variables(unit: CppUnit, name: str) -> list[tuple[_Scope, Variable]]:
    return [(at, (declared, unit, at)) for at, declared in unit.variables(name)]
