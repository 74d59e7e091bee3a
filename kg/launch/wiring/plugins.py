"""The plugins that a node loads by its parameters, and the places of their declarations.

The table is `ontology/plugins.toml`; its head explains it.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any, Final

from kg.facts import TREE_NODE, Interface, NodeKind, NodeType, PluginSlot, Resolution
from kg.holes import Hole, hole_of, is_partial, parse, partition, substitute
from kg.launch.wiring.place import Place
from kg.launch.wiring.plugin_table import rows
from kg.launch.wiring.types import NodeTypes, Typed, class_name
from kg.launch.wiring.values import parsed
from kg.names import normalise

_CLASS: Final = re.compile(r"[A-Za-z]\w*(?:(?:::|/)[A-Za-z]\w*)+")
_OWN_ID: Final = re.compile(r"~/\{(\w+)\}/")
"""The begin of a private name of a plugin whose code puts the plugin's id in front of it."""
_CLASS_KEYS: Final = ("type", "plugin")
_LISTS: Final = ("plugins", "_ids", "filters", "navigators")


@dataclass(frozen=True, slots=True)
class Framework:
    """A row of the table; its head explains the fields."""

    base: str
    ros: int
    source: str
    private: str = "~/{id}"
    foreign: tuple[str, ...] = ()
    handed: Mapping[str, str] = field(default_factory=dict)
    each: str | None = None
    below: str = "{id}"
    chosen: str | None = None
    otherwise: str | None = None
    loader: tuple[str, ...] = ()
    starter: tuple[str, ...] = ()
    node: bool = False


@dataclass(frozen=True, slots=True)
class Loaded:
    """A plugin that an instance loads under the name `id`; `scope` is the prefix of the parameter that loads it.

    `found` is None for a class that the build does not have.
    """

    id: str
    class_name: str
    scope: str
    typed: Typed | None
    framework: Framework
    parameter: str
    """The parameter that says so, relative to the node (`global_costmap/plugins`)."""

    def place(self, node: Place) -> Place:
        """Return the base of the plugin's names."""
        pattern = self.framework.private
        if self.scope.startswith("/"):  # the program that names the plugin has parameters outside of the node
            pattern = pattern.removeprefix("~/")
        return Place(node.namespace, node.name, node.resolve(self._filled(pattern)))

    def handed(self, declared: Interface) -> Interface:
        """Return an interface with the arguments that the node hands to the plugin in its name.

        If the name differs, it is relative to the node: the code puts the id in front, and not the framework.
        """
        name = self.spelled(declared.name or (hole_of(declared.written or "") if declared.parameter is None else ""))
        if name is None:
            return declared
        return replace(declared, name=name, resolution=Resolution.PARTIAL if is_partial(name) else Resolution.CONSTANT)

    def read_as(self, parameter: str, node: Place) -> tuple[str, Place]:
        """Return what a parameter of the plugin's code is called in the node, and the place that it is relative to."""
        spelled = self.spelled(parameter)
        if spelled is not None:
            return spelled, node
        own = below_id(parameter) if self.typed is not None and self.typed[1].ros != 1 else None
        return parameter if own is None else f"~/{own}", self.place(node)

    def of_element(self, parameter: str | None) -> str | None:
        """Return what a parameter is called below an element of the plugin's list (`topic`); None for others."""
        match parse(self.spelled(parameter or "") or parameter or ""):
            case (_, *_, Hole(), str(rest)) if rest.startswith(("/", ".")):
                return rest[1:]
        return None

    def spelled(self, name: str) -> str | None:
        """Return a name with values for the arguments that the node hands to the plugin; None if it has none."""
        given = self.framework.handed
        filled = substitute(name, lambda label: self._filled(given[label]) if label in given else None)
        return filled if filled != name else None

    def _filled(self, pattern: str) -> str:
        return normalise(pattern.replace("{scope}", self.scope).replace("{id}", self.id))


def below_id(parameter: str | None) -> str | None:
    """Return the rest of a parameter whose name begins with the id of its plugin (`{name}.topic`, ROS 2); else None."""
    before, hole, after = partition(parameter or "")
    return after[1:] if hole and not before and after.startswith(".") else None


def framework_of(base: str | None, ros: int) -> Framework:
    """Return the row for plugins of a base class, a plain one where the table has none."""
    return table().get((base or "", ros)) or Framework(base or "", ros, "")


