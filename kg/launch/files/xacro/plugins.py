"""The plugins of simulators in robot descriptions, as facts: evaluated once for each file and its arguments."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final
from weakref import WeakKeyDictionary

from kg.facts import LaunchPlugin, LaunchProblem, LaunchProblemKind, Location, PluginValue
from kg.holes import ANONYMOUS
from kg.launch.files.ros1.parameterfile import shown
from kg.launch.files.xacro.evaluate import Description, Output, Trouble, evaluate_description

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.corpus.files import FilePath
    from kg.corpus.reading import Reader
    from kg.launch.files.access import Files

_INTERPRETERS: Final = frozenset({"python", "python2", "python3"})
_XACRO: Final = frozenset({"xacro", "xacro.py"})
_DESCRIPTIONS: Final = (".urdf", ".sdf", ".xml", ".gazebo")
_MOST_VALUE: Final = 1000
_MOST_DESCRIPTIONS: Final = 1000
"""Different descriptions, or arguments of them, that the launch files of one package may name."""
_CACHE: Final[WeakKeyDictionary[Reader, dict[object, Description]]] = WeakKeyDictionary()


@dataclass(frozen=True, slots=True)
class Read:
    """The result of the description in a parameter: its plugins, problems, and the files that were read."""

    plugins: tuple[LaunchPlugin, ...] = ()
    problems: tuple[LaunchProblem, ...] = ()
    files: tuple[FilePath, ...] = ()


class Descriptions:
    """Reads the descriptions that one configuration names."""

    def __init__(self, files: Files, root: FilePath, environment: Mapping[str, str]) -> None:
        self._files = files
        self._root = root
        self._environment = environment

    def read(self, file: FilePath, arguments: Mapping[str, str], chain: tuple[Location, ...]) -> Read:
        """Return the plugins of the description in a file; `chain` are the lines that led to it."""
        key = file, tuple(sorted(arguments.items())), tuple(sorted(self._environment.items()))
        cached = _CACHE.setdefault(self._files.reader, {})
        if key not in cached and len(cached) >= _MOST_DESCRIPTIONS:
            message = f"more than {_MOST_DESCRIPTIONS} robot descriptions are named"
            at = chain[-1] if chain else self._location(file, 1)
            return Read((), (LaunchProblem(LaunchProblemKind.LIMIT, message, at, chain[:-1]),))
        if key not in cached:
            cached[key] = evaluate_description(self._files, file, arguments, self._environment)
        description = cached[key]
        plugins = tuple(plugin for one in description.elements for plugin in self._plugins(one, (), chain))
        return Read(plugins, tuple(self._problem(one, chain) for one in description.troubles), description.files)

    def _location(self, file: FilePath, line: int) -> Location:
        return Location(file.path, line, None if file.repository == self._root.repository else file.repository)

    def _steps(self, steps: Sequence[tuple[FilePath, int]], chain: tuple[Location, ...]) -> tuple[Location, ...]:
        return *chain, *(self._location(file, line) for file, line in steps)

    def _problem(self, one: Trouble, chain: tuple[Location, ...]) -> LaunchProblem:
        place = self._location(one.file, one.line)
        return LaunchProblem(one.kind, one.message, place, self._steps(one.steps, chain), one.subject)

    def _plugins(self, item: Output, above: tuple[Output, ...], chain: tuple[Location, ...]) -> Iterator[LaunchPlugin]:
        if item.tag != "plugin" or "filename" not in item.attributes:
            for child in item.children:
                yield from self._plugins(child, (*above, item), chain)
            return
        values = [*self._values(item, "", item), *self._near(above, item)]
        yield LaunchPlugin(
            library=shown(item.attributes["filename"]).strip()[:_MOST_VALUE],
            parameter="",
            location=self._location(item.file, item.line),
            chain=self._steps(item.steps, chain),
            name=shown(item.attributes.get("name", ""))[:_MOST_VALUE] or None,
            values=tuple(values),
            condition=" and ".join(item.conditions) or None,
        )

    def _near(self, above: Sequence[Output], plugin: Output) -> Iterator[PluginValue]:
        """Yield the fields of the sensor around a plugin: its name, type and topic, and its cameras."""
        sensor = next((one for one in reversed(above) if one.tag == "sensor"), None)
        if sensor is None:
            return
        for name, text in sensor.attributes.items():
            yield self._value(f"../@{name}", text, sensor, plugin)
        for child in sensor.children:
            if child.tag in {"camera", "topic"}:
                yield self._value(f"../{child.tag}", child.text, child, plugin)
                if "name" in child.attributes:
                    yield self._value(f"../{child.tag}@name", child.attributes["name"], child, plugin)

    def _values(self, output: Output, path: str, plugin: Output) -> Iterator[PluginValue]:
        for child in output.children:
            inner = f"{path}/{child.tag}" if path else child.tag
            yield self._value(inner, child.text, child, plugin)
            for name, text in child.attributes.items():
                yield self._value(f"{inner}@{name}", text, child, plugin)
            yield from self._values(child, inner, plugin)

    def _value(self, path: str, text: str, output: Output, plugin: Output) -> PluginValue:
        """Return a value; one that may be absent is unknown."""
        sure = len(output.conditions) <= len(plugin.conditions)
        value = shown(text).strip()[:_MOST_VALUE] if sure else ANONYMOUS
        return PluginValue(path, value, self._location(output.file, output.line))


def started(words: Sequence[str]) -> Sequence[str]:
    """Return a command line from its program on, without launchers before it."""
    first = words[0].rpartition("/")[2] if words else ""
    if first == "rosrun":
        return started(words[2:])
    if first == "ros2" and words[1:2] == ["run"]:
        return started(words[3:])
    return started(words[1:]) if first in _INTERPRETERS else words


def named_description(words: Sequence[str]) -> tuple[str, dict[str, str]] | None:
    """Return the file of the description that a command line prints, and its arguments; None for all else."""
    program = words[0].rpartition("/")[2] if words else ""
    named = next((word for word in words[1:] if not word.startswith("-") and ":=" not in word), None)
    if named is None or not (program in _XACRO or (program == "cat" and named.endswith(_DESCRIPTIONS))):
        return None
    pairs = (word.partition(":=") for word in words[1:] if program in _XACRO)
    return named, {name: value for name, mark, value in pairs if mark}
