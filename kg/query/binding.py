"""Parameters of a query.

A parameter is a variable with a VALUES block. So the query also runs unchanged in any editor:

    VALUES ?topic { "/scan" }        the value between the braces is the default
    VALUES ?package { UNDEF }        not bound unless a value is given

Binding replaces the text between the braces by a term serialized by the engine, so a value cannot inject query text. A
variable without such a block gets one at the beginning of the outermost group.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.errors import QueryError
from kg.syntax.lexer import Kind, Token, tokens

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pyoxigraph import Literal, NamedNode


def bind(text: str, values: Mapping[str, NamedNode | Literal]) -> str:
    """Return the query `text` with `values` (name of variable to term) in their VALUES blocks.

    Raises QueryError: KG505 for a name that is not a variable of the query.
    """
    if not values:
        return text
    lexed = list(tokens(text))
    blocks = _blocks(lexed)
    edits: list[tuple[int, int, str]] = []
    for name, term in values.items():
        if name in blocks:
            edits += [(start, end, f" {term} ") for start, end in blocks[name]]
        elif any(token.kind is Kind.VARIABLE and token.text[1:] == name for token in lexed):
            start = _first_group(lexed)
            edits.append((start, start, f" VALUES ?{name} {{ {term} }} "))
        else:
            variables = dict.fromkeys(f"?{token.text[1:]}" for token in lexed if token.kind is Kind.VARIABLE)
            hint = f"Its variables are {', '.join(variables)}." if variables else "It has no variables."
            raise QueryError("KG505", f"the query does not use the variable ?{name}", hint=hint)
    for start, end, replacement in sorted(edits, reverse=True):
        text = text[:start] + replacement + text[end:]
    return text


def defaults(text: str) -> dict[str, str]:
    """Return the text between the braces of each parameter's first block, by name of the variable."""
    return {name: text[slice(*spans[0])].strip() for name, spans in _blocks(list(tokens(text))).items()}


def _blocks(lexed: list[Token]) -> dict[str, list[tuple[int, int]]]:
    """Return the offsets between the braces of each `VALUES ?name { ... }`, by name."""
    blocks: dict[str, list[tuple[int, int]]] = {}
    for index in range(len(lexed) - 3):
        keyword, variable, opening = lexed[index : index + 3]
        if keyword.text.lower() == "values" and variable.kind is Kind.VARIABLE and opening.text == "{":
            closing = next((token for token in lexed[index + 3 :] if token.text == "}"), None)
            if closing:
                blocks.setdefault(variable.text[1:], []).append((opening.end, closing.start))
    return blocks


def _first_group(lexed: list[Token]) -> int:
    """Return the offset after the opening brace of the WHERE clause."""
    template = bool(lexed) and any(token.text.lower() == "construct" for token in lexed[:1])
    for index, token in enumerate(lexed):
        if token.text.lower() == "construct" and lexed[index + 1].text == "{":
            template = True
        if token.text == "{" and not template:
            return token.end
        if token.text == "}":
            template = False
    raise QueryError("KG505", "the query has no group to give values in")
