"""Values of Python launch files besides those of every expression; actions are those of `ros2.actions`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.values import Object, TextLike
from kg.extract.launch.ros2.python.paths import join_paths

if TYPE_CHECKING:
    from kg.corpus.files import FilePath
    from kg.extract.launch.expressions.values import Items, Scope, Text, Value, Words
    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.context import Context

__all__ = [
    "IGNORED",
    "ContextValue",
    "Description",
    "Ignored",
    "Instance",
    "Klass",
    "LoadedFile",
    "PathValue",
    "Source",
]


@dataclass(slots=True, eq=False)
class Klass:
    """A class of the build with the bases that it has."""

    name: str
    scope: Scope
    bases: tuple[Value, ...] = ()
    dataclass_fields: tuple[str, ...] = ()

    def find(self, name: str, depth: int = 8) -> tuple[bool, Value]:
        """Return whether the class or a base of the build has an attribute, and its value."""
        if name in self.scope.names:
            return True, self.scope.names[name]
        for base in self.bases if depth else ():
            if isinstance(base, Klass) and (found := base.find(name, depth - 1))[0]:
                return found
        return False, None


@dataclass(slots=True, eq=False)
class Instance(Object):
    """An object of a class of the build."""

    klass: Klass
    attributes: dict[str, Value] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class PathValue(TextLike):
    """A `pathlib.Path`."""

    text: str | Words

    def as_text(self) -> str | Words:
        """Return the path."""
        return self.text

    def below(self, other: Value) -> PathValue:
        """Return a path below this one."""
        return PathValue(join_paths([self.text, other]))


@dataclass(frozen=True, slots=True, eq=False)
class LoadedFile:
    """An open file; `text` None where it cannot be read, for the `reason`."""

    text: str | None
    file: FilePath | None = None
    reason: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class ContextValue:
    """The `LaunchContext` of an `OpaqueFunction`; None where the launch file makes one itself."""

    context: Context | None


@dataclass(slots=True, eq=False)
class Description(Object):
    """A `LaunchDescription`."""

    entities: Items


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """A `LaunchDescriptionSource`: the path of a launch file, or a description made in place."""

    path: Text | None
    reason: str | None = None
    actions: tuple[Action, ...] | None = None


class Ignored:
    """An action or event that starts nothing and sets nothing."""


IGNORED: Final = Ignored()
