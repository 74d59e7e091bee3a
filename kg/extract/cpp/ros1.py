"""The tables of ROS 1: roscpp and the libraries that make interfaces on its handles.

Sources: the headers and wiki pages of roscpp, nodelet, image_transport, message_filters, actionlib, tf, tf2_ros,
dynamic_reconfigure, diagnostic_updater, pcl_ros, realtime_tools and camera_info_manager.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.cpp.api import ARGUMENT_LISTS, CallSpec, MarkSpec, ParameterSpec, TypeSpec
from kg.extract.cpp.handles import below, value_of_parameter
from kg.extract.values import OWN_NAMESPACE, Handle, Text, concatenate
from kg.facts import Access, Role

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Alternatives, Evaluator
    from kg.extract.cpp.syntax import Callee
    from kg.extract.cpp.types import TypeName
    from kg.extract.cpp.unit import Class, Expr

__all__ = ["Ros1"]

_EITHER: Final = 0
"""Libraries that ROS 1 and ROS 2 have alike do not tell which of them a node is of."""
_NODE_HANDLE: Final = frozenset({"NodeHandle"})
_IMAGES: Final = frozenset({"ImageTransport"})
_IMAGE: Final = "sensor_msgs/Image"
_SERVICE: Final = frozenset({"service"})
_PARAM: Final = frozenset({"param"})
_SUBSCRIBE: Final = frozenset({"SubscribeOptions"})
_ADVERTISE: Final = frozenset({"AdvertiseOptions"})
_ADVERTISE_SERVICE: Final = frozenset({"AdvertiseServiceOptions"})
_SERVICE_CLIENT: Final = frozenset({"ServiceClientOptions"})

_OPTIONS: Final = (
    CallSpec(1, Role.SUBSCRIBES, receivers=_SUBSCRIBE, template=0, callback=2, least=3, options=True, exact=True),
    CallSpec(1, Role.PUBLISHES, receivers=_ADVERTISE, template=0, least=2, options=True, exact=True),
    CallSpec(
        1,
        Role.SERVICES,
        receivers=_ADVERTISE_SERVICE,
        template=0,
        callback=1,
        least=2,
        service=True,
        options=True,
        exact=True,
    ),
    CallSpec(1, Role.CLIENTS, receivers=_SERVICE_CLIENT, template=0, options=True, exact=True, service=True),
)
_CALLS: Final[dict[str, tuple[CallSpec, ...]]] = {
    "advertise": (
        CallSpec(1, Role.PUBLISHES, receivers=_NODE_HANDLE, template=0, least=2),
        CallSpec(_EITHER, Role.PUBLISHES, receivers=_IMAGES, fixed=_IMAGE, least=2, mark="image_transport.publisher"),
        CallSpec(
            _EITHER,
            Role.PUBLISHES,
            receivers=frozenset({"PointCloudTransport"}),
            fixed="sensor_msgs/PointCloud2",
            least=2,
            mark="point_cloud_transport.publisher",
        ),
        CallSpec(1, Role.PUBLISHES, name=1, handle=0, template=0, least=2, inherited=True),
        CallSpec(1, Role.PUBLISHES, name=1, handle=0, receivers=frozenset({"ShapeShifter"}), least=3, exact=True),
        CallSpec(
            1,
            Role.PUBLISHES,
            name=1,
            handle=0,
            receivers=frozenset({"Publisher"}),
            fixed="sensor_msgs/PointCloud2",
            least=3,
            exact=True,
        ),
    ),
    "advertiseCamera": (
        CallSpec(
            _EITHER, Role.PUBLISHES, receivers=_IMAGES, fixed=_IMAGE, camera=True, mark="image_transport.publisher"
        ),
        CallSpec(
            1,
            Role.PUBLISHES,
            name=1,
            handle=0,
            fixed=_IMAGE,
            least=2,
            camera=True,
            inherited=True,
            mark="image_transport.publisher",
        ),
    ),
    "advertiseImage": (
        CallSpec(
            1, Role.PUBLISHES, name=1, handle=0, fixed=_IMAGE, least=2, inherited=True, mark="image_transport.publisher"
        ),
    ),
    "subscribe": (
        CallSpec(1, Role.SUBSCRIBES, receivers=_NODE_HANDLE, template=0, callback=2, least=3),
        CallSpec(_EITHER, Role.SUBSCRIBES, receivers=_IMAGES, fixed=_IMAGE, least=2, mark="image_transport.subscriber"),
        CallSpec(
            _EITHER,
            Role.SUBSCRIBES,
            receivers=frozenset({"PointCloudTransport"}),
            fixed="sensor_msgs/PointCloud2",
            least=2,
        ),
        CallSpec(
            _EITHER,
            Role.SUBSCRIBES,
            name=1,
            handle=0,
            receivers=frozenset({"Subscriber"}),
            receiver_template=True,
            exact=True,
            least=2,
            qos=2,
        ),
        CallSpec(
            _EITHER,
            Role.SUBSCRIBES,
            name=1,
            handle=0,
            receivers=frozenset({"SubscriberFilter"}),
            fixed=_IMAGE,
            least=2,
            mark="image_transport.subscriber",
        ),
    ),
    "subscribeCamera": (
        CallSpec(
            _EITHER,
            Role.SUBSCRIBES,
            receivers=_IMAGES,
            fixed=_IMAGE,
            camera=True,
            least=2,
            mark="image_transport.subscriber",
        ),
    ),
    "serviceClient": (CallSpec(1, Role.CLIENTS, receivers=_NODE_HANDLE, template=0, service=True),),
    "advertiseService": (
        CallSpec(1, Role.SERVICES, receivers=_NODE_HANDLE, template=0, callback=1, least=2, service=True),
    ),
    "init": _OPTIONS,
    "initByFullCallbackType": _OPTIONS,
    "create": tuple(replace(spec, receivers=frozenset(), scopes=spec.receivers) for spec in _OPTIONS),
    "call": (CallSpec(1, Role.CLIENTS, scopes=_SERVICE, typed=1, least=2, service=True),),
    "waitForService": (CallSpec(1, Role.CLIENTS, scopes=_SERVICE),),
    "exists": (CallSpec(1, Role.CLIENTS, scopes=_SERVICE),),
    "createClient": (CallSpec(1, Role.CLIENTS, scopes=_SERVICE, template=0, service=True),),
    "waitForMessage": (
        CallSpec(1, Role.SUBSCRIBES, scopes=frozenset({"topic"}), template=0, handle=1, least=3, most=3),
        CallSpec(1, Role.SUBSCRIBES, scopes=frozenset({"topic"}), template=0),
    ),
}

_HANDLED: Final = {"ros": 1, "receivers": _NODE_HANDLE}


def _reads(
    output: int | None, default: int | None, *, returns: bool = False, least: int = 1, most: int = 3
) -> tuple[ParameterSpec, ...]:
    return (
        ParameterSpec(1, Access.READ, 0, output, default, returns, frozenset(), least, most, _NODE_HANDLE),
        ParameterSpec(1, Access.READ, 0, output, default, returns, _PARAM, least, most),
    )


_PARAMETERS: Final[dict[str, tuple[ParameterSpec, ...]]] = {
    "param": (*_reads(1, 2, least=3), *_reads(None, 1, returns=True, least=2, most=2)),
    "getParam": _reads(1, None, least=2, most=2),
    "getParamCached": _reads(1, None, least=2, most=2),
    "hasParam": _reads(None, None, most=1),
    "searchParam": _reads(None, None, least=2, most=2),
    "get": (ParameterSpec(1, Access.READ, 0, 1, None, False, _PARAM, 2, 2),),
    "getCached": (ParameterSpec(1, Access.READ, 0, 1, None, False, _PARAM, 2, 2),),
    "has": (ParameterSpec(1, Access.READ, 0, None, None, False, _PARAM, 1, 1),),
    "search": (ParameterSpec(1, Access.READ, 0, None, None, False, _PARAM, 2, 2),),
    "readVectorParameter": (
        ParameterSpec(1, Access.READ, 1, least=3, most=3, scopes=frozenset({"jsk_topic_tools"}), handle=0),
    ),
    "setParam": (ParameterSpec(1, Access.WRITE, 0, None, 1, False, frozenset(), 2, 2, _NODE_HANDLE),),
    "deleteParam": (ParameterSpec(1, Access.WRITE, 0, None, None, False, frozenset(), 1, 1, _NODE_HANDLE),),
    "set": (ParameterSpec(1, Access.WRITE, 0, None, 1, False, _PARAM, 2, 2),),
    "del": (ParameterSpec(1, Access.WRITE, 0, None, None, False, _PARAM, 1, 1),),
}

_ACTIONLIB: Final = frozenset({"actionlib"})
_TYPES: Final[dict[str, TypeSpec]] = {
    "SimpleActionServer": TypeSpec(1, Role.ACTION_SERVERS, floating=True, scopes=_ACTIONLIB, drop="Action"),
    "ActionServer": TypeSpec(1, Role.ACTION_SERVERS, floating=True, scopes=_ACTIONLIB, drop="Action"),
    "SimpleActionClient": TypeSpec(1, Role.ACTION_CLIENTS, floating=True, scopes=_ACTIONLIB, drop="Action"),
    "ActionClient": TypeSpec(1, Role.ACTION_CLIENTS, floating=True, scopes=_ACTIONLIB, drop="Action"),
    "Subscriber": TypeSpec(_EITHER, Role.SUBSCRIBES, scopes=frozenset({"message_filters"}), qos=2),
    "SubscriberFilter": TypeSpec(
        _EITHER,
        Role.SUBSCRIBES,
        template=None,
        fixed=_IMAGE,
        scopes=frozenset({"image_transport"}),
        mark="image_transport.subscriber",
    ),
    "Server": TypeSpec(1, None, scopes=frozenset({"dynamic_reconfigure"}), mark="dynamic_reconfigure.server"),
    "Loader": TypeSpec(
        1,
        Role.SERVICES,
        scopes=frozenset({"nodelet"}),
        template=None,
        private=True,
        constants=(
            ("load_nodelet", "nodelet/NodeletLoad"),
            ("unload_nodelet", "nodelet/NodeletUnload"),
            ("list", "nodelet/NodeletList"),
        ),
    ),
    "RealtimePublisher": TypeSpec(_EITHER, Role.PUBLISHES, scopes=frozenset({"realtime_tools"})),
    "Publisher": TypeSpec(
        1, Role.PUBLISHES, scopes=frozenset({"pcl_ros"}), fixed="sensor_msgs/PointCloud2", template=None
    ),
    "CameraInfoManager": TypeSpec(
        _EITHER, Role.SERVICES, template=None, constants=(("set_camera_info", "sensor_msgs/SetCameraInfo"),)
    ),
}

_MARKS: Final[dict[str, MarkSpec]] = {
    "TransformListener": MarkSpec("tf.listener"),
    "TransformBroadcaster": MarkSpec("tf.broadcaster"),
    "StaticTransformBroadcaster": MarkSpec("tf.static_broadcaster"),
    "Updater": MarkSpec("diagnostics.updater"),
    "TestRunner": MarkSpec("diagnostics.self_test"),
    "Bond": MarkSpec("bond", detail=0),
    "InteractiveMarkerServer": MarkSpec("interactive_markers.server", detail=0),
}
_GETTERS: Final = {
    "getNodeHandle": "",
    "getMTNodeHandle": "",
    "getPrivateNodeHandle": "~",
    "getMTPrivateNodeHandle": "~",
}
_CARRIERS: Final = frozenset({"ImageTransport", "PointCloudTransport"})


_HANDED_DOWN: Final = {"nh_": "", "pnh_": "~"}
_GIVEN_MEMBERS: Final = {
    "ConnectionBasedNodelet": _HANDED_DOWN,
    "DiagnosticNodelet": _HANDED_DOWN,
    "PCLNodelet": _HANDED_DOWN,
    "NodeletLazy": _HANDED_DOWN,
    "ROSPublisherBase": _HANDED_DOWN,
}
"""jsk_topic_tools, pcl_ros, nodelet_topic_tools; their `onInit` sets these."""
_GIVEN_ARGUMENTS: Final = {
    ("init", 2): {1: "~"},
    ("initRequest", 4): {1: "", 2: "~"},
    ("init", 3): {1: "", 2: "~"},
}
"""controller_interface: the node handle of the controller manager, and the controller's own."""


