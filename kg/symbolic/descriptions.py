"""Descriptions of framework calls: the files `ontology/calls/*.toml`, and those that users add.

docs/calls.md lists the columns. `kg.symbolic.effects` applies the descriptions.
"""

from __future__ import annotations

import tomllib
from collections import defaultdict
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Any, Final

from kg.facts import Access, Role
from kg.resources import folder
from kg.symbolic.columns import ACCESSES, MOST_ARGUMENTS

_ROLES: Final = {role.value: role for role in Role}
_ACCESSES: Final = dict(zip(ACCESSES, (Access.READ, Access.WRITE, Access.DECLARE), strict=True))


@dataclass(frozen=True, slots=True)
class Effect:
    """An interface or a parameter that a call creates, by the indexes of its arguments."""

    role: Role | None = None
    access: Access | None = None
    name: int | None = None
    fixed: str | None = None
    value: str | float | bool | None = None
    """The default of a parameter where no argument has it."""
    types: tuple[str, ...] = ()
    qos: int | None = None
    default: int | None = None
    output: int | None = None
    prefix: int | str | None = None
    """The argument with the prefix of names; a text is the label of a prefix that the loader of a plugin gives."""
    listed: bool = False
    weak: bool = False
    camera: bool = False
    implicit: bool = False
    depth: int | None = None
    """The depth of the queue where the call gives none."""
    transport: int | None = None
    """The first argument that can have the transport of images, which decides on the name and the type."""
    specification: int | str | None = None
    """The argument whose template argument is a class with the name, the type and the quality of service.

    `template` if it is the template argument of the call.
    """
    descriptor: int | None = None
    """The argument with the descriptor of the parameter, which may allow values of any type."""
    ros: int = 0
    """The version of ROS of the description; 0 for either."""


@dataclass(frozen=True, slots=True)
class SlotDescription:
    """What a call loads plugins for. In texts `{N}` is argument N, `{T}` the first template argument."""

    base: str | None = None
    """The class that the plugins are loaded as. The methods of an object have that of its constructor."""
    plugin: int | None = None
    """The argument with the class of the plugin."""
    name: int | None = None
    """The argument with the name of the plugin."""
    parameter: str | None = None
    """The parameter with the class, with `{id}` for the name of the plugin."""
    names: str | None = None
    """The parameter with the names of the plugins."""
    module: int | None = None
    """The argument with the name of a module, which is no plugin if the name is known."""
    reason: str | None = None
    """Why the code does not give the class."""


@dataclass(frozen=True, slots=True)
class PortDescription:
    """A port of a node of behavior trees that a call reads or declares, by the indexes of its arguments."""

    name: int
    default: int | None = None
    """The argument with the value that the port has by default."""
    output: int | None = None
    """The argument that receives the value."""


@dataclass(frozen=True, slots=True)
class CallDescription:
    """A function or method of a framework."""

    names: tuple[str, ...]
    on: tuple[str, ...] = ()
    scopes: tuple[str, ...] = ()
    least: int = 0
    most: int = MOST_ARGUMENTS
    effects: tuple[Effect, ...] = ()
    node: int | str | None = None
    returns: str | None = None
    node_name: int | None = None
    mark: str | None = None
    copies: tuple[int, int] | None = None
    loads: bool = False
    """Whether it loads the nodelet that its second argument names."""
    options: bool = False
    """Whether it stores the interface in its object, for a call that receives the object."""
    parameters: tuple[str, ...] = ()
    """The names of its parameters in order, for arguments by name."""
    creates: int | None = None
    """The argument with a class of which it creates an object."""
    slot: SlotDescription | None = None
    registers: int | None = None
    """The argument with the name under which it registers a node of behavior trees."""
    port: PortDescription | None = None

    @property
    def has_effect(self) -> bool:
        """Whether a fact follows from the call, or the creation of an object."""
        given = (self.effects, self.mark, self.slot, self.port, self.loads)
        return any(given) or not self.creates is self.registers is self.node_name is None


