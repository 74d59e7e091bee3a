"""Elements of XML and YAML as actions.

Source: the `parse` methods of `launch.actions` and `launch_ros.actions`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2 import actions as kinds
from kg.extract.launch.ros2.frontend.element import Malformed
from kg.extract.launch.ros2.frontend.nodes import NodeBuilder
from kg.extract.launch.ros2.texts import Substitution
from kg.extract.launch.ros2.values import truth
from kg.facts import LaunchProblem, LaunchProblemKind
from kg.holes import ANONYMOUS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.frontend.element import Element
    from kg.extract.launch.ros2.texts import Text
    from kg.facts import Location

__all__ = ["build"]

_IGNORED: Final = {"log", "log_info", "shutdown", "set_ros_log_dir", "reset_env"}
"""Actions that start nothing and set nothing that a node could see."""

_ROOT: Final = "launch"


def build(root: Element, place: Callable[[int], Location], problems: list[LaunchProblem]) -> Sequence[Action]:
    """Return the actions of a launch file; `place` makes a location of a line."""
    builder = _Builder(place, problems)
    if root.tag != _ROOT:
        builder.malformed(Malformed(f"the root is `{root.tag}`, not `{_ROOT}`", root.line))
        return ()
    return builder.actions(root.children)


class _Builder(NodeBuilder):
    """The actions of one file."""

    def actions(self, elements: Sequence[Element]) -> tuple[Action, ...]:
        """Return the actions that elements mean, without those that are malformed."""
        return tuple(action for element in elements for action in self._safely(element))

    def _safely(self, element: Element) -> Iterator[Action]:
        if element.tag in _IGNORED:
            return
        reader = _READERS.get(element.tag)
        if reader is None:
            self.malformed(Malformed(f"there is no action `{element.tag}`", element.line))
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

    def let(self, element: Element) -> Action:
        """`<let>`."""
        name, value = self.needed(element, "name"), self.needed(element, "value")
        return kinds.SetConfiguration(name=name, value=value, **self.common(element))

    def include(self, element: Element) -> Action:
        """`<include>` with its arguments."""
        arguments = tuple(
            (self.needed(inner, "name"), self.needed(inner, "value")) for inner in element.of("arg", "let")
        )
        return kinds.Include(path=self.needed(element, "file"), arguments=arguments, **self.common(element))

    def group(self, element: Element) -> Action:
        """`<group>`: what is below, but `<keep>`."""
        return kinds.Group(
            actions=self.actions([child for child in element.children if child.tag != "keep"]),
            scoped=self.flag(element, "scoped"),
            forwarding=self.flag(element, "forwarding"),
            configurations=self._kept(element),
            **self.common(element),
        )

    def reset(self, element: Element) -> Action:
        """`<reset>`: forgets all configurations but those of `<keep>`."""
        return kinds.ResetConfigurations(configurations=self._kept(element), **self.common(element))

    def _kept(self, element: Element) -> tuple[tuple[Text, Text], ...]:
        return tuple((self.needed(keep, "name"), self.needed(keep, "value")) for keep in element.of("keep"))

    def timer(self, element: Element) -> Action:
        """`<timer>`: what happens later happens."""
        return kinds.Group(actions=self.actions(element.children), scoped=False, **self.common(element))

    def namespace(self, element: Element) -> Action:
        """`<push_ros_namespace>`."""
        return kinds.PushNamespace(namespace=self.needed(element, "namespace"), **self.common(element))

    def remap(self, element: Element) -> Action:
        """`<set_remap>`."""
        source, target = self.needed(element, "from"), self.needed(element, "to")
        return kinds.SetRemap(source=source, target=target, **self.common(element))

    def parameter(self, element: Element) -> Action:
        """`<set_parameter>`."""
        value = kinds.ParameterValue(
            self.needed(element, "name"), self.value(element, "value"), self.place(element.line)
        )
        return kinds.SetParameter(parameter=value, **self.common(element))

    def sim_time(self, element: Element) -> Action:
        """`<set_use_sim_time>`."""
        value = self.needed(element, "value")
        given = kinds.ParameterValue(("use_sim_time",), value, self.place(element.line))
        return kinds.SetParameter(parameter=given, **self.common(element))

    def parameters_file(self, element: Element) -> Action:
        """`<set_parameters_from_file>`."""
        file = kinds.ParameterFile(self.needed(element, "filename"), self.place(element.line))
        return kinds.SetParametersFromFile(file=file, **self.common(element))

    def set_variable(self, element: Element) -> Action:
        """`<set_env>`."""
        name, value = self.needed(element, "name"), self.needed(element, "value")
        return kinds.SetEnvironment(name=name, value=value, **self.common(element))

    def unset_variable(self, element: Element) -> Action:
        """`<unset_env>`."""
        return kinds.SetEnvironment(name=self.needed(element, "name"), value=None, **self.common(element))

    def append_variable(self, element: Element) -> Action:
        """`<append_env>`: what was there before is unknown unless the file has set it."""
        name, value = self.needed(element, "name"), self.needed(element, "value")
        before = Substitution("env", (name, (ANONYMOUS,)))
        separator = element.get("separator") or ":"
        prepend = truth(element.get("prepend") or "false")
        joined = (*value, separator, before) if prepend else (before, separator, *value)
        return kinds.SetEnvironment(name=name, value=joined, **self.common(element))

    def executable(self, element: Element) -> Action:
        """`<executable>`."""
        return kinds.Executable(command=self.words(element, element.need("cmd")), **self.common(element))

    def malformed(self, error: Malformed) -> None:
        """Note what is wrong with the file."""
        where = self.place(error.line)
        self.problems.append(LaunchProblem(LaunchProblemKind.MALFORMED, error.message, where))


_READERS: Final[Mapping[str, Callable[[_Builder, Element], Action]]] = {
    "arg": _Builder.argument,
    "let": _Builder.let,
    "include": _Builder.include,
    "group": _Builder.group,
    "reset": _Builder.reset,
    "timer": _Builder.timer,
    "ros_timer": _Builder.timer,
    "push_ros_namespace": _Builder.namespace,
    "push-ros-namespace": _Builder.namespace,
    "set_remap": _Builder.remap,
    "set_parameter": _Builder.parameter,
    "set_use_sim_time": _Builder.sim_time,
    "set_parameters_from_file": _Builder.parameters_file,
    "set_env": _Builder.set_variable,
    "unset_env": _Builder.unset_variable,
    "append_env": _Builder.append_variable,
    "executable": _Builder.executable,
    "node": _Builder.node,
    "lifecycle_node": _Builder.lifecycle_node,
    "node_container": _Builder.container,
    "load_composable_node": _Builder.components,
}
