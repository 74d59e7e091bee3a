"""Names of interfaces, as a node resolves them: relative to namespaces, private, or with the node's own name."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from kg.holes import PARENT, Hole
from kg.symbolic.operators import NULL
from kg.symbolic.values import (
    ABSENT,
    Either,
    Mapping,
    Object,
    Sequence,
    Text,
    Truth,
    Unknown,
    Value,
    alternatives,
    as_text,
    concatenate,
    join,
    over,
    worse,
)

EMPTY: Final = Text.of("")
OWN_NAMESPACE: Final = Hole("namespace")
"""The namespace of the node itself, as a part of a text."""
PARENT_NAMESPACE: Final = Hole(PARENT)
"""What is above the namespace of the node, as a part of a text."""
NODE_NAME: Final = Hole("node")
"""The name of the node itself, as a part of a text."""


def below(namespace: Value, name: Value) -> Value:
    """Return a name resolved in a namespace; absolute and private names stay as they are."""
    if isinstance(namespace, Either) or isinstance(name, Either):
        return over((namespace, name), below)
    if isinstance(name, Unknown) and (namespace == EMPTY or not isinstance(namespace, Text)):
        return name
    name = as_text(name)
    first = name.parts[0] if name.parts else ""
    if first == NODE_NAME and (len(name.parts) == 1 or str(name.parts[1]).startswith("/")):
        rest = str(name.parts[1]) if len(name.parts) > 1 else ""
        return replace(name, parts=("~" + rest, *name.parts[2:]))
    if first == OWN_NAMESPACE:
        inner = name.parts[1:] or ("",)
        return replace(name, parts=(inner[0].lstrip("/"), *inner[1:]) if isinstance(inner[0], str) else inner)
    if first == PARENT_NAMESPACE or (isinstance(first, str) and first.startswith("/")):
        return name
    if isinstance(first, str) and first.startswith("~"):
        rest = first[1:].lstrip("/")
        return replace(name, parts=("~/" + rest if rest or len(name.parts) > 1 else "~", *name.parts[1:]))
    if not isinstance(namespace, Text) or namespace.exact == "":
        return name
    if name.exact == "":
        parameter = namespace.parameter or name.parameter
        return replace(namespace, resolution=worse(namespace.resolution, name.resolution), parameter=parameter)
    joined = concatenate(namespace, Text.of("/"), name)
    if isinstance(joined, Text) and isinstance(joined.parts[0], str):
        return replace(joined, parts=(joined.parts[0].replace("//", "/"), *joined.parts[1:]))
    return joined


def resolved(of: Value | None, name: Value) -> Value:
    """Return a name as a node or handle resolves it, so that no other handle resolves it again."""
    inner = below(namespace_of(of), name)
    if isinstance(inner, Either):
        return over((inner,), lambda one: resolved(None, one))
    first = inner.parts[0] if isinstance(inner, Text) and inner.parts else ""
    if not isinstance(inner, Text) or not isinstance(first, str) or first.startswith(("/", "~")) or not first:
        return inner
    return replace(inner, parts=(OWN_NAMESPACE, "/" + first, *inner.parts[1:]))


def namespace_of(of: Value | None) -> Value:
    """Return the namespace of relative names on a node or handle."""
    if isinstance(of, Object):
        carried = of.native.get("node")
        return namespace_of(carried) if carried is not None else of.native.get("namespace", EMPTY)
    if isinstance(of, Either):
        return join(*(namespace_of(item) for item in of.items))
    return EMPTY


def handle_namespace(arguments: list[Value]) -> Value:
    """Return the namespace of a handle, from the arguments of its constructor."""
    first = arguments[0] if arguments else EMPTY
    second = arguments[1] if len(arguments) > 1 else None
    if isinstance(first, Either):
        return join(*(handle_namespace([item, *arguments[1:]]) for item in first.items))
    if isinstance(first, Object):
        outer = namespace_of(first)
        if second is None or isinstance(second, (Mapping, Sequence)):
            return outer
        return below(outer, as_text(second) if isinstance(second, Unknown) else second)
    return EMPTY if isinstance(first, (Mapping, Sequence)) else below(EMPTY, first)


def given_namespace(arguments: list[Value], index: int, *, options_in_place: bool) -> Text | None:
    """Return the namespace that code gives a node of ROS 2, with a hole where it is not known; None without one.

    Names do not contain it, as a launch file can replace it. A constructor of C++ without a namespace has the options
    in its place (`options_in_place`), followed by a truth value at most.
    """
    values = alternatives(arguments[index]) if index < len(arguments) else ()
    given = [one for one in values if isinstance(one, Text | Unknown) and one not in (NULL, ABSENT)]
    if options_in_place and not any(isinstance(one, Text) for one in given):
        given = [] if len(arguments) - 1 == index or isinstance(arguments[-1], Truth) else given
    if len(given) > 1:
        return Text.hole("the node has one of several namespaces")
    own = as_text(given[0]) if given else EMPTY
    return None if own.exact is not None and not own.exact.strip("/") else own


def own_namespace(node: Value | None) -> Value:
    """Return the namespace of a node or handle as a text of the program."""
    inner = namespace_of(node)
    if not isinstance(inner, Text) or not inner.exact:
        return Text((OWN_NAMESPACE,))
    if inner.exact.startswith(("~", "/")):
        return inner
    return concatenate(Text((OWN_NAMESPACE, "/")), inner)


def with_node_name(name: Value, owner: Object | None) -> Value:
    """Return a name in which the node's own name is the one that the code gives it."""
    if isinstance(name, Either):
        return join(*(with_node_name(item, owner) for item in name.items))
    if not isinstance(name, Text) or NODE_NAME not in name.parts:
        return name
    while owner is not None and isinstance(outer := owner.native.get("of"), Object):
        owner = outer
    own = owner.native.get("name") if owner is not None else None
    if not isinstance(own, Text):
        return name
    joined = concatenate(*(own if part == NODE_NAME else Text((part,)) for part in name.parts))
    if not isinstance(joined, Text):
        return joined
    return replace(joined, resolution=name.resolution, parameter=name.parameter, reason=joined.reason or name.reason)


def camera_info(image: Value) -> Value:
    """Return the name of the camera info next to an image topic."""
    if isinstance(image, Either):
        return join(*(camera_info(item) for item in image.items))
    if not isinstance(image, Text):
        return image
    last = image.parts[-1] if image.parts else ""
    if isinstance(last, Hole):
        return replace(image, parts=(*image.parts[:-1], last, "/../camera_info"))
    head, slash, _ = last.rpartition("/")
    return replace(image, parts=(*image.parts[:-1], f"{head}{slash}camera_info"))
