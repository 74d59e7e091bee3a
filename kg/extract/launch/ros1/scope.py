"""What is in force at a place of a launch file: namespace, arguments, remappings, private parameters, environment.

Source: roslaunch's loader, whose rules are kept where they surprise: arguments are copied into groups and not back, a
remapping is replaced by a later one of the same name, and a private parameter of an include is in force behind the
include too, but only if one was in force before it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kg.extract.launch.ros1.texts import HOLE, global_namespace, join
from kg.facts import LaunchProblemKind, Remap

if TYPE_CHECKING:
    from kg.corpus.files import FilePath
    from kg.extract.launch.ros1.parameterfile import Leaf
    from kg.extract.launch.ros1.substitute import Note
    from kg.facts import Location

__all__ = ["Given", "Place", "Private", "Scope"]


@dataclass(frozen=True, slots=True)
class Place:
    """A file that is being evaluated: the text of its folder, and the lines of the includes that led to it."""

    file: FilePath
    folder: str
    chain: tuple[Location, ...] = ()


@dataclass(frozen=True, slots=True)
class Private:
    """A parameter for the nodes that follow: its name as written, its leaves, and where it stands."""

    name: str
    leaves: tuple[Leaf, ...]
    location: Location
    chain: tuple[Location, ...]
    reason: str | None = None


@dataclass(frozen=True, slots=True)
class Given:
    """An argument that an include passes."""

    value: str
    location: Location


@dataclass(slots=True)
class Scope:
    """A level of a launch file: the file itself, a group, or a node."""

    place: Place
    namespace: str = "/"
    parent: Scope | None = None
    arguments: dict[str, str] = field(default_factory=dict)
    declared: set[str] = field(default_factory=set)
    uncertain: set[str] = field(default_factory=set)
    """Arguments whose declaration depends on what is not known: a second one is no fault."""
    private: list[Private] = field(default_factory=list)
    environment: list[tuple[str, str]] = field(default_factory=list)
    conditions: tuple[str, ...] = ()
    replaces: bool = False
    """The file was included with all arguments: what it fixes replaces what is passed."""
    remaps: list[Remap] = field(default_factory=list)

    @property
    def folder(self) -> str:
        """The text of the folder of the file."""
        return self.place.folder

    def child(self, namespace: str | None = None) -> Scope:
        """Return a scope within this one."""
        return Scope(
            place=self.place,
            namespace=global_namespace(join(self.namespace, namespace)) if namespace else self.namespace,
            parent=self,
            arguments=dict(self.arguments),
            declared=set(self.declared),
            uncertain=set(self.uncertain),
            private=self.private or [],
            environment=list(self.environment),
            conditions=self.conditions,
        )

    def add_private(self, parameter: Private) -> None:
        """Set a parameter of the nodes that follow; one of the same name is replaced."""
        self.private[:] = [one for one in self.private if one.name != parameter.name]
        self.private.append(parameter)

    def add_remap(self, remap: Remap) -> None:
        """Set a remapping; one of the same name is replaced."""
        self.remaps[:] = [one for one in self.remaps if one.source != remap.source]
        self.remaps.append(remap)

    def all_remaps(self) -> list[Remap]:
        """Return the remappings in force, those of outer scopes first."""
        levels: list[list[Remap]] = []
        scope: Scope | None = self
        while scope is not None:
            levels.append(scope.remaps)
            scope = scope.parent
        found: dict[str, Remap] = {}
        for remap in (remap for level in reversed(levels) for remap in level):
            found.pop(remap.source, None)
            found[remap.source] = remap
        return list(found.values())

    def missing(self, name: str, note: Note) -> None:
        """Record that the argument `name` is read and has no value."""
        chain = self.place.chain
        if name not in self.declared:
            note(LaunchProblemKind.UNDECLARED_ARGUMENT, f"the argument '{name}' is read and not declared", name)
        elif chain:
            message = f"{self.place.file.path} needs the argument '{name}', which the include does not give"
            note(LaunchProblemKind.MISSING_ARGUMENT, message, name)

    def declare(
        self, name: str, value: str | None, default: str | None, *, certain: bool = True
    ) -> tuple[LaunchProblemKind, str] | None:
        """Declare an argument; return what roslaunch refuses in it."""
        if name in self.declared and name not in self.uncertain and certain and not self.replaces:
            return LaunchProblemKind.MALFORMED, f"the argument '{name}' is declared twice"
        self.declared.add(name)
        if not certain:
            self.uncertain.add(name)
            if value is not None or name not in self.arguments:
                self.arguments[name] = HOLE
            return None
        if value is not None:
            if name in self.arguments and name not in self.uncertain and not self.replaces:
                message = f"the argument '{name}' is given to a file that sets it itself"
                return LaunchProblemKind.UNDECLARED_ARGUMENT, message
            self.arguments[name] = value
        elif default is not None:
            self.arguments.setdefault(name, default)
        return None