@dataclass(frozen=True, slots=True)
class ClassDescription:
    """A class of a framework."""

    name: str
    is_a: str = ""
    like: str | None = None
    """Another class whose methods it has."""
    node_name: int | None = None
    runs: tuple[str, ...] = ()
    effects: tuple[Effect, ...] = ()
    node: int | str | None = None
    least: int = 0
    most: int = MOST_ARGUMENTS
    mark: str | None = None
    gives: tuple[tuple[str, int, tuple[tuple[int, str], ...]], ...] = ()
    """The node handles that it passes to its methods: name, number of parameters, and index with namespace."""
    members: tuple[tuple[str, str], ...] = ()
    """Members that it sets to node handles, with their namespaces."""
    unless: int | None = None
    """The argument that turns the effects off if it is `false`."""
    replaces: bool = False
    """Whether the description is used even if the sources of the class are in the build."""
    parameters: tuple[str, ...] = ()
    namespace: int | None = None
    """The argument with the namespace of the node."""
    detail: int | None = None
    """The argument that the mark takes with it."""
    under: int | None = None
    """The argument with the namespace of the mark."""
    options: bool = False
    """Whether its constructor stores the interface in the object, for a call that receives the object."""
    slot: SlotDescription | None = None

    @property
    def has_effect(self) -> bool:
        """Whether a fact follows from the creation of an object."""
        return self.is_a == "node" or any((self.effects, self.mark, self.slot, self.runs))


@dataclass
class Descriptions:
    """All descriptions for one language, by the last part of the described name."""

    language: str = "cpp"
    calls: dict[str, list[CallDescription]] = field(default_factory=lambda: defaultdict(list))
    classes: dict[str, list[ClassDescription]] = field(default_factory=lambda: defaultdict(list))
    silent_methods: set[str] = field(default_factory=set)
    """Methods of publishers that publish nothing."""
    _resolved: dict[tuple[str, ...], ClassDescription | None] = field(default_factory=dict, repr=False)

    def read(self, text: str) -> None:
        """Add the descriptions of a file."""
        data = tomllib.loads(text)
        if data.get("language", "cpp") != self.language:
            return
        ros = data.get("ros", 0)
        self.silent_methods.update(data.get("silent_methods", ()))
        for row in data.get("class", ()):
            for name in _names(row):
                self.classes[name.rpartition("::")[2]].append(_class(name, row, ros))
        for row in data.get("call", ()):
            described = _call(row, ros)
            for name in described.names:
                self.calls[name].append(described)

    @cached_property
    def effects(self) -> dict[str, list[tuple[tuple[frozenset[str], ...], frozenset[str]]]]:
        """The names of calls and classes with effects, with the words that each description needs.

        The code has all words of a scope in front of the name; the program has the name of one of the classes, or of
        one that has a node of its own.
        """
        classes_of_hosts = (one for classes in self.classes.values() for one in classes if one.node == "host")
        hosts = frozenset(one.name.rpartition("::")[2] for one in classes_of_hosts)
        effects: dict[str, list[tuple[tuple[frozenset[str], ...], frozenset[str]]]] = defaultdict(list)
        for name, calls in self.calls.items():
            for call in calls:
                if call.has_effect:
                    scopes = tuple(frozenset(scope.split("::")) - {"*"} for scope in call.scopes)
                    on = frozenset(one.rpartition("::")[2] for one in call.on)
                    effects[name].append((scopes, on | hosts if on else on))
        for name, classes in self.classes.items():
            for one in classes:
                if one.has_effect:
                    scope = frozenset(one.name.split("::")[:-1][:1])
                    effects[name].append(((scope,) if scope else (), frozenset()))
        return dict(effects)

    def class_named(self, names: tuple[str, ...]) -> ClassDescription | None:
        """Return the description of a class by its qualified name; the namespaces that both have must agree."""
        # Programs construct the same few classes many times.
        if names not in self._resolved:
            listed = self.classes.get(names[-1] if names else "", ())
            described = next((one for one in listed if agree(tuple(one.name.split("::")), names)), None)
            self._resolved[names] = described or self._presumed(names)
        return self._resolved[names]

    def _presumed(self, names: tuple[str, ...]) -> ClassDescription | None:
        """Return the description of a managed node of an unknown library: `other::RobotLifecycleNode`.

        Such a library gives its node methods of its own that the transitions call: `handle_on_configure`.
        """
        if not names or not is_managed(names[-1]) or self.language != "cpp":
            return None
        managed = next(iter(self.classes.get(_MANAGED, ())), None)
        return (
            replace(managed, node_name=None, namespace=None, runs=tuple(f"*{name}" for name in managed.runs))
            if managed is not None
            else None
        )


