"""The parameters given to the process of a node: their origin and their order.

Source: `launch_ros.actions.Node` for the order, `rcl_yaml_param_parser` and `rclcpp`'s `resolve_parameter_overrides`
for what counts: all files and values of a command line are merged by the name of node that they are written for, in
the order in which those names come first. What is given by value to a node that is known by its full name is written
for that name, else for all nodes. The name that a node ends up with decides which of a file's are for it; a
process may have nodes that launch knows nothing of.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final, TypeAlias

import yaml

from kg.facts import LaunchParameter, LaunchProblemKind, Location, StartedNode
from kg.launch.files.access import UNREAD
from kg.launch.files.ros2.actions import ParameterFile, ParameterSource, ParameterValue
from kg.launch.files.ros2.context import HOLE, Context, GlobalFile, place, read
from kg.launch.files.ros2.template import TemplateError, parse_template
from kg.launch.files.ros2.values import Performed, of_object, of_text, of_yaml
from kg.names import is_for_node
from kg.yamltext import Walk, YamlFault, compose_documents

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kg.corpus.files import FilePath

_PARAMETERS: Final = "ros__parameters"
_HOLE_OF_YAML: Final = "\ue000"
"""Placeholder of an unknown part until YAML is parsed, which would read `{}` as an empty mapping."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A parameter of a file: the name of the node it is for, its own name in parts, its value as YAML, and its line.

    `node` is None in a file that names no nodes at all. `location` is that of what set the value, where it is not the
    file.
    """

    node: str | None
    names: tuple[str, ...]
    value: str
    type: str | None
    line: int
    location: Location | None = None


def read_parameters(
    context: Context, path: str, *, substitutions: bool = False
) -> tuple[FilePath, Sequence[Entry]] | None:
    """Return the file that a text names with its parameters; None, and a problem, where it cannot be read.

    With `substitutions` those in the file are performed.
    """
    found = read(context, path)
    if found is None:
        return None
    file, content = found
    generated = context.results.generated.get(path)
    if generated is not None and generated.entries is not None:
        return file, [_performed(context, entry) for entry in generated.entries] if substitutions else generated.entries
    try:
        return file, _entries(_substituted(context, content, _HOLE_OF_YAML) if substitutions else content)
    except YamlFault as fault:
        where = place(context.files, file, fault.line or 1)
        context.problem(LaunchProblemKind.MALFORMED, f"`{file.path}` {fault.message}", file.path, where)
        return None


def _performed(context: Context, entry: Entry) -> Entry:
    """Return a parameter with the substitutions in its value performed."""
    if "$(" not in entry.value:
        return entry
    value, kind = of_text(_substituted(context, entry.value.encode(), HOLE).decode())
    return replace(entry, value=HOLE if value is None else value, type=kind)


def _substituted(context: Context, content: bytes, hole: str) -> bytes:
    """Return a text with its substitutions performed; `hole` stands for those that are unknown."""
    try:
        parts = parse_template(content.decode())
        performed = (part if isinstance(part, str) else context.perform((part,)).replace(HOLE, hole) for part in parts)
        return "".join(performed).encode("utf-8", "replace")
    except TemplateError as error:
        context.problem(LaunchProblemKind.MALFORMED, str(error))
        return content


@lru_cache(maxsize=256)
def _entries(content: bytes) -> tuple[Entry, ...]:
    """Return the parameters of a file in its order; raises `YamlFault`.

    The parser of rcl (`rcl_yaml_param_parser`) ignores where documents begin and end, so all of them count.
    """
    roots, walk = compose_documents(content.decode()), _Walk()
    named = tuple(entry for root in roots for entry in walk.nodes(root, (), 0))
    return named or tuple(entry for root in roots for entry in walk.leaves(root, None, (), 0))


class _Walk(Walk):
    """One walk over a document."""

    def nodes(self, node: yaml.Node | None, names: tuple[str, ...], depth: int) -> Iterator[Entry]:
        """Yield the parameters of all nodes below a mapping."""
        for key, value in self.merged(node, depth):
            if key.value == _PARAMETERS:
                yield from self.leaves(value, _joined(names), (), depth + 1)
            elif isinstance(value, yaml.MappingNode):
                yield from self.nodes(value, (*names, key.value), depth + 1)

    def leaves(self, node: yaml.Node | None, owner: str | None, names: tuple[str, ...], depth: int) -> Iterator[Entry]:
        """Yield the parameters of a mapping of names, with the line of each."""
        for key, value in self.merged(node, depth):
            below = (*names, key.value.replace(_HOLE_OF_YAML, HOLE))
            if isinstance(value, yaml.MappingNode):
                yield from self.leaves(value, owner, below, depth + 1)
                continue
            text, kind = of_yaml(value, self, depth)
            if _HOLE_OF_YAML in text:
                whole = text == _HOLE_OF_YAML or text.startswith("[")
                text, kind = text.replace(_HOLE_OF_YAML, HOLE), None if whole else kind
            yield Entry(owner, below, text, kind, key.start_mark.line + 1)

    def merged(self, node: yaml.Node | None, depth: int) -> Iterator[tuple[yaml.ScalarNode, yaml.Node]]:
        """Yield the entries of a mapping, those of the mappings that it merges too."""
        for key, value in self.pairs(node, depth):
            if key.tag != "tag:yaml.org,2002:merge":
                yield key, value
                continue
            for part in value.value if isinstance(value, yaml.SequenceNode) else [value]:
                yield from self.merged(part, depth + 1)


def _joined(names: Sequence[str]) -> str:
    """Return the name of a node from the keys above its parameters."""
    absolute = "/" if names and names[0].startswith("/") else ""
    return absolute + "/".join(part.strip("/") for part in names if part.strip("/"))


@dataclass(frozen=True, slots=True)
class Rewriting:
    """Changes in a copy of a file: new names of `keys`, new `values`, and a `root` above all nodes.

    A value is named by its key alone, or by the whole path to it, which is added where the file does not have it;
    `instead` has what takes the place of a value, whatever its key.
    """

    keys: Mapping[str, str]
    values: Mapping[str, str]
    instead: Mapping[str, str]
    root: str
    location: Location

    def applied(self, listed: Sequence[Entry]) -> tuple[Entry, ...]:
        """Return the parameters of the copy."""
        present = {_path(entry) for entry in listed}
        fresh = [self._added(path) for path in self.values if path not in present and f".{_PARAMETERS}." in path]
        return tuple(self._rewritten(entry) for entry in (*listed, *fresh))

    def _added(self, path: str) -> Entry:
        node, _, names = path.partition(f".{_PARAMETERS}.")
        return Entry(node.replace(".", "/"), tuple(names.split(".")), "", None, self.location.line)

    def _rewritten(self, entry: Entry) -> Entry:
        path, keys, node = _path(entry), self.keys, entry.node
        wanted = self.values.get(path, self.values.get(path.lstrip("."), self.values.get(entry.names[-1])))
        wanted = self.instead.get(entry.value) if wanted is None else wanted
        names = tuple(keys.get(name, name) for name in entry.names)
        if node is not None:
            node = "/".join(keys.get(part, part) for part in node.split("/"))
            node = _joined((self.root, node)) if self.root.strip("/") else node
        if wanted is None:
            return Entry(node, names, entry.value, entry.type, entry.line, entry.location)
        value, kind = of_text(wanted)
        if kind not in ("int", "double", "bool"):  # nav2 writes all but numbers and truth values as texts
            value, kind = of_text(wanted, "string")
        value = HOLE if value is None else value
        return replace(entry, names=names, node=node, value=value, type=kind, location=self.location)


def _path(entry: Entry) -> str:
    above = () if entry.node is None else (*entry.node.split("/"), _PARAMETERS)
    return ".".join((*above, *entry.names))


_ALL: Final = "/**"
_AT_RUN_TIME: Final = "it depends on values known only at run time"
_Given: TypeAlias = tuple[str, LaunchParameter, LaunchParameter]
"""The name of node that a parameter is written for, the parameter of that node alone, and the same with the name."""


@dataclass(frozen=True, slots=True)
class Owner:
    """The node whose parameters are wanted: its absolute name, without the last part if the name is unknown.

    A node that is loaded into a container is given only what is written for its exact name, or for all.
    """

    namespace: str
    name: str | None
    loaded: bool = False
    whole: bool = True
    """Whether launch knows the full name, and writes values given to the node for that name alone."""

    @property
    def full(self) -> str | None:
        """The absolute name, None where the node keeps its own."""
        return f"{self.namespace.rstrip('/')}/{self.name}" if self.name else None


def given_parameter(context: Context, parameter: ParameterValue) -> LaunchParameter:
    """Return a parameter given by value, as it is now."""
    value, kind = _value(context, parameter)
    printed = context.results.printed
    reason = _AT_RUN_TIME if value is None or HOLE in value else None
    name = context.perform(parameter.name)
    if printed:
        context.results.described[name, parameter.location, context.chain] = printed
    return LaunchParameter(name, value, parameter.location, context.chain, parameter.type or kind, reason)


def _value(context: Context, parameter: ParameterValue) -> tuple[str | None, str | None]:
    """Return the value and type as they are now; the robot description that it is, is then in `results.printed`."""
    context.results.printed = ()
    value = parameter.value
    if isinstance(value, tuple):
        return of_text(context.perform(value), "string" if parameter.as_text else parameter.type)
    if isinstance(value, list):
        return of_object([Performed(context.perform(item)) if isinstance(item, tuple) else item for item in value])
    return of_object(value)


def node_parameters(
    context: Context, owner: Owner, sources: Sequence[ParameterSource | LaunchParameter | GlobalFile]
) -> tuple[LaunchParameter, ...]:
    """Return the parameters given to a node in the order in which they are applied, with the keys they are below."""
    merged: dict[str, dict[str, LaunchParameter]] = {}
    owned: dict[str, bool | None] = {}  # files have many parameters for few nodes
    for key, parameter, below in _written(context, owner, sources):
        if key not in owned:
            owned[key] = _is_own(key, owner)
        own = owned[key]
        if owner.loaded and own is False:
            continue
        if not context.allows("parameters"):
            break
        parameters = merged.setdefault("" if owner.loaded else key, {})
        parameters.pop(parameter.name, None)
        parameters[parameter.name] = parameter if own else below
    return tuple(parameter for parameters in merged.values() for parameter in parameters.values())


def without_others(nodes: Sequence[StartedNode]) -> tuple[StartedNode, ...]:
    """Return nodes without the parameters that are below the name of another of them: that one has them itself."""
    names = {f"{node.namespace.rstrip('/')}/{node.name}" for node in nodes if node.name}
    return tuple(
        replace(node, parameters=tuple(given for given in node.parameters if given.node not in names))
        if node.name and any(given.node in names for given in node.parameters)
        else node
        for node in nodes
    )


def _is_own(key: str, owner: Owner) -> bool | None:
    """Return whether a key is of the node alone; None if it may be for the node, or for others of its process."""
    written = _key(key)
    if written == owner.full:
        return True
    if not owner.loaded:
        return None
    if "*" in key:
        return written == _ALL
    possible = owner.full is not None and is_for_node(key, owner.full) is None
    return None if possible else False


def _written(
    context: Context, owner: Owner, sources: Iterable[ParameterSource | LaunchParameter | GlobalFile]
) -> Iterator[_Given]:
    """Yield the parameters of all sources with the name of node that they are written for."""
    own = owner.full if owner.full is not None and owner.whole else _ALL
    for source in sources:
        if isinstance(source, LaunchParameter):
            # A rule `node:name` is for the nodes of that name, as `rcl` reads it; any other is for all.
            node, colon, name = source.name.rpartition(":")
            yield _given(node, replace(source, name=name)) if colon and node else _given(_ALL, source)
        elif isinstance(source, ParameterValue):
            with context.at(source.location):
                yield _given(own, given_parameter(context, source))
        else:
            with context.at(source.location):
                yield from _of_file(context, source, owner, own if owner.loaded else None)


def _given(key: str, parameter: LaunchParameter) -> _Given:
    return key, parameter, replace(parameter, node=_key(key))


def _key(node: str) -> str:
    return f"/{node.strip('/')}"


def _of_file(context: Context, source: ParameterFile | GlobalFile, owner: Owner, flat: str | None) -> Iterator[_Given]:
    """Yield the parameters of a file, of one for many loaded nodes only those that are not certainly for others.

    `flat` is the node that a file is for which names no nodes at all.
    """
    substitutions = isinstance(source, ParameterFile) and source.substitutions
    path = source.path if isinstance(source, GlobalFile) else context.perform(source.read)
    found = read_parameters(context, path, substitutions=substitutions)
    if found is None:
        yield _given(flat or _ALL, LaunchParameter(HOLE, None, source.location, context.chain, reason=UNREAD))
        return
    file, listed = found
    doubt = source.reason if isinstance(source, GlobalFile) else None
    cached = context.results.given.setdefault((file, context.chain, doubt), {})
    repository = place(context.files, file, 1).repository
    named = {entry.node for entry in listed} if owner.loaded else ()
    others = {node for node in named if node is not None and _is_own(node, owner) is False}
    for entry in listed:
        if entry.node in others:
            continue
        if id(entry) in cached:
            yield cached[id(entry)][1]
            continue
        node = entry.node if entry.node is not None else flat
        if node is None:
            continue
        value = None if doubt or entry.value == HOLE else entry.value
        reason = doubt or (_AT_RUN_TIME if value is None else None)
        where = entry.location or Location(file.path, entry.line, repository)
        name = ".".join(entry.names)
        parts = (name, value, where, context.chain, entry.type, reason)
        given = (node, LaunchParameter(*parts), LaunchParameter(*parts, node=_key(node)))
        if entry.node is not None:
            cached[id(entry)] = (entry, given)
        yield given
