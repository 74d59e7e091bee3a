"""The calls by which Python code declares nodes, interfaces, parameters and uses of frameworks, as tables.

A call is found by the package that its function comes from and the function's own name, so that
`actionlib.SimpleActionClient` and `actionlib.simple_action_client.SimpleActionClient` are one; methods of
nodes (`create_publisher`) by their name alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from kg.facts import Access, Role

__all__ = ["API_NAMES", "METHOD_NAMES", "Api", "Slot", "find_api"]


@dataclass(frozen=True, slots=True)
class Slot:
    """Where a call takes an argument: its position (from zero) and the names it can be given by."""

    position: int | None
    names: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Api:
    """What a call declares; `kind` is interface, parameter, parameters, node, gui or mark."""

    kind: str
    role: Role | None = None
    name: Slot | None = None
    type: Slot | None = None
    qos: Slot | None = None
    default: Slot | None = None
    node: Slot | None = None
    namespace: Slot | None = None
    access: Access | None = None
    mark: str | None = None
    ros: int | None = None


def _topic(role: Role, name: Slot, kind: Slot) -> Api:
    return Api("interface", role, name, kind, ros=1)


def _member(role: Role, kind: Slot, name: Slot, qos: Slot | None = None) -> Api:
    return Api("interface", role, name, kind, qos, ros=2)


def _parameter(access: Access, default: Slot | None = None) -> Api:
    return Api("parameter", name=Slot(0, ("param_name", "name", "key")), default=default, access=access, ros=1)


def _mark(key: str, name: Slot | None = None, node: Slot | None = None) -> Api:
    return Api("mark", mark=key, name=name, node=node)


_NODE: Final = Slot(0, ("node",))
_DATA_CLASS: Final = Slot(1, ("data_class",))
_ACTION_NAME: Final = Slot(0, ("name", "ns"))
_ACTION_TYPE: Final = Slot(1, ("ActionSpec",))
_ROS2_NODE: Final = Api("node", name=Slot(0, ("node_name",)), namespace=Slot(None, ("namespace",)), ros=2)
_LIFECYCLE: Final = Api(
    "node", name=Slot(0, ("node_name",)), namespace=Slot(None, ("namespace",)), mark="ros2.lifecycle", ros=2
)

_FUNCTIONS: Final[dict[str, Api]] = {
    "rospy.Publisher": _topic(Role.PUBLISHES, Slot(0, ("name",)), _DATA_CLASS),
    "rospy.Subscriber": _topic(Role.SUBSCRIBES, Slot(0, ("name",)), _DATA_CLASS),
    "rospy.wait_for_message": _topic(Role.SUBSCRIBES, Slot(0, ("topic",)), Slot(1, ("topic_type",))),
    "rospy.Service": _topic(Role.SERVICES, Slot(0, ("name",)), Slot(1, ("service_class",))),
    "rospy.ServiceProxy": _topic(Role.CLIENTS, Slot(0, ("name",)), Slot(1, ("service_class",))),
    "rospy.wait_for_service": _topic(Role.CLIENTS, Slot(0, ("service",)), Slot(None)),
    "rospy.init_node": Api("node", name=Slot(0, ("name",)), ros=1),
    "rospy.get_param": _parameter(Access.READ, Slot(1, ("default",))),
    "rospy.get_param_cached": _parameter(Access.READ, Slot(1, ("default",))),
    "rospy.has_param": _parameter(Access.READ),
    "rospy.search_param": _parameter(Access.READ),
    "rospy.set_param": _parameter(Access.WRITE, Slot(1, ("param_value",))),
    "rospy.delete_param": _parameter(Access.WRITE),
    "actionlib.SimpleActionServer": _topic(Role.ACTION_SERVERS, _ACTION_NAME, _ACTION_TYPE),
    "actionlib.ActionServer": _topic(Role.ACTION_SERVERS, _ACTION_NAME, _ACTION_TYPE),
    "actionlib.SimpleActionClient": _topic(Role.ACTION_CLIENTS, _ACTION_NAME, _ACTION_TYPE),
    "actionlib.ActionClient": _topic(Role.ACTION_CLIENTS, _ACTION_NAME, _ACTION_TYPE),
    "smach_ros.SimpleActionState": _topic(Role.ACTION_CLIENTS, Slot(0, ("action_name",)), Slot(1, ("action_spec",))),
    "smach_ros.ServiceState": _topic(Role.CLIENTS, Slot(0, ("service_name",)), Slot(1, ("service_spec",))),
    "smach_ros.MonitorState": _topic(Role.SUBSCRIBES, Slot(0, ("topic",)), Slot(1, ("msg_type",))),
    "smach_ros.IntrospectionServer": _mark("smach.introspection", name=Slot(0, ("server_name",))),
    "tf.TransformListener": _mark("tf.listener"),
    "tf.TransformBroadcaster": _mark("tf.broadcaster"),
    "tf2_ros.TransformListener": _mark("tf.listener"),
    "tf2_ros.TransformBroadcaster": _mark("tf.broadcaster"),
    "tf2_ros.StaticTransformBroadcaster": _mark("tf.static_broadcaster"),
    "tf2_ros.Buffer": _mark("tf2.buffer_debug"),
    "diagnostic_updater.Updater": _mark("diagnostics.updater"),
    "bondpy.Bond": _mark("bond", name=Slot(0, ("topic",))),
    "dynamic_reconfigure.Server": Api(
        "mark", type=Slot(0, ("type",)), namespace=Slot(2, ("namespace",)), mark="dynamic_reconfigure.server", ros=1
    ),
    "dynamic_reconfigure.Client": Api(
        "mark", namespace=Slot(0, ("name",)), mark="dynamic_reconfigure.client", ros=1
    ),
    "interactive_markers.InteractiveMarkerServer": _mark("interactive_markers.server", name=Slot(0, ("topic_ns",))),
    "jsk_topic_tools.ConnectionBasedTransport": _mark("jsk_topic_tools.transport"),
    "rclpy.create_node": _ROS2_NODE,
    "rclpy.Node": _ROS2_NODE,
    "rclpy.LifecycleNode": _LIFECYCLE,
    "rclpy.ActionServer": Api(
        "interface", Role.ACTION_SERVERS, Slot(2, ("action_name",)), Slot(1, ("action_type",)), node=_NODE, ros=2
    ),
    "rclpy.ActionClient": Api(
        "interface", Role.ACTION_CLIENTS, Slot(2, ("action_name",)), Slot(1, ("action_type",)), node=_NODE, ros=2
    ),
    "rclpy.wait_for_message": Api(
        "interface", Role.SUBSCRIBES, Slot(2, ("topic",)), Slot(0, ("msg_type",)), node=Slot(1, ("node",)), ros=2
    ),
}  # fmt: skip

_ROS2_FUNCTIONS: Final[dict[str, Api]] = {
    "message_filters.Subscriber": Api(
        "interface", Role.SUBSCRIBES, Slot(2, ("topic",)), Slot(1, ("msg_type",)), Slot(None, ("qos_profile",)),
        node=_NODE, ros=2,
    ),
}  # fmt: skip

_ROS1_FILTER: Final = _topic(Role.SUBSCRIBES, Slot(0, ("topic", "name")), Slot(1, ("data_class",)))

_METHODS: Final[dict[str, Api]] = {
    "create_publisher": _member(Role.PUBLISHES, Slot(0, ("msg_type",)), Slot(1, ("topic",)), Slot(2, ("qos_profile",))),
    "create_lifecycle_publisher": _member(
        Role.PUBLISHES, Slot(0, ("msg_type",)), Slot(1, ("topic",)), Slot(2, ("qos_profile",))
    ),
    "create_subscription": _member(
        Role.SUBSCRIBES, Slot(0, ("msg_type",)), Slot(1, ("topic",)), Slot(3, ("qos_profile",))
    ),
    "create_service": _member(Role.SERVICES, Slot(0, ("srv_type",)), Slot(1, ("srv_name",))),
    "create_client": _member(Role.CLIENTS, Slot(0, ("srv_type",)), Slot(1, ("srv_name",))),
    "declare_parameter": Api(
        "parameter", name=Slot(0, ("name",)), default=Slot(1, ("value",)), access=Access.DECLARE, ros=2
    ),
    "declare_parameters": Api(
        "parameters", namespace=Slot(0, ("namespace",)), default=Slot(1, ("parameters",)), access=Access.DECLARE, ros=2
    ),
    "get_parameter": Api("parameter", name=Slot(0, ("name",)), access=Access.READ, ros=2),
    "main": Api("gui", name=Slot(1, ("standalone",))),
    "get_parameter_or": Api("parameter", name=Slot(0, ("name",)), access=Access.READ, ros=2),
}

_CONNECTION_METHODS: Final[dict[str, Api]] = {
    "advertise": _topic(Role.PUBLISHES, Slot(0, ("name",)), _DATA_CLASS),
    "advertise_camera": _topic(Role.PUBLISHES, Slot(0, ("name",)), _DATA_CLASS),
}
"""Methods that classes inherit from jsk_topic_tools' transports when those are not in the build."""

