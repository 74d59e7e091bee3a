"""Values of parameters that a configuration gives to an instance.

In ROS 1 they are on a server that all nodes share, by absolute names; in ROS 2 each node has its own. A parameter is
asked for by the name that code gives it.
"""

from __future__ import annotations

import json
import re
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, Final

import yaml

from kg.facts import LaunchParameter, StartedNode
from kg.holes import ANONYMOUS
from kg.names import normalise
from kg.yamltext import load_yaml

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.launch.wiring.place import Place
    from kg.launch.wiring.remapping import Remapping

ARGUMENT: Final = re.compile(r"argv\[(\d+)\]")
"""What stands for a parameter where a name is an argument of the command line, the first of which is `argv[1]`."""

OPTION: Final = re.compile(r"argv\[(-[^\]]+)\]")
"""The same for the value of an option, with all of its spellings: `argv[--namespace|-n]`."""

COMMAND_LINE: Final = "argv["
"""What both begin with."""

_PLAIN: Final = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ/_~")
_WORDS: Final = frozenset({"true", "false", "yes", "no", "on", "off", "null", "~", "y", "n"})
_LONGEST: Final = 100_000


def parsed(value: str | None) -> Any:
    """Return the value of a YAML text; a text that is not YAML is itself, None if unknown."""
    if value is None:
        return None
    text = value.strip()
    if text[:1] in _PLAIN and text.lower() not in _WORDS and not set(text) & set(":#,[]{}\"'"):
        return text
    if len(text) > _LONGEST:
        return value
    try:
        return load_yaml(text)
    except (yaml.YAMLError, ValueError, RecursionError):
        return value


def shown(value: str | None) -> str | None:
    """Return the text that a node gets for a value; None where it is not known or no single text."""
    result = parsed(value)
    if isinstance(result, str):
        return result
    return None if value is None or result is None or isinstance(result, list | dict) else value.strip()


def is_text(value: str) -> bool:
    """Return whether a value written as YAML is a text."""
    return isinstance(parsed(value), str)


class Server:
    """The parameter server of ROS 1 after the configuration has set everything; the later of two counts."""

    def __init__(self, parameters: Iterable[LaunchParameter]) -> None:
        self.all: dict[str, LaunchParameter] = {}
        for parameter in parameters:
            name = normalise(f"/{parameter.name}")
            self.all.pop(name, None)
            self.all[name] = parameter

    def shared_out(self, owners: Iterable[str]) -> tuple[dict[str, list[str]], list[str]]:
        """Return the names below each of `owners`, the longest of which counts, and the names below none."""
        names = set(owners)
        of: dict[str, list[str]] = {}
        rest: list[str] = []
        for name in self.all:
            above = name.rpartition("/")[0]
            while above and above not in names:
                above = above.rpartition("/")[0]
            (of.setdefault(above, []) if above else rest).append(name)
        return of, rest


class Settings:
    """The settings that one instance can read."""

    def __init__(self, server: Server | None, started: StartedNode, remapping: Remapping) -> None:
        self._server = server
        self._remapping = remapping
        self._started = started
        self.words: list[str] = []
        """The arguments that the program sees: ROS takes remappings, and what follows `--ros-args`, for itself."""
        for word in (part for argument in started.arguments for part in argument.split()):
            if word == "--ros-args":
                break
            if ":=" not in word:
                self.words.append(word)
        self.own = {parameter.name.removeprefix("~/").lstrip("/"): parameter for parameter in started.parameters}

    def has_unread(self, place: Place) -> bool:
        """Return whether the instance at a place has settings of unknown names, such as those of a file not read."""
        return ANONYMOUS in self.own if self._server is None else f"{place.full}/{ANONYMOUS}" in self._server.all

    @property
    def arguments(self) -> int:
        """How many arguments the program gets, those not counted that ROS takes for itself."""
        return len(self.words)

    def get(self, name: str, place: Place) -> LaunchParameter | None:
        """Return the value of a parameter that code of the instance reads as `name`.

        An argument of the command line is a parameter set at the start of the node.
        """
        if name.startswith(COMMAND_LINE):
            word = self.word(name)
            written = json.dumps(word)
            parameter = LaunchParameter(name, written, self._started.location, self._started.chain, "string")
            return parameter if word is not None else None
        if self._server is not None:
            return self._server.all.get(self._remapping.parameter(place.resolve(name.replace(".", "/"))))
        plain = name.removeprefix("~/").lstrip("/")
        prefix = _prefix(place)
        if not prefix:
            return self.own.get(plain)
        below = f"{prefix}.{plain.replace('/', '.')}"
        return self.own.get(below) if name.startswith("~") else self.own.get(below) or self.own.get(plain)

    def word(self, name: str) -> str | None:
        """Return the value of an argument or option on the command line; None if absent."""
        argument, option = ARGUMENT.fullmatch(name), OPTION.fullmatch(name)
        if argument is not None:
            index = int(argument[1])
            return self.words[index - 1] if 0 < index <= len(self.words) else None
        spellings = option[1].split("|") if option is not None else ()
        for word, following in zip_longest(self.words, self.words[1:]):
            spelling, given, value = word.partition("=")
            if spelling in spellings:
                return value if given else following
        return None

    def tree(self, name: str, place: Place) -> LaunchParameter | dict[str, Any] | None:
        """Return the value of a parameter or, if it has parts, these by their names; None if unset."""
        given = self.get(name, place)
        if given is not None:
            return given
        if self._server is not None:
            above = f"{self._remapping.parameter(place.resolve(name))}/"
            below = [(full, one) for full, one in self._server.all.items() if full.startswith(above)]
        else:
            above = ".".join(part for part in (_prefix(place), name.removeprefix("~/").strip("/")) if part) + "."
            below = [(full.replace(".", "/"), one) for full, one in self.own.items() if full.startswith(above)]
        tree: dict[str, Any] = {}
        for full, one in below:
            *parts, last = full[len(above) :].split("/")
            inside = tree
            for part in parts:
                inner = inside.setdefault(part, {})
                inside = inner if isinstance(inner, dict) else {}
            inside[last] = one
        return tree or None

    def absolute(self, name: str, place: Place) -> str:
        """Return the absolute name of a parameter that code of the instance asks for as `name`."""
        if self._server is not None:
            return self._remapping.parameter(place.resolve(name))
        return place.resolve(f"~/{name.removeprefix('~/').lstrip('/')}")

    def fitting(self, pattern: re.Pattern[str], place: Place) -> Iterator[tuple[str, LaunchParameter]]:
        """Yield the parameters whose absolute names fit a pattern, with these names."""
        if self._server is not None:
            yield from ((name, given) for name, given in self._server.all.items() if pattern.fullmatch(name))
            return
        for name, given in self.own.items():
            absolute = self.absolute(name, place)
            if pattern.fullmatch(absolute):
                yield absolute, given


def _prefix(place: Place) -> str:
    """Return the prefix of the names of a plugin's parameters in ROS 2 (`FollowPath`)."""
    private = place.private or place.full
    return private.removeprefix(f"{place.full}/").replace("/", ".") if private != place.full else ""