_MANAGED: Final = "LifecycleNode"


def is_managed(name: str) -> bool:
    """Check whether a class is a managed node by its name."""
    return name.endswith(_MANAGED)


def agree(described: tuple[str, ...], names: tuple[str, ...]) -> bool:
    """Check whether two qualified names have the same namespaces, as far as both have them."""
    count = min(len(described), len(names))
    return described[-count:] == names[-count:]


def _effects(row: dict[str, Any], ros: int) -> tuple[Effect, ...]:
    found = []
    for key, value in row.items():
        if key in _ROLES or key in _ACCESSES:
            for entry in value if isinstance(value, list) else [value]:
                given = dict(entry)
                types = tuple(given.pop("type", ()))
                found.append(Effect(_ROLES.get(key), _ACCESSES.get(key), types=types, ros=row.get("ros", ros), **given))
    return tuple(found)


def _names(row: dict[str, Any]) -> list[str]:
    return row["name"] if isinstance(row["name"], list) else [row["name"]]


def _call(row: dict[str, Any], ros: int) -> CallDescription:
    copies = row.get("copies")
    return CallDescription(
        tuple(_names(row)),
        on=tuple(row.get("on", ())),
        scopes=tuple(row.get("in", ())),
        returns=row.get("returns"),
        copies=(copies[0], copies[1]) if copies else None,
        loads=row.get("loads", False),
        creates=row.get("creates"),
        registers=row.get("registers"),
        port=PortDescription(**row["port"]) if "port" in row else None,
        **_common(row, ros),
    )


def _class(name: str, row: dict[str, Any], ros: int) -> ClassDescription:
    return ClassDescription(
        name,
        is_a=row.get("is", ""),
        like=row.get("like"),
        runs=tuple(row.get("runs", ())),
        gives=tuple(
            (one["method"], one["arguments"], tuple((int(k), v) for k, v in one["handles"].items()))
            for one in row.get("gives", ())
        ),
        members=tuple(row.get("members", {}).items()),
        unless=row.get("unless"),
        replaces=row.get("replaces", False),
        namespace=row.get("namespace"),
        detail=row.get("detail"),
        under=row.get("under"),
        **_common(row, ros),
    )


def _common(row: dict[str, Any], ros: int) -> dict[str, Any]:
    """Return what calls and classes have both, by the names of the fields."""
    least, most = row.get("arguments", (0, MOST_ARGUMENTS))
    slot = row.get("slot")
    if slot is not None:
        slot = SlotDescription(**{"plugin" if key == "class" else key: value for key, value in slot.items()})
    return {
        "least": least,
        "most": most,
        "effects": _effects(row, ros),
        "node": row.get("node"),
        "node_name": row.get("node_name"),
        "mark": row.get("mark"),
        "options": row.get("options", False),
        "parameters": tuple(row.get("parameters", ())),
        "slot": slot,
    }


def shipped(language: str = "cpp") -> Descriptions:
    """Return the descriptions for a language that come with kg."""
    return _read(tuple(sorted((folder("ontology") / "calls").glob("*.toml"))), language)


@cache
def _read(files: tuple[Any, ...], language: str) -> Descriptions:
    descriptions = Descriptions(language)
    for file in files:
        descriptions.read(file.read_text(encoding="utf-8"))
    return descriptions


@cache
def merged(texts: tuple[str, ...], language: str = "cpp") -> Descriptions:
    """Return the shipped descriptions for a language, after those of other files, which take precedence.

    The texts have no errors (`kg.symbolic.checking`).
    """
    result = Descriptions(language)
    for text in texts:
        result.read(text)
    base = shipped(language)
    for name, calls in base.calls.items():
        result.calls[name] += calls
    for name, classes in base.classes.items():
        result.classes[name] += classes
    result.silent_methods |= base.silent_methods
    return result