_GUI_MAIN: Final = "rqt_gui.main.Main.main"
"""Starts a plugin of rqt by its name or class; no other method called `main` means anything."""

_CONNECTION_BASES: Final = frozenset({"ConnectionBasedTransport", "DiagnosticTransport", "LazyTransport"})

_NODE_BASES: Final = frozenset({"Node", "LifecycleNode"})

API_NAMES: Final = frozenset(
    {path.rpartition(".")[2] for path in (*_FUNCTIONS, *_ROS2_FUNCTIONS)}
    | {*_METHODS, *_CONNECTION_METHODS, "__init__"}
)
"""Last words of all calls of the tables: what a file must hold to declare anything."""


METHOD_NAMES: Final = frozenset({*_METHODS, *_CONNECTION_METHODS})
"""Those of them that are methods, whose object may be anything."""


def find_api(path: str, *, bound: bool, arguments: int = 0) -> Api | None:
    """Return what a call of the function with this full name declares.

    `bound` tells that it is a method of an object; `arguments` counts the positional arguments, which tells the
    ROS 2 form of `message_filters.Subscriber(node, type, topic)` from the ROS 1 form.
    """
    explicit = path.endswith(".__init__")
    path = path.removesuffix(".__init__")
    first, _, rest = path.partition(".")
    last = path.rpartition(".")[2]
    if first == "message_filters" and last == "Subscriber":
        return _ROS2_FUNCTIONS[f"{first}.{last}"] if arguments > 2 else _ROS1_FILTER  # noqa: PLR2004 - see above
    if last == "main" and path != _GUI_MAIN:
        return None
    if bound and last in _METHODS:
        return _METHODS[last]
    if bound and last in _CONNECTION_METHODS and rest.rpartition(".")[0].rpartition(".")[2] in _CONNECTION_BASES:
        return _CONNECTION_METHODS[last]
    if bound and not explicit:
        return None
    if path == "rclpy.lifecycle.Node":
        return _LIFECYCLE
    return _FUNCTIONS.get(f"{first}.{last}")