def loaded_plugins(  # noqa: PLR0913, PLR0917 - what the plugins of a node depend on
    values: Mapping[str, str | None],
    types: NodeTypes,
    repository: str,
    ros: int,
    package: str | None,
    slots: Iterable[PluginSlot] = (),
) -> Iterator[Loaded]:
    """Yield what a node with these parameters and slots loads; names are relative to the node, the values YAML.

    Each plugin comes once for each name under which it is loaded, in the order of the parameters, then those that code
    loads where no parameter says otherwise.
    """
    slots = [one for one in slots if one.base_class != TREE_NODE]
    loaded: set[tuple[str, str]] = set()
    of_slots = {_bare(one.parameter) for one in slots if one.parameter is not None}
    for plugin in _by_parameters(values, types, repository, ros, package, of_slots):
        if (plugin.scope, plugin.id) not in loaded and not plugin.framework.node:
            loaded.add((plugin.scope, plugin.id))
            yield plugin
    for slot in slots:
        for name, kind, parameter in _defaults(slot, values):
            if ("", name) not in loaded:
                loaded.add(("", name))
                yield _loaded(name, kind, "", types.plugin(kind, repository, package), ros, parameter)


def _defaults(slot: PluginSlot, values: Mapping[str, str | None]) -> Iterator[tuple[str, str, str]]:
    """Yield name, class and parameter of the plugins of a slot whose class no parameter gives."""
    names = parsed(values.get(_bare(slot.names))) if slot.names is not None else None
    for one in slot.defaults:
        parameter = _bare(slot.parameter or "").replace("{id}", one.name or "")
        listed = not isinstance(names, list) or one.name in names
        if listed and "[" not in parameter and values.get(parameter) is None:
            yield one.name or _last(one.class_name), one.class_name, parameter


def _bare(name: str) -> str:
    return name.removeprefix("~/")


def _by_parameters(  # noqa: PLR0913, PLR0917 - as above
    values: Mapping[str, str | None],
    types: NodeTypes,
    repository: str,
    ros: int,
    package: str | None,
    of_slots: Collection[str],
) -> Iterator[Loaded]:
    """Yield what the values of parameters name; `of_slots` are parameters that give the class of a plugin."""
    separator = "/" if ros == 1 else "."
    listed = _listed(values) if ros != 1 else None
    for name, value in values.items():
        # Most values are no classes; they need not be parsed.
        if value is None or not ("/" in value or "::" in value or value.lstrip().startswith("[")):
            continue
        scope, _, last = name.rpartition(separator)
        for given, kind in _classes(parsed(value)):
            typed = types.plugin(kind, repository, package)
            if typed is not None and typed[1].kind is not NodeKind.PLUGIN:
                continue
            if given is None and last in _CLASS_KEYS:
                outer, _, identifier = scope.rpartition(separator)
                if not identifier or (listed is not None and identifier not in listed):
                    continue
                if typed is None and last != "plugin":  # many things have a type
                    continue
                plugin = _loaded(identifier, kind, outer, typed, ros, name)
            elif typed is None and given is None and name not in of_slots:
                continue
            else:
                plugin = _loaded(given or _last(kind), kind, scope, typed, ros, name)
            yield plugin


def _loaded(  # noqa: PLR0913, PLR0917 - what is known of one plugin
    identifier: str, kind: str, scope: str, typed: Typed | None, ros: int, parameter: str
) -> Loaded:
    framework = framework_of(typed[1].base_class if typed is not None else None, ros)
    if typed is not None and ros == 1 and not framework.source:
        framework = _of_names(framework, typed[1])
    return Loaded(identifier, kind, scope, typed, framework, parameter)


def _of_names(framework: Framework, node: NodeType) -> Framework:
    """Return a row for a plugin of another framework: its `~` is the node's if code puts the id in front of names."""
    names = [one.name for listed in (node.parameters, node.interfaces) for one in listed if one.name is not None]
    label = next((match[1] for match in map(_OWN_ID.match, names) if match is not None), None)
    return framework if label is None else replace(framework, private="~", handed={label: "{id}"})


def _classes(value: Any) -> Iterator[tuple[str | None, str]]:
    """Yield pairs of the name that a value gives to a plugin, if it gives one, and its class."""
    for item in value if isinstance(value, list) else [value]:
        if isinstance(item, str) and _CLASS.fullmatch(item):
            yield None, item
        elif isinstance(item, dict):
            kind = next((item[key] for key in _CLASS_KEYS if isinstance(item.get(key), str)), None)
            if kind is not None and _CLASS.fullmatch(kind) and isinstance(item.get("name"), str):
                yield item["name"], kind


def _listed(values: Mapping[str, str | None]) -> set[str] | None:
    """Return the ids in lists of plugins; None without such a list."""
    lists = [parsed(value) for name, value in values.items() if name.endswith(_LISTS) and value is not None]
    readable = [entry for entry in lists if isinstance(entry, list)]
    return {str(item) for entry in readable for item in entry} if readable else None


def _last(kind: str) -> str:
    return class_name(kind).rpartition("/")[2]


@cache
def table() -> dict[tuple[str, int], Framework]:
    """Return the rows of the table by base class and version of ROS."""
    return {(row.base, row.ros): row for row in rows("plugin", Framework)}
