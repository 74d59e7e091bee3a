"""Launch files of ROS 2 in XML and YAML as actions.

Source: `launch.frontend.Entity`, and the `parse` methods of `launch.actions` and `launch_ros.actions`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import TYPE_CHECKING, Final, TypedDict

import yaml

from kg.facts import LaunchProblem, LaunchProblemKind, Location
from kg.holes import ANONYMOUS
from kg.launch.files.markup import Markup
from kg.launch.files.ros2 import actions as kinds
from kg.launch.files.ros2.actions import Action, Condition, Part, Substitution, Text
from kg.launch.files.ros2.context import HOLE, place
from kg.launch.files.ros2.template import TemplateError, parse_template
from kg.launch.files.ros2.values import of_yaml, truth
from kg.yamltext import Walk, YamlFault, compose_yaml

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from kg.corpus.files import FilePath
    from kg.launch.files.access import Files

Attribute = str | list[str]


class Malformed(Exception):  # noqa: N818  (it says what the file is)
    """An element breaks the rules of launch files."""

    def __init__(self, message: str, line: int) -> None:
        super().__init__(message)
        self.message = message
        self.line = line


@dataclass(slots=True)
class Element:
    """An action, or a part of one, as it is written; values of YAML that are not texts are written as YAML.

    `children` are all elements below in their order, actions and those that belong to this one (`param`, `remap`, ...).
    """

    tag: str
    line: int
    attributes: Mapping[str, Attribute] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)

    def get(self, *names: str) -> str | None:
        """Return the first existing attribute of these names; a list as YAML."""
        for name in names:
            value = self.attributes.get(name)
            if value is not None:
                return f"[{', '.join(value)}]" if isinstance(value, list) else value
        return None

    def need(self, *names: str) -> str:
        """Return an attribute that has to be there; raises `Malformed`."""
        value = self.get(*names)
        if value is None:
            raise Malformed(f"<{self.tag}> has no attribute `{names[0]}`", self.line)
        return value

    def of(self, *tags: str) -> tuple[Element, ...]:
        """Return the children of these tags."""
        return tuple(child for child in self.children if child.tag in tags)


_SEPARATOR: Final = "-sep"


def _element(tag: str, written: dict[str, str], line: int) -> Element:
    lists = {name: text.split(sep) for name, text in written.items() if (sep := written.get(f"{name}{_SEPARATOR}"))}
    texts = {name: text for name, text in written.items() if not name.endswith(_SEPARATOR)}
    return Element(tag, line, {**texts, **lists})


_MARKUP: Final = Markup(_element, lambda *_: None, cached=1)
_MOST_DEPTH: Final = 100


def read_xml(files: Files, file: FilePath, text: bytes, problems: list[LaunchProblem]) -> Sequence[Action]:
    """Return the actions of a file; malformed parts are among the `problems`, with their lines."""
    document = _MARKUP.read(text)
    if document.problem is not None:
        problems.append(_broken(files, file, *document.problem))
        problems = []  # later errors follow from the first
    return build(document.root, lambda line: place(files, file, line), problems) if document.root else ()


_CHILDREN: Final = "children"


def read_yaml(files: Files, file: FilePath, text: bytes, problems: list[LaunchProblem]) -> Sequence[Action]:
    """Return the actions of a file; malformed parts are among the `problems`, with their lines."""
    try:
        root = _Walk().action(compose_yaml(text.decode()), 0)
    except YamlFault as fault:
        problems.append(_broken(files, file, f"the file {fault.message}", fault.line))
        return ()
    except Malformed as error:
        problems.append(_broken(files, file, error.message, error.line))
        return ()
    return build(root, lambda line: place(files, file, line), problems)


def _broken(files: Files, file: FilePath, message: str, line: int | None) -> LaunchProblem:
    return LaunchProblem(LaunchProblemKind.MALFORMED, message, place(files, file, line or 1), subject=file.path)


class _Walk(Walk):
    """One walk over a document."""

    def action(self, node: yaml.Node | None, depth: int) -> Element:
        """Return the action that a mapping of one key means."""
        if node is None:
            raise YamlFault("is empty")
        pairs = list(self.pairs(node, depth))
        if len(pairs) != 1:
            raise Malformed("an action has to be a mapping with its name as the only key", _line(node))
        key, value = pairs[0]
        return self._element(key.value, value, _line(key), depth + 1)

    def _element(self, tag: str, node: yaml.Node, line: int, depth: int) -> Element:
        if isinstance(node, yaml.SequenceNode):
            return Element(tag, line, children=[self.action(child, depth + 1) for child in node.value])
        if isinstance(node, yaml.ScalarNode) and node.value:
            raise Malformed(f"`{tag}` has to be a mapping or a list", line)
        attributes: dict[str, Attribute] = {}
        children: list[Element] = []
        for key, value in self.pairs(node, depth):
            listed = value.value if isinstance(value, yaml.SequenceNode) else ()
            if not any(isinstance(child, yaml.MappingNode) for child in listed):
                attributes[key.value] = _attribute(value)
            elif key.value == _CHILDREN:
                children += [self.action(child, depth + 1) for child in listed]
            else:
                children += [self._element(key.value, child, _line(child), depth + 1) for child in listed]
        return Element(tag, line, attributes, children)


def _attribute(node: yaml.Node) -> Attribute:
    if isinstance(node, yaml.ScalarNode):
        return str(node.value)
    whole = of_yaml(node)[0]
    if not isinstance(node, yaml.SequenceNode):
        return whole
    return [item.value if isinstance(item, yaml.ScalarNode) else of_yaml(item)[0] for item in node.value]


def _line(node: yaml.Node) -> int:
    return int(node.start_mark.line) + 1


_SETTINGS: Final = ("output", "respawn", "respawn_delay", "launch-prefix", "cwd", "exec_name", "machine")
_QUOTED: Final = re.compile(r"""'([^']*)'?|"([^"]*)"?""")
_PIECE: Final = re.compile(r"""\s+|(?:'[^']*'?|"[^"]*"?|[^\s'"])+""")
_TYPES: Final = {"int": "int", "float": "double", "bool": "bool", "str": "string"}


