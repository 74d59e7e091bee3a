"""Message types of interfaces, as `package/Type`: from classes, template arguments and callbacks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.facts import Role
from kg.symbolic.kinds import POINTER_ALIASES, pointee
from kg.symbolic.state import Frame, Invocation
from kg.symbolic.values import Bound, Closure, Kind, Object, Text, TypeValue, Value, alternatives, concatenate

if TYPE_CHECKING:
    from kg.symbolic.descriptions import Effect
    from kg.symbolic.form import Function
    from kg.symbolic.language import Language

_SUFFIXES: Final = POINTER_ALIASES | {"Request", "Response", "RequestPtr", "ResponsePtr"}
PARTS: Final = ("Request", "Response")
"""Suffixes of the classes of the parts of a service, which are also names of classes within its own."""
_JOINED: Final = ("ConstPtr", "Ptr", "ConstSharedPtr", "SharedPtr")
"""Suffixes of the types that roscpp generates next to a message: `std_msgs::EmptyConstPtr`."""
GENERATED: Final = frozenset({"msg", "srv", "action"})
"""Namespaces and modules of the types of interfaces, in those of their package."""
_WRAPPERS: Final = {"TypeAdapter": -1, "as": 0, "MessageEvent": 0, "ServiceEvent": 0, "WithTopicName": 0}
"""Templates around a message, with the index of the message among their arguments: `adapt_type<T>::as<Message>`."""
_FUNCTION: Final = ("()",)
"""The name of the type of a function, whose arguments are the types of its parameters."""
_FIELDS: Final = {"name": ("topic", "service"), "type": ("datatype",)}
"""Members of the options of an interface in roscpp."""
_OF_SERVICES: Final = frozenset({Role.SERVICES, Role.CLIENTS})
_SENT: Final[dict[tuple[str, ...], str]] = {
    ("pcl", "PointCloud"): "sensor_msgs/PointCloud2",
    ("cuda_blackboard", "CudaPointCloud2"): "sensor_msgs/PointCloud2",
    ("cuda_blackboard", "CudaImage"): "sensor_msgs/Image",
}
"""Classes of libraries and the messages that they are sent as."""
_TRANSPORTS: Final = {
    "compressed": "sensor_msgs/CompressedImage",
    "compressedDepth": "sensor_msgs/CompressedImage",
    "theora": "theora_image_transport/Packet",
}
"""The messages of the transports of `image_transport_plugins`."""
_PLAIN: Final = Text.of("raw")
"""The transport that sends images as they are."""
_ANY_TYPE: Final = "topic_tools/ShapeShifter"


def type_name(kind: Kind) -> str | None:
    """Return the message type of a class as `package/Type`."""
    kind = pointee(kind)
    if kind.name in _WRAPPERS and kind.arguments:
        return _type_of_argument(kind.arguments[_WRAPPERS[kind.name]])
    names = [name for name in kind.names if name]
    if (sent := _SENT.get(tuple(names[:2]))) is not None:
        return sent
    while len(names) > 2 and names[-1] in _SUFFIXES and names[-2] not in GENERATED:  # noqa: PLR2004 - package and type
        names = names[:-1]
    result = _of_names(names) if kind.cls is None else None
    if result is None or result == _ANY_TYPE:
        return None
    for suffix in _JOINED:
        result = result.removesuffix(suffix) if not result.endswith("/" + suffix) else result
    return result


def _service_name(kind: Kind) -> str | None:
    """Return the service of which a class is the request or the response, as `package/Type`."""
    kind = pointee(kind)
    if kind.name in _WRAPPERS and kind.arguments and isinstance(first := kind.arguments[0], TypeValue):
        return _service_name(first.kind)
    name = type_name(kind)
    if name is None or kind.name in _SUFFIXES:
        return name
    for suffix in PARTS:
        name = name if name.endswith("/" + suffix) else name.removesuffix(suffix)
    return name


def _of_names(names: list[str]) -> str | None:
    parts = [name for name in names if name]
    package, last = parts[:-1], parts[-1:]
    if len(package) > 2 and package[-2] in GENERATED and package[-1].startswith("_"):  # noqa: PLR2004 - package, kind, file
        package = package[:-1]
    if len(package) > 1 and package[-1] in GENERATED:
        package = package[-2:-1]
    named = len(package) == 1 and package[0] != "std" and package[0] not in GENERATED
    return f"{package[0]}/{last[0]}" if named else None


def _type_of_argument(argument: Value | None) -> str | None:
    return type_name(argument.kind) if isinstance(argument, TypeValue) else None


def message_type(language: Language, effect: Effect, call: Invocation) -> str | None:
    """Return the type of an interface, from the first source of its description that has one."""
    name = next(
        (one for one in (_from(language, source, call, effect) for source in effect.types) if one is not None), None
    )
    if name is not None and effect.role in (Role.ACTION_SERVERS, Role.ACTION_CLIENTS):
        return name if name.endswith("/Action") else name.removesuffix("Action")
    return name


def transported(effect: Effect, call: Invocation, name: Value, kind: str | None) -> tuple[Value, str | None]:
    """Return the name and the type of an interface: those of the transport of images if the call names one."""
    if effect.transport is None:
        return name, kind
    hints = call.arguments.values[effect.transport :]
    given = (one.native.get("node") if isinstance(one, Object) else one for one in hints)
    transport = next((one for one in given if isinstance(one, Text) and one.exact != ""), _PLAIN)
    if transport.exact == _PLAIN.exact:
        return name, kind
    return concatenate(name, Text.of("/"), transport), _TRANSPORTS.get(transport.exact or "")


def _from(language: Language, source: str, call: Invocation, effect: Effect) -> str | None:
    what, _, index = source.partition(":")
    if "/" in source:
        return source
    frame = call.arguments.frame
    if what in ("template", "receiver"):
        of = call.arguments.template if what == "template" else call.kind.arguments if call.kind is not None else ()
        first = next(iter(of), None)
        named = _service_name if effect.ros == 1 and effect.role in _OF_SERVICES and len(of) > 1 else type_name
        return named(language.message(first.kind, frame)) if isinstance(first, TypeValue) else None
    argument = call.argument(int(index))
    if argument is None:
        return None
    if what == "callback":
        named = _service_name if effect.ros == 1 and effect.role is Role.SERVICES else type_name
        called = _callback_type(language, argument, 2 if effect.role is Role.SERVICES else 1)
        name = named(called) if called is not None else None
        stated = _first_parameter(language, call, int(index)) if name is None else None
        return named(stated) if stated is not None else name
    if what == "text":
        return _of_names(argument.exact.split("/")) if isinstance(argument, Text) and argument.exact else None
    if isinstance(argument, TypeValue):
        return _type_of_argument(argument) if GENERATED & set(argument.kind.names[:-1]) else None
    if not isinstance(argument, Object):
        return None
    if what == "options":
        kind = option(argument, "type")
        return kind.exact if isinstance(kind, Text) else None
    return _service_name(argument.kind) if effect.ros == 1 and effect.role in _OF_SERVICES else type_name(argument.kind)


def option(options: Object, what: str) -> Value | None:
    """Return the name or type that an options object gives an interface: one that is assigned, or given to a call."""
    fields = _FIELDS[what] if options.kind.name.endswith("Options") else ()
    assigned = (options.fields.get(field) for field in fields)
    return next((one for one in assigned if one is not None), options.native.get(f"options {what}"))


def _first_parameter(language: Language, call: Invocation, index: int) -> Kind | None:
    """Return the message that a variable of the type `function<void(const Message&)>` takes, by its argument."""
    kind = call.declared(index, language)
    signature = kind.arguments[0] if kind is not None and kind.name == "function" and kind.arguments else None
    if not isinstance(signature, TypeValue) or signature.kind.names != _FUNCTION:
        return None
    first = next(iter(signature.kind.arguments), None)
    return language.message(first.kind, call.arguments.frame) if isinstance(first, TypeValue) else None


def _callback_type(language: Language, callback: Value, usual: int) -> Kind | None:
    """Return the type of the first parameter of a callback; of overloads, of that with about `usual` parameters."""
    for one in alternatives(callback):
        callee = _callee(language, one, usual)
        if callee is None:
            continue
        function, frame, skip = callee
        kind = function.parameters[skip].type if len(function.parameters) > skip else None
        message = language.kind_of(kind, frame) if kind is not None else None
        if message is not None:
            return language.message(message, frame)
    return None


def _callee(language: Language, callback: Value, usual: int) -> tuple[Function, Frame, int] | None:
    """Return the function that a callback runs, a frame for its types, and the number of bound parameters."""
    if isinstance(callback, Closure):
        around = callback.frame
        return callback.function, Frame(around.unit, around.scope, parent=around), len(callback.bound)
    if isinstance(callback, Object):
        callback = Bound("operator()", callback)
    if not isinstance(callback, Bound):
        return None
    skip, owner = callback.skip, callback.of.kind if isinstance(callback.of, Object) else callback.of
    if owner is not None:
        listed = language.declarations(owner, callback.name)
    else:
        listed = [(function, {}) for function in callback.functions]
    if not listed:
        return None
    function, bound = min(listed, key=lambda pair: abs(len(pair[0].parameters) - skip - usual))
    types = {**bound, **dict(zip(function.template, callback.template, strict=False))}
    return function, Frame(function.unit, function.scope, types=types), skip
