"""Expressions as text, for people to read: close to the source, without its layout."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

from kg.symbolic import form

if TYPE_CHECKING:
    from kg.symbolic.form import Expression

_SELF: Final = ("this", "self", "cls")


def spelled(expression: Expression) -> str:
    """Return an expression as text; `...` stands for what has no short form."""
    match expression:
        case form.Literal(value=str() as text):
            return json.dumps(text, ensure_ascii=False)
        case form.Literal():
            return expression.written or str(expression.value).lower()
        case form.Name():
            return "::".join(expression.names)
        case form.Member():
            return f"{spelled(expression.of)}.{expression.name}"
        case form.Call():
            return f"{spelled(expression.function)}({', '.join(map(spelled, expression.arguments))})"
        case form.Construct():
            return f"{expression.type}({', '.join(map(spelled, expression.arguments))})"
        case form.Binary():
            return f" {expression.sign} ".join(map(spelled, expression.operands))
        case form.Unary():
            space = " " if expression.sign.isalpha() else ""
            return f"{expression.sign}{space}{spelled(expression.operand)}"
        case form.Index():
            return f"{spelled(expression.of)}[{spelled(expression.key)}]"
        case form.Choice():
            return f"{spelled(expression.condition)} ? {spelled(expression.then)} : {spelled(expression.otherwise)}"
        case form.Type():
            return str(expression)
        case _:
            return "..."


def member_label(member: form.Member) -> str:
    """Return what labels a member: its name, behind that of a variable that is not the object itself."""
    of = member.of
    return f"{of.names[-1]}_{member.name}" if isinstance(of, form.Name) and of.names[-1] not in _SELF else member.name