class Ros1:
    """The dialect of roscpp."""

    calls = _CALLS
    types = _TYPES
    parameters = _PARAMETERS
    marks = _MARKS
    given_members = _GIVEN_MEMBERS
    given_arguments = _GIVEN_ARGUMENTS
    wrappers: frozenset[str] = frozenset()
    handles = frozenset({"NodeHandle", "ImageTransport", "PointCloudTransport"})

    def evaluate(
        self, evaluator: Evaluator, where: Expr, called: Callee, given: list[Expr], context: Context
    ) -> Alternatives | None:
        """Return node handles of nodelets, names made by `ros::names`, and values of parameters."""
        name = called.name
        if name in _GETTERS:
            return [(Handle(Text.of(_GETTERS[name])), context)]
        if name == "getNamespace" and called.receiver is not None:
            handles = evaluator.values(where.child(called.receiver), context)
            return [(_shown(h.namespace), c) for h, c in handles if isinstance(h, Handle)] or None
        if name == "getName" and called.scope[-1:] == ("this_node",):
            return [(Text.of("~"), context)]
        if name == "getNamespace" and called.scope[-1:] == ("this_node",):
            return [(Text.of(OWN_NAMESPACE), context)]
        if name == "append" and called.scope[-1:] == ("names",) and len(given) > 1:
            rows = evaluator.product(given[:2], context)
            return [(concatenate(left, Text.of("/"), right), c) for (left, right), c in rows]
        if (
            name in ("resolve", "remap", "clean", "resolveName")
            and given
            and (called.scope or called.receiver is not None)
        ):
            return self._resolved(evaluator, where, called, given, context)
        for spec in _PARAMETERS.get(name, ()):
            if spec.returns and _matches(spec, called, len(given)):
                handle = where.child(called.receiver) if called.receiver is not None else None
                return value_of_parameter(evaluator, spec, handle, given, context)
        return None

    def _resolved(
        self, evaluator: Evaluator, where: Expr, called: Callee, given: list[Expr], context: Context
    ) -> Alternatives:
        """Return a name that the code resolves itself: the same name seen from the handle."""
        if called.name != "resolveName" or called.receiver is None:
            texts = [(v, c) for v, c in evaluator.values(given[-1], context) if not _is_flag(v)]
            return texts or evaluator.values(given[0], context)
        handles = evaluator.values(where.child(called.receiver), context)
        named = below(evaluator, handles, given[0])
        return [(h.namespace if isinstance(h, Handle) else h, c) for h, c in named]

    def construct(
        self, evaluator: Evaluator, kind: TypeName, given: list[Expr], context: Context
    ) -> Alternatives | None:
        """Return the handle that a `ros::NodeHandle`, or something that carries one, is."""
        if kind.name in _CARRIERS:
            return evaluator.values(given[0], context) if given else None
        if kind.name != "NodeHandle":
            return None
        if not given:
            return [(Handle(), context)]
        first = evaluator.values(given[0], context)
        found: Alternatives = []
        for value, chosen in first:
            if isinstance(value, Text):
                found += below(evaluator, [(Handle(), chosen)], given[0])
            elif len(given) > 1:
                found += below(evaluator, [(value, chosen)], given[1])
            else:
                found.append((value, chosen))
        return found

    def output(  # noqa: PLR0913, PLR0917 - the signature of the protocol
        self,
        evaluator: Evaluator,
        where: Expr,
        called: Callee,
        given: list[Expr],
        index: int,
        context: Context,
        previous: Callable[[Context], Alternatives],
    ) -> Alternatives | None:
        """Return what `param`, `getParam` and their like leave in a variable."""
        if called.name in ARGUMENT_LISTS and index == ARGUMENT_LISTS[called.name]:
            return evaluator.values(given[1], context)
        for spec in _PARAMETERS.get(called.name, ()):
            if spec.output == index and _matches(spec, called, len(given)):
                handle = where.child(called.receiver) if called.receiver is not None else None
                return value_of_parameter(evaluator, spec, handle, given, context, previous)
        return None

    def is_node(self, evaluator: Evaluator, cls: Class) -> bool:  # noqa: ARG002 - the signature of the protocol
        """Tell whether a class is a node handle by itself: none is in ROS 1, nodelets have handles."""
        return False


def _shown(namespace: Text) -> Text:
    """Return the namespace of a handle as a text: one that is relative stands in that of the node."""
    if namespace.known is None or namespace.known.startswith(("/", "~", OWN_NAMESPACE)):
        return namespace
    return concatenate(Text.of(f"{OWN_NAMESPACE}/"), namespace) if namespace.known else Text.of(OWN_NAMESPACE)


def _is_flag(value: object) -> bool:
    return not isinstance(value, Text)


def _matches(spec: ParameterSpec, called: Callee, count: int) -> bool:
    if not spec.least <= count <= spec.most:
        return False
    if spec.scopes:
        return called.receiver is None and called.scope[-1:] != () and called.scope[-1] in spec.scopes
    return called.receiver is not None
