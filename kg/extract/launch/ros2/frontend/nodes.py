"""Elements of XML and YAML that start nodes, with their parameters, remappings and arguments.

Source: `launch_ros.actions.Node.parse` and `launch.actions.ExecuteProcess`.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final, TypedDict

from kg.extract.launch.ros2 import actions as kinds
from kg.extract.launch.ros2.context import HOLE
from kg.extract.launch.ros2.frontend.element import Malformed
from kg.extract.launch.ros2.frontend.template import TemplateError, parse_template
from kg.extract.launch.ros2.texts import Condition
from kg.extract.launch.ros2.values import truth

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.frontend.element import Element
    from kg.extract.launch.ros2.texts import Part, Text
    from kg.facts import LaunchProblem, Location

__all__ = ["NodeBuilder"]

_SETTINGS: Final = ("output", "respawn", "respawn_delay", "launch-prefix", "cwd", "exec_name", "machine")
_QUOTED: Final = re.compile(r"""'([^']*)'?|"([^"]*)"?""")
_PIECE: Final = re.compile(r"""\s+|(?:'[^']*'?|"[^"]*"?|[^\s'"])+""")
_TYPES: Final = {"int": "int", "float": "double", "bool": "bool", "str": "string"}


class _Common(TypedDict):
    location: Location
    condition: Condition | None


class NodeBuilder:
    """Makes actions of the elements of one file; `place` makes a location of a line."""

    def __init__(self, place: Callable[[int], Location], problems: list[LaunchProblem]) -> None:
        self.place = place
        self.problems = problems

    def malformed(self, error: Malformed) -> None:
        """Note what is wrong with the file."""
        raise NotImplementedError

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
        """Return the parts of an attribute; None where there is none."""
        written = element.get(*names)
        return None if written is None else self.text(element, written)

    def flag(self, element: Element, name: str) -> bool:
        """Return a truth value that is so unless the element says otherwise."""
        known = truth(element.get(name) or "true")
        if known is None:
            raise Malformed(f"`{name}` has to be true or false", element.line)
        return known

    def common(self, element: Element) -> _Common:
        """Return what all actions have: a place and a condition."""
        positive, negative = element.get("if"), element.get("unless")
        if positive is not None and negative is not None:
            raise Malformed("`if` and `unless` cannot both be given", element.line)
        written = positive if positive is not None else negative
        condition = None
        if written is not None:
            condition = Condition(self.text(element, written), positive is None, written)
        return {"location": self.place(element.line), "condition": condition}

    def node(self, element: Element) -> Action:
        """`<node>`."""
        return self._node(element, "node")

    def lifecycle_node(self, element: Element) -> Action:
        """`<lifecycle_node>`."""
        return self._node(element, "lifecycle-node")

    def container(self, element: Element) -> Action:
        """`<node_container>` with the components that are loaded into it."""
        return self._node(element, "container")

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

    def _node(self, element: Element, kind: str) -> kinds.NodeAction:
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
            kind = _type(element.get("type"))
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


def _pieces(text: str) -> Iterator[str | None]:
    """Yield the words of a text, and None for spaces between them; quotes keep spaces."""
    for piece in _PIECE.findall(text):
        word = _QUOTED.sub(lambda quoted: quoted[1] or quoted[2] or "", piece)
        if piece.isspace():
            yield None
        elif word:
            yield word


def _type(written: str | None) -> str | None:
    """Return the ROS parameter type that an attribute `type` names; None for none, or one that is not known."""
    if written is None:
        return None
    kind = _TYPES.get(written.removeprefix("list_of_"))
    return f"{kind}_array" if kind and written.startswith("list_of_") else kind
