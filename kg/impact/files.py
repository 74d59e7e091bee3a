"""What a file and a launch argument are used by, what a file declares, and lines of files that only name a thing.

No use that is found in the text alone is certain.
"""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Final

from kg.facts import FileKind, LaunchArgument, LaunchConfiguration, Location, System
from kg.impact.model import Area, Effect, FileRecord, Grade, Kind, Subject, World
from kg.render.text import count

if TYPE_CHECKING:
    from kg.launch.comparison.changes import Record


HOLDING: Final = frozenset({FileKind.CONFIG, FileKind.LAUNCH})
"""Kinds of files whose values name things of a system."""
_AREAS: Final = {
    FileKind.CONFIG: Area.TEXT,
    FileKind.LAUNCH: Area.LAUNCH,
    FileKind.CPP: Area.CODE,
    FileKind.PYTHON: Area.CODE,
    FileKind.BUILD: Area.PACKAGES,
    FileKind.PLUGIN: Area.PACKAGES,
}
_COMMENTS: Final = {"py": "#", "yaml": "#", "yml": "#", "txt": "#", "cmake": "#", "rq": "#"}
_LONGEST: Final = 60


def absolute_name(name: str) -> re.Pattern[str]:
    """Return the pattern of a whole absolute name that is no part of a longer name or of the path of a file."""
    return re.compile(rf"(?<![\w/.)}}~-]){re.escape(name)}(?![\w/.{{$-])")


def quoted(line: str) -> str:
    """Return a line of a file as an effect shows it."""
    text = " ".join(line.split())
    return f"`{text if len(text) <= _LONGEST else f'{text[: _LONGEST - 3]}...'}`"


def code_of(line: str, path: str) -> str:
    """Return a line without the comment at its end."""
    sign = _COMMENTS.get(path.rpartition(".")[2])
    if sign is not None:
        at = line.find(sign)
        is_open = at > 0 and (line.count("'", 0, at) % 2 or line.count('"', 0, at) % 2)
        return line if at < 0 or is_open else line[:at]
    if line.lstrip().startswith(("*", "/*", "<!--")):
        return ""
    if "<!--" in line:
        return line.partition("<!--")[0]
    return re.split(r"(?<!:)//", line, maxsplit=1)[0] if "//" in line else line


def mentions(
    world: World, files: Iterable[FileRecord], words: Iterable[str], pattern: re.Pattern[str], reason: str
) -> Iterator[Effect]:
    """Yield the lines of `files` that `pattern` matches outside of comments.

    Each match contains one of the `words`. Few lines do, and only these are examined.
    """
    for file in files:
        area = Area.PARAMETERS if file.path.endswith((".yaml", ".yml")) else _AREAS.get(file.kind, Area.TEXT)
        lines = world.lines(file.repository, file.path)
        for at in sorted({at for word in words for at, line in enumerate(lines) if word in line}):
            if pattern.search(code_of(lines[at], file.path)):
                location = Location(file.path, at + 1)
                yield Effect(Grade.MAY, area, quoted(lines[at]), reason, location, file.repository)


def declaring(subject: Subject, world: World) -> list[tuple[LaunchConfiguration, LaunchArgument]]:
    """Return the launch files that declare an argument."""
    return [
        (system.configuration, one)
        for system in world.systems(subject)
        for one in system.configuration.arguments
        if one.name == subject.name and subject.owner in {"", system.configuration.name}
    ]


def argument_about(subject: Subject, world: World) -> list[str]:
    """Return where an argument is declared, and its default."""
    declarations = []
    for launch, one in declaring(subject, world):
        default = "required" if one.default is None and not one.fixed else f"default {one.default or one.value}"
        declarations.append(f"{launch.name}, line {one.location.line}, {default}")
    return declarations


def argument_effects(subject: Subject, world: World) -> Iterator[Effect]:
    """Yield the lines that read an argument, and those of including files that pass it."""
    escaped = re.escape(subject.name)
    pattern = re.compile(
        rf"\$\(\s*(?:arg|var)\s+{escaped}\s*\)"
        rf"|\b(?:LaunchConfiguration(?:Equals|NotEquals)?|arg)\(\s*(?:variable_name\s*=\s*)?['\"]{escaped}['\"]"
        rf"|\blaunch_configurations\s*(?:\[|\.get\()\s*['\"]{escaped}['\"]"
    )
    for launch, argument in declaring(subject, world):
        place = argument.location.repository or launch.repository, argument.location.path
        lines = world.lines(*place)
        for number, line in enumerate(lines, 1):
            if pattern.search(code_of(line, place[1])):
                location = Location(place[1], number)
                yield Effect(Grade.BREAKS, Area.LAUNCH, quoted(line), "reads the argument", location, place[0])
        for system in world.systems(subject):
            other = system.configuration
            if not any((one.repository, one.path) == (launch.repository, launch.path) for one in other.includes):
                continue
            lines = world.lines(other.repository, other.path)
            for number, is_certain in _passing(lines, other.path, launch.path, subject.name):
                reason = "passes the argument" if is_certain else "passes an argument of this name to one of its files"
                yield Effect(
                    Grade.BREAKS if is_certain else Grade.MAY,
                    Area.LAUNCH,
                    f"{other.name} passes {subject.name}",
                    reason,
                    Location(other.path, number),
                    other.repository,
                )


