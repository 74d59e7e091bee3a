"""Nodes of behavior trees that framework calls register, and their ports, which the XML of a tree gives."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.facts import Resolution
from kg.symbolic.values import Closure, Kind, Text, TypeValue, Unknown, Value, alternatives

if TYPE_CHECKING:
    from kg.symbolic.descriptions import PortDescription
    from kg.symbolic.state import Invocation, Site

FACTORY: Final = Kind(("BT", "BehaviorTreeFactory"))

_PORT: Final = "the XML of the behavior tree gives the port"


@dataclass(frozen=True, slots=True)
class Registered:
    """A class registered under the `name` that it has in trees; `builder` creates its objects.

    Without a builder, its constructor gets `given` after the name and the configuration of the node.
    """

    name: Value
    kind: Kind | None
    builder: Closure | None
    given: tuple[Value, ...]
    stack: tuple[Site, ...]

    @classmethod
    def of(cls, name: int, call: Invocation, stack: tuple[Site, ...]) -> Registered:
        """Return what a call registers under the name in its argument `name`."""
        values, template = call.arguments.values, call.arguments.template
        rest = tuple(values[name + 1 :])
        builder = next((one for value in rest for one in alternatives(value) if isinstance(one, Closure)), None)
        kind = template[0].kind if template and isinstance(template[0], TypeValue) else None
        return cls(values[name], kind, builder, rest, stack)


def port_value(port: PortDescription, call: Invocation, defaults: dict[str, Value]) -> Value:
    """Return the value of a port, a text from a parameter `port[name]`; a call with a default adds it to `defaults`."""
    name = call.argument(port.name)
    port_name = name.exact if isinstance(name, Text) else None
    if port_name is None:
        return Unknown("the name of the port is not known")
    default = call.argument(port.default)
    if default is not None:
        defaults[port_name] = default
    current = defaults.get(port_name)
    parameter = f"port[{port_name}]"
    if isinstance(current, Text) and current.exact:
        return replace(current, parameter=parameter, resolution=Resolution.PARAMETER_DEFAULT)
    return Text.hole(_PORT, parameter=parameter)