class _Common(TypedDict):
    location: Location
    condition: Condition | None


def _pieces(text: str) -> Iterator[str | None]:
    """Yield the words of a text, and None for spaces between them; quotes keep spaces."""
    for piece in _PIECE.findall(text):
        word = _QUOTED.sub(lambda quoted: quoted[1] or quoted[2] or "", piece)
        if piece.isspace():
            yield None
        elif word:
            yield word


_IGNORED: Final = {"log", "log_info", "shutdown", "set_ros_log_dir", "reset_env"}
"""Actions that start nothing and set nothing that a node could see."""

_ROOT: Final = "launch"
_ALIKE: Final = 0.75
"""Between 0 and 1: how alike an unknown action and the one that is meant are at least."""


def build(root: Element, place: Callable[[int], Location], problems: list[LaunchProblem]) -> Sequence[Action]:
    """Return the actions of a launch file; `place` makes a location of a line."""
    builder = _Builder(place, problems)
    if root.tag != _ROOT:
        builder.malformed(Malformed(f"the root is `{root.tag}`, not `{_ROOT}`", root.line))
        return ()
    return builder.actions(root.children)


class _Builder:
    """Makes actions of the elements of one file; `place` makes a location of a line."""

    def __init__(self, place: Callable[[int], Location], problems: list[LaunchProblem]) -> None:
        self.place = place
        self.problems = problems

    def actions(self, elements: Sequence[Element]) -> tuple[Action, ...]:
        """Return the actions that elements mean, without those that are malformed."""
        return tuple(action for element in elements for action in self._safely(element))

    def _safely(self, element: Element) -> Iterator[Action]:
        if element.tag in _IGNORED:
            return
        reader = _READERS.get(element.tag)
        if reader is None:
            self._unknown(element)
            return
        try:
            yield reader(self, element)
        except Malformed as error:
            self.malformed(error)

    def argument(self, element: Element) -> Action:
        """`<arg>`: a declaration."""
        if "value" in element.attributes:
            self.malformed(Malformed("an argument cannot be given a value where it is declared", element.line))
        default = element.get("default")
        return kinds.DeclareArgument(
            name=element.need("name"),
            default=None if default is None else self.text(element, default),
            description=element.get("description"),
            choices=tuple(choice.need("value") for choice in element.of("choice")),
            **self.common(element),
        )

    def include(self, element: Element) -> Action:
        """`<include>` with its arguments."""
        arguments = tuple(
            (self.needed(inner, "name"), self.needed(inner, "value")) for inner in element.of("arg", "let")
        )
        return kinds.Include(path=self.needed(element, "file"), arguments=arguments, **self.common(element))

    def group(self, element: Element) -> Action:
        """`<group>`: its children, except `<keep>`."""
        return kinds.Group(
            actions=self.actions([child for child in element.children if child.tag != "keep"]),
            scoped=self.flag(element, "scoped"),
            forwarding=self.flag(element, "forwarding"),
            configurations=self._keep_pairs(element),
            **self.common(element),
        )

    def reset(self, element: Element) -> Action:
        """`<reset>`: forgets all configurations but those of `<keep>`."""
        return kinds.ResetConfigurations(configurations=self._keep_pairs(element), **self.common(element))

    def _keep_pairs(self, element: Element) -> tuple[tuple[Text, Text], ...]:
        return tuple((self.needed(keep, "name"), self.needed(keep, "value")) for keep in element.of("keep"))

    def timer(self, element: Element) -> Action:
        """`<timer>`: its actions are taken as executed."""
        return kinds.Group(actions=self.actions(element.children), scoped=False, **self.common(element))

    def parameter(self, element: Element) -> Action:
        """`<set_parameter>`, `<set_use_sim_time>`."""
        name = ("use_sim_time",) if element.tag == "set_use_sim_time" else self.needed(element, "name")
        given = kinds.ParameterValue(name, self.value(element, "value"), self.place(element.line))
        return kinds.SetParameters(source=given, **self.common(element))

    def parameters_file(self, element: Element) -> Action:
        """`<set_parameters_from_file>`."""
        file = kinds.ParameterFile(self.needed(element, "filename"), self.place(element.line))
        return kinds.SetParameters(source=file, **self.common(element))

    def append_variable(self, element: Element) -> Action:
        """`<append_env>`: the earlier value is unknown unless the file has set it."""
        name, value = self.needed(element, "name"), self.needed(element, "value")
        before = Substitution("env", (name, (ANONYMOUS,)))
        separator = element.get("separator") or ":"
        prepend = truth(element.get("prepend") or "false")
        joined = (*value, separator, before) if prepend else (before, separator, *value)
        return kinds.Setting(what="variable", operands=(name, joined), **self.common(element))

    def executable(self, element: Element) -> Action:
        """`<executable>`."""
        return kinds.Executable(command=self.words(element, element.need("cmd")), **self.common(element))

    def _unknown(self, element: Element) -> None:
        """Note an action that is not of launch or launch_ros: a misspelt one, or one that an extension exposes."""
        meant = get_close_matches(element.tag, (*_READERS, *_IGNORED), n=1, cutoff=_ALIKE)
        if meant:
            self.malformed(Malformed(f"unknown action `{element.tag}`; did you mean `{meant[0]}`?", element.line))
            return
        words = f"`{element.tag}` is not an action of launch or launch_ros; what an extension starts by it is unknown"
        where = self.place(element.line)
        self.problems.append(LaunchProblem(LaunchProblemKind.UNRESOLVED, words, where, subject=element.tag))

    def malformed(self, error: Malformed) -> None:
        """Record the problems of the file."""
        where = self.place(error.line)
        self.problems.append(LaunchProblem(LaunchProblemKind.MALFORMED, error.message, where))

    def text(self, element: Element, written: str) -> Text:
        """Return the parts of a text; unknown, and a problem, where it breaks the grammar of substitutions."""
        try:
            return parse_template(written)
        except TemplateError as error:
            self.malformed(Malformed(str(error), element.line))
            return (HOLE,)

    def needed(self, element: Element, *names: str) -> Text:
        """Return the parts of an attribute that has to be there."""
        return self.text(element, element.need(*names))

    def optional(self, element: Element, *names: str) -> Text | None:
        """Return the parts of an attribute; None if it is missing."""
        written = element.get(*names)
        return None if written is None else self.text(element, written)

    def flag(self, element: Element, name: str) -> bool:
        """Return a truth value that is true unless the element sets it otherwise."""
        known = truth(element.get(name) or "true")
        if known is None:
            raise Malformed(f"`{name}` has to be true or false", element.line)
        return known

    def common(self, element: Element) -> _Common:
        """Return the common fields of actions: a place and a condition."""
        positive, negative = element.get("if"), element.get("unless")
        if positive is not None and negative is not None:
            raise Malformed("`if` and `unless` cannot both be given", element.line)
        written = positive if positive is not None else negative
        condition = None
        if written is not None:
            condition = Condition(self.text(element, written), positive is None, written)
        return {"location": self.place(element.line), "condition": condition}

    def components(self, element: Element) -> Action:
        """`<load_composable_node>`."""
        return kinds.LoadComponents(
            target=self.needed(element, "target"), components=self._components(element), **self.common(element)
        )

    def _components(self, element: Element) -> tuple[kinds.NodeAction, ...]:
        return tuple(self._component(child) for child in element.of("composable_node"))

    def _component(self, element: Element) -> kinds.NodeAction:
        extra = tuple(
            (f"extra {argument.need('name')}", self.needed(argument, "value")) for argument in element.of("extra_arg")
        )
        return kinds.NodeAction(
            kind="component",
            package=self.needed(element, "pkg"),
            plugin=self.needed(element, "plugin"),
            name=self.optional(element, "name"),
            namespace=self.optional(element, "namespace"),
            remaps=self._remaps(element),
            parameters=tuple(self._parameters(element)),
            settings=extra,
            **self.common(element),
        )

    def node(self, element: Element, kind: str) -> kinds.NodeAction:
        """`<node>`, `<lifecycle_node>`, or `<node_container>` with the components that are loaded into it."""
        return kinds.NodeAction(
            kind=kind,
            package=self.optional(element, "pkg"),
            executable=self.needed(element, "exec", "executable"),
            name=self.optional(element, "name", "node_name", "node-name"),
            namespace=self.optional(element, "namespace"),
            remaps=self._remaps(element),
            parameters=tuple(self._parameters(element)),
            arguments=self.words(element, element.get("args") or ""),
            ros_arguments=self.words(element, element.get("ros_args") or ""),
            settings=tuple(self._settings(element)),
            components=self._components(element),
            **self.common(element),
        )

    def _settings(self, element: Element) -> Iterator[tuple[str, Text]]:
        for name in _SETTINGS:
            value = self.optional(element, name)
            if value is not None:
                yield name, value
        for variable in element.of("env"):
            yield f"env {variable.need('name')}", self.needed(variable, "value")

    def _remaps(self, element: Element) -> tuple[tuple[Text, Text, Location], ...]:
        return tuple(
            (self.needed(remap, "from"), self.needed(remap, "to"), self.place(remap.line))
            for remap in element.of("remap")
        )

    def _parameters(self, element: Element) -> Iterator[kinds.ParameterSource]:
        for parameter in element.of("param"):
            file = self.optional(parameter, "from")
            if file is not None:
                substitutes = truth(parameter.get("allow_substs") or "false") is not False
                yield kinds.ParameterFile(file, self.place(parameter.line), substitutes)
            else:
                yield from self._nested(parameter, ())

    def _nested(self, element: Element, above: Text) -> Iterator[kinds.ParameterValue]:
        name = (*above, *self.needed(element, "name"))
        if "value" in element.attributes:
            written = element.get("type") or ""
            kind = _TYPES.get(written.removeprefix("list_of_"))
            if kind and written.startswith("list_of_"):
                kind = f"{kind}_array"
            value = self.value(element, "value")
            yield kinds.ParameterValue(name, value, self.place(element.line), as_text=kind == "string", type=kind)
        elif not element.of("param"):
            raise Malformed("a parameter needs a value, or parameters below it", element.line)
        for inner in element.of("param"):
            yield from self._nested(inner, (*name, "."))

    def value(self, element: Element, name: str) -> Text | list[object]:
        """Return the value of a parameter: the parts of a text, or a list of such."""
        value = element.attributes.get(name)
        if isinstance(value, list):
            return [self.text(element, item) for item in value]
        return self.needed(element, name)

    def words(self, element: Element, written: str) -> tuple[Text, ...]:
        """Return a command line as the words that it has, of which substitutions are parts that are not split."""
        words: list[list[Part]] = []
        fresh = True
        for part in self.text(element, written):
            for piece in _pieces(part) if isinstance(part, str) else (part,):
                if piece is None:
                    fresh = True
                    continue
                if fresh:
                    words.append([])
                words[-1].append(piece)
                fresh = False
        return tuple(tuple(word) for word in words)


