"""Errors about the arguments of a tool, in the form of the errors of `kg`: what is wrong, and what the tool takes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.errors import UsageError
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from pydantic import ValidationError

_CODE: Final = "KG003"
_MOST: Final = 60  # characters of a wrong value that are shown


def unknown_tool(name: str, tools: Iterable[str]) -> UsageError:
    """Return the error for a tool that does not exist."""
    names = sorted(tools)
    return UsageError(
        "KG001", f"unknown tool `{name}`", hint=did_you_mean(name, names) or f"Tools: {', '.join(names)}."
    )


def names_error(tool: str, schema: Mapping[str, Any], given: Iterable[str]) -> UsageError | None:
    """Return the error for arguments that are missing or that the tool does not have; None if there are none."""
    properties, needed, names = schema.get("properties", {}), schema.get("required", ()), set(given)
    unknown, missing = sorted(names - properties.keys()), [name for name in needed if name not in names]
    if not unknown and not missing:
        return None
    problems = [f"unknown argument `{name}`" for name in unknown]
    problems += [f"missing argument `{name}`" for name in missing]
    advice = [did_you_mean(name, properties) for name in unknown]
    return UsageError(_CODE, f"{tool}: {', '.join(problems)}", hint=_hint(schema, advice))


def values_error(tool: str, schema: Mapping[str, Any], error: ValidationError) -> UsageError:
    """Return the error for values that the tool does not accept."""
    problems = []
    for one in error.errors(include_url=False, include_context=False):
        name, value = ".".join(map(str, one["loc"])), repr(one["input"])
        shown = value if len(value) <= _MOST else f"{value[:_MOST]}..."
        problems.append(f"`{name}` is {shown}: {one['msg'][:1].lower()}{one['msg'][1:]}")
    return UsageError(_CODE, f"{tool}: {'; '.join(problems)}", hint=_hint(schema, ()))


def _hint(schema: Mapping[str, Any], advice: Iterable[str | None]) -> str:
    needed = schema.get("required", ())
    takes = [f"`{name}`: {_kind(one)}{', required' if name in needed else ''}" for name, one in
             schema.get("properties", {}).items()]  # fmt: skip
    return " ".join((*filter(None, advice), f"Arguments: {'; '.join(takes)}."))


def _kind(schema: Mapping[str, Any]) -> str:
    choices = [one for one in schema.get("anyOf", ()) if one.get("type") != "null"]
    if choices:
        return " or ".join(map(_kind, choices))
    if "enum" in schema:
        return " or ".join(map(repr, schema["enum"]))
    kind = str(schema.get("type", "any"))
    if kind == "array":
        return f"list of {_kind(schema.get('items', {}))}s"
    least, most = schema.get("minimum"), schema.get("maximum")
    if least is not None and most is not None:
        return f"{kind} from {least} to {most}"
    return f"{kind} from {least}" if least is not None else kind