def include_effects(path: str, repository: str, systems: Sequence[System], world: World) -> Iterator[Effect]:
    """Yield the launch files that include the one at `path`."""
    name = path.rpartition("/")[2]
    for system in systems:
        launch = system.configuration
        if not any((one.repository, one.path) == (repository, path) for one in launch.includes):
            continue
        certain = any(one.started.location.path == path and one.started.condition is None for one in system.instances)
        lines = world.lines(launch.repository, launch.path)
        number = next((at for at, line in enumerate(lines, 1) if name in code_of(line, launch.path)), 0)
        yield Effect(
            Grade.BREAKS if certain else Grade.MAY,
            Area.LAUNCH,
            f"{launch.name} includes it" if number else "launch files include it through others",
            "starts nodes of it" if certain else "no node of it is known to be started",
            Location(launch.path, number) if number else None,
            launch.repository,
            () if number else (launch.name,),
        )


def _passing(lines: Sequence[str], path: str, target: str, name: str) -> Iterator[tuple[int, bool]]:
    """Yield the lines of a launch file that pass an argument to `target`, and whether that is certain."""
    text = "\n".join(lines)
    base = target.rpartition("/")[2]
    if path.endswith(".py"):
        yield from _passing_python(text, base, name)
        return
    for block in re.finditer(r"<include\b.*?(?:</include>|/>)", text, re.DOTALL):
        if base not in block[0].partition(">")[0]:
            continue
        for match in re.finditer(rf"<(?:arg|let)\b[^>]*\bname\s*=\s*['\"]{re.escape(name)}['\"]", block[0]):
            yield text.count("\n", 0, block.start() + match.start()) + 1, True


def _passing_python(text: str, base: str, name: str) -> Iterator[tuple[int, bool]]:
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError):
        return
    for call in ast.walk(tree):
        if not isinstance(call, ast.Call) or "IncludeLaunchDescription" not in ast.unparse(call.func):
            continue
        is_certain = any(isinstance(one, ast.Constant) and base in str(one.value) for one in ast.walk(call))
        if not is_certain and base not in text:
            continue
        for one in ast.walk(call):
            keys = one.keys if isinstance(one, ast.Dict) else one.elts[:1] if isinstance(one, ast.Tuple) else ()
            for key in keys:
                if isinstance(key, ast.Constant) and key.value == name:
                    yield key.lineno, is_certain


_NAMING: Final = frozenset({FileKind.LAUNCH, FileKind.BUILD, FileKind.CONFIG, FileKind.CPP, FileKind.PYTHON})


def declared_subjects(subject: Subject, world: World) -> list[Subject]:
    """Return the nodes and types that a file declares."""
    place = subject.owner, subject.name
    nodes = [
        Subject(Kind.NODE, f"{one.package}/{one.node.name}")
        for one in world.nodes(subject)
        if place == (one.node.location.repository or one.repository, one.node.location.path)
    ]
    types = [
        Subject(Kind.TYPE, one.name)
        for one in world.definitions(subject)
        if place == (one.repository, one.definition.location.path)
    ]
    return [*dict.fromkeys([*nodes, *types])]


def file_about(subject: Subject, world: World) -> list[str]:
    """Return the kind of a file and what it declares."""
    place = subject.owner, subject.name
    kinds = [f"{one.kind} file of {one.package}" for one in world.files_at(subject.name) if place[0] == one.repository]
    return [*kinds, *(f"declares {one.kind} {one.text}" for one in declared_subjects(subject, world))]


def file_effects(subject: Subject, world: World) -> Iterator[Effect]:
    """Yield what is read from a file: node types, launch configurations and parameters."""
    place = subject.owner, subject.name
    for record in world.nodes(subject):
        yield from _node(record, place)
    systems = world.systems(subject)
    yield from include_effects(subject.name, subject.owner, systems, world)
    for system in systems:
        launch = system.configuration
        numbers: defaultdict[str, list[int]] = defaultdict(list)
        for instance in system.instances:
            for one in instance.parameters:
                if place == (one.set.location.repository or launch.repository, one.set.location.path):
                    numbers[instance.name].append(one.set.location.line)
        for name, lines in numbers.items() if subject.name != launch.path else ():
            yield Effect(
                Grade.BREAKS,
                Area.PARAMETERS,
                f"{name} is given {count(len(lines), 'parameter')} of it",
                "the launch file loads it",
                Location(subject.name, min(lines)),
                subject.owner,
                (launch.name,),
            )


def _node(record: Record, place: tuple[str, str]) -> Iterator[Effect]:
    node, name = record.node, f"{record.package}/{record.node.name}"
    facts = [
        *(one.location for one in node.interfaces if not one.implicit),
        *(one.location for one in node.parameters if not one.implicit),
        *(one.location for one in node.slots),
    ]
    lines = [one.line for one in facts if place == (one.repository or record.repository, one.path)]
    is_source = place[0] == record.repository and place[1] in {node.location.path, *node.sources}
    if lines or is_source:
        what = f"{name} has {len(lines)} interfaces and parameters in it" if lines else f"{name} is built from it"
        yield Effect(
            Grade.BREAKS,
            Area.CODE,
            what,
            "declares them there" if lines else "lists it as a source",
            Location(place[1], min(lines, default=0)),
            place[0],
        )
    exported = node.exported
    if exported is not None and place == (exported.repository or record.repository, exported.path):
        yield Effect(Grade.BREAKS, Area.PACKAGES, f"{name} is registered in it", "cannot be loaded", exported, place[0])


def file_mentions(subject: Subject, world: World) -> Iterator[Effect]:
    """Yield the lines of other files that name a file."""
    base = subject.name.rpartition("/")[2]
    pattern = re.compile(rf"(?<![\w.-]){re.escape(base)}(?![\w.-])")
    files = [
        one
        for one in world.files
        if one.kind in _NAMING and (one.repository, one.path) != (subject.owner, subject.name)
    ]
    yield from mentions(world, files, [base], pattern, "names a file of this name")