def _node(kind: str) -> Callable[[_Builder, Element], Action]:
    return lambda builder, element: builder.node(element, kind)


def _setting(what: str, *names: str) -> Callable[[_Builder, Element], Action]:
    """Return the reader of a setting whose operands are attributes of these names."""

    def read(builder: _Builder, element: Element) -> Action:
        operands = tuple(builder.needed(element, name) for name in names)
        return kinds.Setting(what=what, operands=operands, **builder.common(element))

    return read


_READERS: Final[Mapping[str, Callable[[_Builder, Element], Action]]] = {
    "arg": _Builder.argument,
    "let": _setting("configuration", "name", "value"),
    "include": _Builder.include,
    "group": _Builder.group,
    "reset": _Builder.reset,
    **dict.fromkeys(("timer", "ros_timer"), _Builder.timer),
    **dict.fromkeys(("push_ros_namespace", "push-ros-namespace"), _setting("namespace", "namespace")),
    "set_remap": _setting("remap", "from", "to"),
    **dict.fromkeys(("set_parameter", "set_use_sim_time"), _Builder.parameter),
    "set_parameters_from_file": _Builder.parameters_file,
    "set_env": _setting("variable", "name", "value"),
    "unset_env": _setting("variable", "name"),
    "append_env": _Builder.append_variable,
    "executable": _Builder.executable,
    "node": _node("node"),
    "lifecycle_node": _node("lifecycle-node"),
    "node_container": _node("container"),
    "load_composable_node": _Builder.components,
}
