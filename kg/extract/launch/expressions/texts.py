"""From values to texts of launch, and back to plain text where all of it is known."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Final, Protocol

from kg.extract.launch.expressions.values import Choice, Guarded, Items, Substitution, TextLike, Unknown, Words

if TYPE_CHECKING:
    from kg.extract.launch.expressions.values import Part, Text, Value

__all__ = ["Settler", "join", "known", "reason_of", "simplify", "to_text", "unknown_text", "words", "written"]

_MAX_PARTS: Final = 2_000


class Settler(Protocol):
    """Gives the texts of substitutions that are performed while the file is read."""

    def settled(self, text: Text) -> str | None:
        """Return a text performed; None where a part of it is not known."""


def unknown_text(reason: str) -> Text:
    """Return the text that cannot be known."""
    return (Substitution("unknown", reason=reason),)


def reason_of(value: Value) -> str:
    """Return why a value cannot be used as what it should be."""
    if isinstance(value, Unknown | Choice):
        return value.reason
    if isinstance(value, TextLike):
        return reason_of(value.as_text())
    if isinstance(value, Guarded):
        return f"it depends on `{value.condition.written}`"
    if isinstance(value, Words):
        for part in value.parts:
            if isinstance(part, Substitution):
                return part.reason or f"a substitution `{part.kind}` is known only when it is executed"
    return f"a value of the type {type(value).__name__.lower()} cannot stand here"


def join(parts: list[Part]) -> Text:
    """Return parts with neighbouring plain texts joined."""
    merged: list[Part] = []
    for part in parts[:_MAX_PARTS]:
        if isinstance(part, str) and merged and isinstance(merged[-1], str):
            merged[-1] += part
        elif part != "":
            merged.append(part)
    if len(parts) > _MAX_PARTS:
        merged.append(Substitution("unknown", reason="the text has too many parts"))
    return tuple(merged)


def to_text(value: Value) -> Text:
    """Return a value as the text that launch makes of it: a text, a substitution, or a list of both to be joined."""
    if isinstance(value, str):
        return (value,) if value else ()
    if isinstance(value, Words):
        return value.parts
    if isinstance(value, TextLike):
        return to_text(value.as_text())
    if isinstance(value, bool | int | float):
        return (str(value),)
    if isinstance(value, Items | tuple):
        return join([part for item in value[:_MAX_PARTS] for part in to_text(item)])
    return unknown_text(reason_of(value))


def simplify(parts: Text, *, lazy: bool = False) -> str | Words:
    """Return parts as a plain text where they are one."""
    merged = join(list(parts))
    if not merged:
        return "" if not lazy else Words((), lazy=True)
    if len(merged) == 1 and isinstance(merged[0], str) and not lazy:
        return merged[0]
    return Words(merged, lazy)


def words(text: str, reason: str, hole: str) -> str | Words:
    """Return a text in which `hole` stands for parts that are unknown for the reason."""
    pieces = text.split(hole)
    parts: list[Part] = [pieces[0]]
    for piece in pieces[1:]:
        parts += [Substitution("unknown", reason=reason), piece]
    return simplify(tuple(parts))


def known(value: Value, context: Settler | None = None) -> str | None:
    """Return a text that is wholly known now; None for all else. Within an `OpaqueFunction` there is a context."""
    if isinstance(value, str):
        return value
    if isinstance(value, TextLike):
        return known(value.as_text(), context)
    if not isinstance(value, Words) or value.lazy:
        return None
    parts: list[str] = []
    for part in value.parts:
        found = part if isinstance(part, str) else _settled(part, context)
        if found is None:
            return None
        parts.append(found)
    return "".join(parts)


def _settled(part: Substitution, context: Settler | None) -> str | None:
    """Return what a variable of the environment gives: its default, since the environment is never read."""
    if part.kind != "env":
        return None
    if context is not None:
        return context.settled((part,))
    return known(simplify(part.arguments[1])) if len(part.arguments) > 1 else None


def written(node: ast.AST | None) -> str:
    """Return a node in the words of the file, in one line."""
    return " ".join(ast.unparse(node).split())[:200] if node is not None else ""
