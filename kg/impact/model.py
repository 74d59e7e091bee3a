"""Impact as values: the subject of a change, what it reaches, how certain that is and why."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Final, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from kg.facts import Dependency, FileKind, InterfaceDefinition, Location, System
    from kg.launch.comparison.changes import Record


class Kind(StrEnum):
    """What can be changed."""

    TOPIC = "topic"
    SERVICE = "service"
    ACTION = "action"
    TYPE = "type"
    FIELD = "field"
    PARAMETER = "parameter"
    NODE = "node"
    ARGUMENT = "argument"
    FILE = "file"


CHANNELS: Final = frozenset({Kind.TOPIC, Kind.SERVICE, Kind.ACTION})


@dataclass(frozen=True, slots=True, order=True)
class Subject:
    """What is changed.

    `name` is absolute for channels and started nodes, `package/Type` for types, `package/node` for node types, a path
    for files. `owner` is the type of a field, the node of a parameter (empty for all nodes), the launch file of an
    argument as `package/path`, or the source of a file.
    """

    kind: Kind
    name: str
    owner: str = ""

    @property
    def text(self) -> str:
        """The name as `kg impact` takes it."""
        if self.kind in {Kind.FIELD, Kind.PARAMETER} and self.owner:
            return f"{self.owner}.{self.name}"
        if self.owner and self.kind in {Kind.ARGUMENT, Kind.FILE}:
            return f"{self.owner}:{self.name}"
        return self.name


class Grade(StrEnum):
    """How certain an effect is."""

    BREAKS = "breaks"
    MAY = "may"


class Area(StrEnum):
    """Where an effect shows."""

    SYSTEMS = "started nodes"
    CODE = "code"
    DEFINITIONS = "definitions"
    LAUNCH = "launch files"
    PARAMETERS = "parameter files"
    PACKAGES = "packages"
    TEXT = "other files"


@dataclass(frozen=True, slots=True)
class Effect:
    """One thing that breaks or may break: `what` it is, and the `reason`.

    `systems` are the launch files, as `package/path`, in which that is so. `started` is the line that starts the node.
    """

    grade: Grade
    area: Area
    what: str
    reason: str
    location: Location | None = None
    repository: str = ""
    systems: tuple[str, ...] = ()
    started: Location | None = None

    @property
    def key(self) -> tuple[str, ...]:
        """What names the effect in two states of the sources, whose lines may differ."""
        return str(self.area), self.what, self.location.path if self.location else ""


def launch_effect(  # noqa: PLR0913, PLR0917 - the parts of an effect
    system: System, grade: Grade, area: Area, what: str, reason: str, location: Location
) -> Effect:
    """Return an effect in one launch configuration."""
    launch = system.configuration
    return Effect(grade, area, what, reason, location, location.repository or launch.repository, (launch.name,))


def code_effect(record: Record, grade: Grade, what: str, reason: str, location: Location) -> Effect:
    """Return an effect in the code of a node type."""
    return Effect(grade, Area.CODE, what, reason, location, location.repository or record.repository)


class Graded:
    """Something with effects."""

    __slots__ = ()
    effects: tuple[Effect, ...]

    @property
    def is_breaking(self) -> bool:
        """Whether something breaks for certain."""
        return self.count(Grade.BREAKS) > 0

    def count(self, grade: Grade) -> int:
        """Return the number of effects of a grade."""
        return sum(one.grade is grade for one in self.effects)


@dataclass(frozen=True, slots=True)
class Impact(Graded):
    """The effects of a change to a subject, the certain ones of each area first; `about` describes the subject."""

    subject: Subject
    about: tuple[str, ...]
    effects: tuple[Effect, ...]


@dataclass(frozen=True, slots=True)
class PackageRecord:
    """A package: its source, name, folder and some of its dependencies, with the path of its manifest."""

    repository: str
    name: str
    folder: str
    manifest: str
    dependencies: tuple[Dependency, ...] = ()


@dataclass(frozen=True, slots=True)
class DefinitionRecord:
    """A definition of a source; `embeds` maps its fields that hold messages, as `section/name`, to `package/Type`."""

    repository: str
    definition: InterfaceDefinition
    embeds: Mapping[str, str]

    @property
    def name(self) -> str:
        """`package/Type`."""
        return f"{self.definition.package}/{self.definition.name}"


@dataclass(frozen=True, slots=True)
class FileRecord:
    """A file of a package; `repository` is empty for a file of the user outside of all sources."""

    repository: str
    package: str
    path: str
    kind: FileKind


class World(Protocol):
    """The sources that a change may reach."""

    def nodes(self, subject: Subject) -> Sequence[Record]:
        """Return the node types that may have to do with a subject, at least."""
        ...

    def definitions(self, subject: Subject) -> Sequence[DefinitionRecord]:
        """Return the definitions of messages, services and actions that may have to do with a subject, at least."""
        ...

    def dependents(self, package: str) -> Sequence[PackageRecord]:
        """Return the packages that depend on one, each with its dependencies on that."""
        ...

    @property
    def files(self) -> Sequence[FileRecord]:
        """The files of packages that can be read, and files of the user that hold names (rules, queries, programs)."""
        ...

    def files_at(self, path: str) -> Sequence[FileRecord]:
        """Return the files of this path, of any source, whether they can be read or not."""
        ...

    def systems(self, subject: Subject) -> Sequence[System]:
        """Return the launch configurations that may have to do with a subject, at least."""
        ...

    def lines(self, repository: str, path: str) -> Sequence[str]:
        """Return the lines of a file, none if it cannot be read."""
        ...


def merged(effects: Iterable[Effect]) -> tuple[Effect, ...]:
    """Return each effect once, with its strongest grade and the launch files where that holds, in order of areas."""
    by_place: dict[object, Effect] = {}
    for effect in effects:
        key = effect.area, effect.what, effect.location, effect.repository
        earlier = by_place.setdefault(key, effect)
        if earlier.grade is effect.grade:
            by_place[key] = replace(earlier, systems=tuple(sorted({*earlier.systems, *effect.systems})))
        elif effect.grade is Grade.BREAKS:
            by_place[key] = effect
    return tuple(sorted(by_place.values(), key=_order))


def _order(effect: Effect) -> tuple[object, ...]:
    place = (effect.location.path, effect.location.line) if effect.location else ("", 0)
    return tuple(Area).index(effect.area), effect.grade is Grade.MAY, *place, effect.what, effect.repository
