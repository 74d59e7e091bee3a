"""Expressions as text: splitting them at `&&`, and what makes them fail.

All functions work on tokens: strings and IRIs are never taken for names or signs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.rules.form import Expression
from kg.syntax.lexer import Kind, Token, bare, partner, tokens_of

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from kg.errors import Place

UNBOUND: Final = "(!<urn:kg:unbound>)"
"""An expression that is always in error, as an unbound variable is: an IRI has no effective boolean value."""

_FORGIVING: Final = frozenset({"||", "&&", "BOUND", "COALESCE", "IF", "IN", "EXISTS"})
"""What may have a value although an operand is in error (SPARQL 1.1, section 17.2)."""

_TESTS: Final = frozenset({"BOUND", "ISIRI", "ISURI", "ISBLANK", "ISLITERAL", "ISNUMERIC", "SAMETERM"})
"""Functions that have a value for all terms."""

_GIVE_EXISTING_TERMS: Final = _TESTS | {
    *("LANGMATCHES", "CONTAINS", "STRSTARTS", "STRENDS", "REGEX", "HASLANG", "HASLANGDIR", "ISTRIPLE"),
    *("IF", "COALESCE", "IN", "NOT", "EXISTS", "TRUE", "FALSE", "SUBJECT", "PREDICATE", "OBJECT"),
}
"""Words whose value is a truth value, an operand or a part of one."""

_TERMS: Final = frozenset({Kind.IRI, Kind.STRING, Kind.VARIABLE, Kind.NUMBER, Kind.NAME})


def _word(token: Token) -> str:
    return token.text.upper() if token.kind is Kind.WORD else token.text


def variables(text: str) -> tuple[str, ...]:
    """Return the names of the variables in an expression, in order, each once."""
    return tuple(dict.fromkeys(token.text[1:] for token in tokens_of(text) if token.kind is Kind.VARIABLE))


def expression(text: str, place: Place | None = None) -> Expression:
    """Return an expression of the internal form."""
    return Expression(text, variables(text), _mints(tokens_of(text)), place)


def _mints(tokens: Sequence[Token]) -> bool:
    """Return whether the value may be a new term: arithmetic, triple terms, all functions not known to be safe."""
    for index, token in enumerate(tokens):
        follows = tokens[index + 1 : index + 2]
        if token.kind is Kind.WORD and _word(token) not in _GIVE_EXISTING_TERMS:
            return True
        if token.kind is Kind.IRI and follows and follows[0].text == "(":
            return True
        if token.text in {"*", "/", "<<("} or (token.text in {"+", "-"} and not _is_sign(tokens, index)):
            return True
    return False


def _is_sign(tokens: Sequence[Token], index: int) -> bool:
    """Return whether `+` or `-` begins a number."""
    before, behind = tokens[:index], tokens[index + 1 :]
    operand = bool(before) and (before[-1].kind in _TERMS or before[-1].text == ")")
    return not operand and bool(behind) and behind[0].kind is Kind.NUMBER


def is_strict(text: str) -> bool:
    """Return whether an expression is in error whenever one of its variables is unbound."""
    return not any(_word(token) in _FORGIVING for token in tokens_of(text))


def can_fail(text: str) -> bool:
    """Return whether an expression may be in error although all of its variables are bound; True when in doubt."""
    tokens = tokens_of(text)
    if len(tokens) == 1:
        return tokens[0].kind is Kind.WORD and _word(tokens[0]) not in {"TRUE", "FALSE"}
    if tokens[0].kind is Kind.STRING:
        return any(token.text != "^^" and token.kind not in {Kind.IRI, Kind.TAG} for token in tokens[1:])
    call = _word(tokens[0]) in _TESTS and tokens[1].text == "(" and tokens[-1].text == ")"
    return not (call and all(token.kind in _TERMS or token.text == "," for token in tokens[2:-1]))


def fails(text: str) -> str:
    """Return the expression that is true where another is in error and false elsewhere; it is never in error."""
    return f"!COALESCE(isBLANK({text}) IN (true, false), false)"


def simplified(text: str, bound: Collection[str]) -> str:
    """Return `true` or `false` for a test that is BOUND of a variable that is bound everywhere, or its negation."""
    words = [_word(token) for token in tokens_of(text)]
    negated = words[:1] == ["!"]
    match words[negated:]:
        case ["BOUND", "(", name, ")"] if name[1:] in bound:
            return "false" if negated else "true"
        case ["FALSE"] if negated:
            return "true"
    return text


def resolved(text: str, visible: Collection[str]) -> str | None:
    """Return an expression without the variables that are not visible and so unbound; None if it is always in error.

    BOUND of such a variable is false; elsewhere it is an error, for which an expression that fails stands.
    """
    missing = set(variables(text)) - set(visible)
    if not missing:
        return text
    if is_strict(text):
        return None
    tokens = tokens_of(text)
    pieces, end = [], 0
    for index, token in enumerate(tokens):
        if token.kind is Kind.VARIABLE and token.text[1:] in missing:
            bound = index > 1 and _word(tokens[index - 2]) == "BOUND"
            first, last = (tokens[index - 2], tokens[index + 1]) if bound else (token, token)
            pieces += [text[end : first.start], "false" if bound else UNBOUND]
            end = last.end
    return "".join(pieces) + text[end:]


def conjuncts(text: str) -> list[str]:
    """Cut an expression at its outermost `&&`: a filter by it is exactly the filters by its parts, one by one.

    The conjunction is true only where both sides are true; false and error alike take the solution away.
    """
    text = bare(text)
    tokens = tokens_of(text)
    depth, start, parts = 0, 0, []
    for token in tokens:
        depth += (token.text in {"(", "[", "{", "<<("}) - (token.text in {")", "]", "}", ")>>"})
        if depth == 0 and token.text == "||":
            return [text]
        if depth == 0 and token.text == "&&":
            parts.append(text[start : token.start].strip())
            start = token.end
    if not parts:
        return [text]
    return [piece for part in (*parts, text[start:].strip()) for piece in conjuncts(part)]


def new_node(text: str) -> str | None:
    """Return the argument of an expression that is BNODE, of nothing or of a string; None for all other expressions."""
    tokens = tokens_of(bare(text))
    words = [_word(token) for token in tokens]
    if words[:2] != ["BNODE", "("] or any(token.kind is not Kind.STRING for token in tokens[2:-1]):
        return None
    return "".join(words[2:-1])


def existence(text: str) -> bool | None:
    """Return whether a test that is only EXISTS or NOT EXISTS is negated by a `!`; None for other tests.

    Raises ValueError where an EXISTS is only a part of the test.
    """
    tokens = tokens_of(text)
    if not any(_word(token) == "EXISTS" for token in tokens):
        return None
    negated = False
    while tokens[0].text in {"!", "("}:
        if tokens[0].text == "!":
            negated = not negated
            tokens = tokens[1:]
        elif partner(tokens) == len(tokens) - 1:
            tokens = tokens[1:-1]
        else:
            break
    if _word(tokens[0]) == "NOT":
        tokens = tokens[1:]
    if _word(tokens[0]) != "EXISTS" or partner(tokens[1:]) != len(tokens) - 2:
        raise ValueError(text)
    return negated
