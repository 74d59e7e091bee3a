"""What both dialects share: joining namespaces of handles, and values of parameters."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kg.extract.values import (
    HOLE,
    OWN_NAMESPACE,
    Handle,
    Text,
    Unknown,
    Value,
    concatenate,
    in_own_namespace,
    worse,
)
from kg.facts import Resolution
from kg.names import join

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.cpp.api import ParameterSpec
    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Alternatives, Evaluator
    from kg.extract.cpp.unit import Expr

__all__ = ["as_parameter", "below", "camera_info_beside", "joined_name", "sub_handle", "value_of_parameter"]


def joined_name(namespace: Text, name: Text) -> Text:
    """Return a name as seen from the root of a handle's namespace."""
    prefix, body = namespace.pattern, name.pattern
    if prefix is None or body is None:
        return concatenate(namespace, Text.of("/"), name) if name.parts[:1] == (HOLE,) else name
    inside = in_own_namespace(body)
    if inside is not None:
        prefix, body = "", inside
    full = join(in_own_namespace(prefix) or "" if prefix.startswith(OWN_NAMESPACE) else prefix, body)
    pieces = full.split("{}")
    parts: list[str | None] = []
    for index, piece in enumerate(pieces):
        if index:
            parts.append(HOLE)
        if piece or len(pieces) == 1:
            parts.append(piece)
    from_namespace = bool(prefix) and not body.startswith(("/", "~"))
    resolution = worse(name.resolution, namespace.resolution) if from_namespace else name.resolution
    parameter = name.parameter or (namespace.parameter if from_namespace else None)
    reason = name.reason or namespace.reason
    return replace(name, parts=tuple(parts), resolution=resolution, parameter=parameter, reason=reason)


def camera_info_beside(image: Text) -> Text:
    """Return the `camera_info` topic beside an image topic (`image_transport::getCameraInfoTopic`)."""
    kept = list(image.parts)
    while kept:
        last = kept.pop()
        if last is not None and "/" in last:
            return replace(image, parts=(*kept, last[: last.rindex("/") + 1] + "camera_info"))
    return replace(image, parts=("camera_info",)) if image.known is not None else replace(image, parts=(HOLE,))


def sub_handle(parent: Value, name: Value) -> Value:
    """Return the handle for the namespace `name` below another handle."""
    base = parent.namespace if isinstance(parent, Handle) else Text.of("")
    node = parent.node_name if isinstance(parent, Handle) else None
    text = name if isinstance(name, Text) else concatenate(name)
    if text.known == "":
        return Handle(base, node)
    return Handle(joined_name(base, text), node)


def below(evaluator: Evaluator, parent: Alternatives, name: Expr) -> Alternatives:
    """Return the handles for the alternatives of a namespace below those of a parent."""
    found: Alternatives = []
    for handle, context in parent:
        for value, chosen in evaluator.values(name, context):
            is_text = isinstance(value, Text | Unknown)
            found.append((sub_handle(handle, value) if is_text else handle, chosen))
    return found


def value_of_parameter(  # noqa: PLR0913, PLR0917 - the whole of a call and its place
    evaluator: Evaluator,
    spec: ParameterSpec,
    handle: Expr | None,
    given: list[Expr],
    context: Context,
    previous: Callable[[Context], Alternatives] | None = None,
) -> Alternatives:
    """Return the value that a parameter has when nobody sets it: its default, else what its variable held before."""
    found: Alternatives = []
    handles: Alternatives = evaluator.values(handle, context) if handle is not None else [(Handle(), context)]
    for holder, after in handles:
        namespace = holder.namespace if isinstance(holder, Handle) else Text.of("")
        for name, chosen in evaluator.texts(given[spec.name], after):
            full = joined_name(namespace, name) if isinstance(name, Text) else None
            shown = full.pattern if full is not None else None
            found += _defaults(evaluator, spec, given, chosen, shown, previous)
    return found


def _defaults(  # noqa: PLR0913, PLR0917 - one step of one caller
    evaluator: Evaluator,
    spec: ParameterSpec,
    given: list[Expr],
    context: Context,
    parameter: str | None,
    previous: Callable[[Context], Alternatives] | None,
) -> Alternatives:
    if spec.default is not None and spec.default < len(given):
        values = evaluator.values(given[spec.default], context)
        return [(as_parameter(value, parameter), chosen) for value, chosen in values]
    before = previous(context) if previous is not None else []
    kept = [(as_parameter(v, parameter), c) for v, c in before if not isinstance(v, Unknown)]
    return kept or [(without_default(parameter), context)]


def without_default(parameter: str | None) -> Text:
    """Return the value of a parameter that has no default."""
    named = parameter or "with a name that is not known"
    reason = f"it is the parameter {named}, which has no default"
    return Text((HOLE,), Resolution.UNRESOLVED, parameter, reason)


def as_parameter(value: Value, parameter: str | None) -> Value:
    """Return a value as the default of a parameter."""
    if isinstance(value, Text):
        if value.known is None and value.parameter is not None:
            return value
        return replace(value, resolution=worse(value.resolution, Resolution.PARAMETER_DEFAULT), parameter=parameter)
    if isinstance(value, Unknown):
        reason = f"it is the parameter {parameter}, whose default is not known: {value.reason}"
        return Text((HOLE,), Resolution.UNRESOLVED, parameter, reason)
    return value
