"""The tables of ROS 2: rclcpp and the libraries that make interfaces on its nodes.

Sources: the headers of rclcpp, rclcpp_lifecycle, rclcpp_action, image_transport, message_filters and tf2_ros.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.api import CallSpec, MarkSpec, ParameterSpec, TypeSpec
from kg.extract.cpp.handles import below, camera_info_beside, value_of_parameter
from kg.extract.values import OWN_NAMESPACE, Handle, Sequence, Text
from kg.facts import Access, Qos, Role

if TYPE_CHECKING:
    from collections.abc import Callable

    from tree_sitter import Node

    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Alternatives, Evaluator
    from kg.extract.cpp.syntax import Callee
    from kg.extract.cpp.types import TypeName
    from kg.extract.cpp.unit import Class, Expr

__all__ = ["Ros2"]

_NODE: Final = frozenset({"Node", "LifecycleNode"})
_USUAL: Final = Qos("reliable", "volatile", "keep_last", 10)
_LATEST: Final = Qos("reliable", "volatile", "keep_last", 1)
_ADAPTOR: Final = frozenset({"NodeAdaptor"})
_FREE: Final = frozenset({"rclcpp", "agnocast_wrapper", "agnocast"})
_ACTION: Final = frozenset({"rclcpp_action"})
_IMAGE: Final = "sensor_msgs/Image"
_TRANSPORT: Final = frozenset({"image_transport"})


def _image(role: Role, *, least: int, qos: int, camera: bool = False) -> CallSpec:
    """Return the entry of a free function of `image_transport` that takes the node and the topic."""
    end = "publisher" if role is Role.PUBLISHES else "subscriber"
    return CallSpec(
        2,
        role,
        name=1,
        handle=0,
        scopes=_TRANSPORT,
        fixed=_IMAGE,
        least=least,
        camera=camera,
        qos=qos,
        mark=f"image_transport.{end}",
        usual=_USUAL,
    )


_CALLS: Final[dict[str, tuple[CallSpec, ...]]] = {
    "publish": (
        CallSpec(
            2,
            Role.PUBLISHES,
            receivers=frozenset({"DebugPublisher"}),
            template=0,
            least=2,
            qos=2,
            explicit=True,
            usual=_LATEST,
        ),
    ),
    "init_pub": (CallSpec(2, Role.PUBLISHES, receivers=_ADAPTOR, specified=True),),
    "init_sub": (CallSpec(2, Role.SUBSCRIBES, receivers=_ADAPTOR, specified=True),),
    "init_srv": (CallSpec(2, Role.SERVICES, receivers=_ADAPTOR, specified=True),),
    "init_cli": (CallSpec(2, Role.CLIENTS, receivers=_ADAPTOR, specified=True),),
    "create_publisher": (
        CallSpec(2, Role.PUBLISHES, receivers=_ADAPTOR, specified=True, least=0, explicit=True),
        CallSpec(2, Role.PUBLISHES, receivers=_NODE, template=0, qos=1),
        CallSpec(2, Role.PUBLISHES, name=1, handle=0, scopes=_FREE, template=0, least=2, qos=2),
        _image(Role.PUBLISHES, least=2, qos=2),
    ),
    "create_subscription": (
        CallSpec(2, Role.SUBSCRIBES, receivers=_ADAPTOR, specified=True, least=0, explicit=True),
        CallSpec(2, Role.SUBSCRIBES, receivers=_NODE, template=0, callback=2, least=2, qos=1),
        CallSpec(2, Role.SUBSCRIBES, name=1, handle=0, scopes=_FREE, template=0, callback=3, least=3, qos=2),
        _image(Role.SUBSCRIBES, least=3, qos=4),
    ),
    "create_camera_publisher": (_image(Role.PUBLISHES, least=2, qos=2, camera=True),),
    "create_camera_subscription": (_image(Role.SUBSCRIBES, least=2, qos=4, camera=True),),
    "create_service": (
        CallSpec(2, Role.SERVICES, receivers=_ADAPTOR, specified=True, least=0, explicit=True),
        CallSpec(2, Role.SERVICES, receivers=_NODE, template=0, least=2, qos=2),
        CallSpec(2, Role.SERVICES, name=1, handle=0, scopes=_FREE, template=0, least=3, most=5, qos=3),
        CallSpec(2, Role.SERVICES, name=2, handle=0, scopes=_FREE, template=0, least=6, qos=4),
    ),
    "create_client": (
        CallSpec(2, Role.CLIENTS, receivers=_ADAPTOR, specified=True, least=0, explicit=True),
        CallSpec(2, Role.CLIENTS, receivers=_NODE, template=0, most=3, qos=1),
        CallSpec(2, Role.ACTION_CLIENTS, name=1, handle=0, scopes=_ACTION, template=0, least=2, most=4),
        CallSpec(2, Role.ACTION_CLIENTS, name=4, handle=0, scopes=_ACTION, template=0, least=5),
        CallSpec(2, Role.CLIENTS, name=1, handle=0, scopes=_FREE, template=0, least=2, most=4),
        CallSpec(2, Role.CLIENTS, name=3, handle=0, scopes=_FREE, template=0, least=5, qos=4),
    ),
    "create_server": (
        CallSpec(2, Role.ACTION_SERVERS, name=1, handle=0, scopes=_ACTION, template=0, least=5, most=7),
        CallSpec(2, Role.ACTION_SERVERS, name=4, handle=0, scopes=_ACTION, template=0, least=8, most=10),
    ),
    "create_polling_subscriber": (
        CallSpec(2, Role.SUBSCRIBES, name=1, handle=0, scopes=frozenset({"polling"}), template=0, least=2, qos=2),
    ),
    "create_generic_publisher": (CallSpec(2, Role.PUBLISHES, receivers=_NODE, spelled=1, least=3, qos=2),),
    "create_generic_subscription": (CallSpec(2, Role.SUBSCRIBES, receivers=_NODE, spelled=1, least=4, qos=2),),
}


def _method(  # noqa: PLR0913 - the columns of the table
    access: Access,
    least: int,
    most: int,
    *,
    output: int | None = None,
    default: int | None = None,
    returns: bool = False,
) -> ParameterSpec:
    """Return the entry of a method of a node whose first argument is the name of the parameter."""
    return ParameterSpec(
        2, access, output=output, default=default, returns=returns, least=least, most=most, receivers=_NODE
    )


def _helper(least: int, most: int) -> tuple[ParameterSpec, ...]:
    """Return the entry of a free function `f(node, name, default)` that declares a parameter unless it is declared."""
    return (ParameterSpec(2, Access.DECLARE, 1, None, 2, True, least=least, most=most, receivers=_NODE, helper=True),)


_PARAMETERS: Final[dict[str, tuple[ParameterSpec, ...]]] = {
    "declare_parameter": (_method(Access.DECLARE, 1, 4, default=1, returns=True),),
    "get_parameter": (
        _method(Access.READ, 1, 1, returns=True),
        _method(Access.READ, 2, 2, output=1),
    ),
    "get_parameter_or": (
        _method(Access.READ, 3, 3, output=1, default=2),
        _method(Access.READ, 2, 2, default=1, returns=True),
    ),
    "get_or_declare_parameter": _helper(2, 4),
    "getOrDeclareParameter": _helper(2, 4),
    "declare_or_get_parameter": (*_helper(2, 5), _method(Access.DECLARE, 1, 4, default=1, returns=True)),
    "declare_parameter_if_not_declared": _helper(2, 4),
    "declare_parameters": (
        ParameterSpec(2, Access.DECLARE, 1, None, 0, least=2, most=3, receivers=_NODE, listed=True),
    ),
    "set_parameter": (ParameterSpec(2, Access.WRITE, most=1, receivers=_NODE, listed=True, single=True),),
    "set_parameters": (ParameterSpec(2, Access.WRITE, most=1, receivers=_NODE, listed=True),),
    "set_parameters_atomically": (ParameterSpec(2, Access.WRITE, most=1, receivers=_NODE, listed=True),),
    "get_parameters": (ParameterSpec(2, Access.READ, 0, least=1, most=1, receivers=_NODE, listed=True),),
    "has_parameter": (_method(Access.READ, 1, 1),),
    "undeclare_parameter": (_method(Access.WRITE, 1, 1),),
}

_POLLING: Final = TypeSpec(2, Role.SUBSCRIBES, qos=2, usual=_LATEST)
_DIAGNOSTICS: Final = TypeSpec(
    2, Role.PUBLISHES, template=None, constants=(("/diagnostics", "diagnostic_msgs/DiagnosticArray"),)
)
_WRAPPERS: Final[dict[str, TypeSpec]] = {
    "InterProcessPollingSubscriber": _POLLING,
    "PollingSubscriber": _POLLING,
    "DiagnosticsInterface": _DIAGNOSTICS,
    "BasicDiagnosticsInterface": _DIAGNOSTICS,
}
"""The polling subscriber and the diagnostics of `autoware_utils`, which many packages build upon."""
_TYPES: Final[dict[str, TypeSpec]] = {
    "Subscriber": TypeSpec(2, Role.SUBSCRIBES, scopes=frozenset({"message_filters"}), qos=2),
    **_WRAPPERS,
}
_MARKS: Final[dict[str, MarkSpec]] = {}
_SAME_NODE: Final = frozenset({"shared_from_this", "get_node"})
"""Methods that bases outside of the build have: of a node, and of what a controller manager loads."""
_NAMES_OF_NODES: Final = {
    "get_name": "~",
    "get_fully_qualified_name": "~",
    "get_namespace": OWN_NAMESPACE,
    "get_effective_namespace": OWN_NAMESPACE,
}
"""A topic `name/x` of the node `name` is its private `~/x`."""
_EXPANDING: Final = frozenset(
    {
        "expand_topic_or_service_name",
        "resolve_topic_name",
        "resolve_topic_or_service_name",
        "resolve_service_name",
    }
)


_GIVEN_MEMBERS: Final[dict[str, dict[str, str]]] = {}
_GIVEN_ARGUMENTS: Final[dict[tuple[str, int], dict[int, str]]] = {}


class Ros2:
    """The dialect of rclcpp."""

    calls = _CALLS
    types = _TYPES
    parameters = _PARAMETERS
    marks = _MARKS
    given_members = _GIVEN_MEMBERS
    given_arguments = _GIVEN_ARGUMENTS
    handles = frozenset({"Node", "LifecycleNode"})
    wrappers = frozenset({*_WRAPPERS, *_ADAPTOR, "DebugPublisher"})

    def evaluate(
        self, evaluator: Evaluator, where: Expr, called: Callee, given: list[Expr], context: Context
    ) -> Alternatives | None:
        """Return nodes below nodes, and values of parameters."""
        name, receiver = called.name, called.receiver
        if name in ("create_sub_node", "create_subnode") and given:
            parent = evaluator.values(where.child(receiver), context) if receiver is not None else [(Handle(), context)]
            return below(evaluator, list(parent), given[0])
        if name.startswith("get_node_") and name.endswith("_interface"):
            return evaluator.values(where.child(receiver), context) if receiver is not None else [(Handle(), context)]
        if name == "make_shared" and called.scope[-1:] in (("Node",), ("LifecycleNode",)):
            return [(Handle(), context)]
        if name in _SAME_NODE and not given and not evaluator.program.functions(name):
            return [(Handle(), context)]
        if name in _NAMES_OF_NODES and not given and self._is_node_here(evaluator, where, receiver, context):
            return [(Text.of(_NAMES_OF_NODES[name]), context)]
        if name in _EXPANDING and given:
            return evaluator.values(given[0], context)
        if name == "getCameraInfoTopic" and given:
            return [(_beside(v), c) if isinstance(v, Text) else (v, c) for v, c in evaluator.values(given[0], context)]
        if name == "getCameraInfoTopic" and given:
            return [
                (camera_info_beside(v) if isinstance(v, Text) else v, c) for v, c in evaluator.texts(given[0], context)
            ]
        for spec in _PARAMETERS.get(name, ()):
            if spec.returns and spec.least <= len(given) <= spec.most:
                return self._parameter(evaluator, spec, given, context)
        return None

    def _is_node_here(self, evaluator: Evaluator, where: Expr, receiver: Node | None, context: Context) -> bool:
        """Tell whether a method is called on a node: its own class, or an object of a type that is one."""
        if receiver is None:
            cls = evaluator.types.class_around(where.unit, where.at)
            return cls is not None and self.is_node(evaluator, cls)
        return any(isinstance(value, Handle) for value, _ in evaluator.values(where.child(receiver), context))

    def _parameter(
        self, evaluator: Evaluator, spec: ParameterSpec, given: list[Expr], context: Context
    ) -> Alternatives:
        if spec.access is Access.READ and spec.default is None:
            return self._declared(evaluator, given, context)
        return value_of_parameter(evaluator, spec, None, given, context)

    def _declared(self, evaluator: Evaluator, given: list[Expr], context: Context) -> Alternatives:
        """Return the default that a parameter was declared with, anywhere in the node."""
        found: Alternatives = []
        for name, chosen in evaluator.texts(given[0], context):
            wanted = name.known if isinstance(name, Text) else None
            declared = evaluator.declared_default(wanted) if wanted is not None else None
            spec = _PARAMETERS["declare_parameter"][0]
            if declared is not None:
                arguments = [given[0], declared]
                found += value_of_parameter(evaluator, spec, None, arguments, chosen)
            else:
                found += value_of_parameter(evaluator, spec, None, given[:1], chosen)
        return found

    def construct(
        self, evaluator: Evaluator, kind: TypeName, given: list[Expr], context: Context
    ) -> Alternatives | None:
        """Return the handle that a node is."""
        if kind.name in _NODE or (kind.name == "ImageTransport" and given):
            return [(Handle(), context)]
        if kind.name == "Parameter" and given:
            return [(Sequence(tuple(row)), chosen) for row, chosen in evaluator.product(given[:2], context)]
        if kind.name == "DebugPublisher" and len(given) > 1:
            return below(evaluator, [(Handle(), context)], given[1])
        cls = evaluator.types.class_of(kind)
        if cls is not None and self.is_node(evaluator, cls):
            return [(Handle(), context)]
        return None

    def output(  # noqa: PLR0913, PLR0917 - the signature of the protocol
        self,
        evaluator: Evaluator,
        where: Expr,  # noqa: ARG002 - the signature of the protocol
        called: Callee,
        given: list[Expr],
        index: int,
        context: Context,
        previous: Callable[[Context], Alternatives],
    ) -> Alternatives | None:
        """Return what `get_parameter` and `get_parameter_or` leave in a variable."""
        for spec in _PARAMETERS.get(called.name, ()):
            if spec.output == index and spec.least <= len(given) <= spec.most:
                if spec.default is None:
                    found = self._declared(evaluator, given, context)
                    known = [pair for pair in found if isinstance(pair[0], Text) and pair[0].known is not None]
                    return known or value_of_parameter(evaluator, spec, None, given, context, previous)
                return value_of_parameter(evaluator, spec, None, given, context, previous)
        return None

    def is_node(self, evaluator: Evaluator, cls: Class) -> bool:
        """Tell whether a class derives from `rclcpp::Node` or a lifecycle node."""
        return any(
            syntax.simple_name(base) in _NODE for member in evaluator.program.family(cls) for base in member.bases
        )


def _beside(image: Text) -> Text:
    """Return the topic of the camera information that stands beside an image topic (image_transport/camera_common)."""
    *before, last = image.parts
    head, slash, _ = (last or "").rpartition("/")
    return replace(image, parts=(*before, f"{head}{slash}camera_info"))
