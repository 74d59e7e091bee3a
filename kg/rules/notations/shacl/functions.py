"""Functions of SHACL (SHACL-AF, section 5): SPARQL-based ones are put in the place of their calls.

A function is an expression when its query only computes (`SELECT ($a + $b AS ?r) WHERE {}`, `SELECT ?r WHERE { BIND(...
AS ?r) }`, `ASK { FILTER(...) }`); then any SPARQL may call it. Otherwise it is a pattern, which node expressions may
call. A pattern that has several solutions for the same arguments gives all of them; the standard tells authors to
write functions that have one at most.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.rules.notations.shacl.query import (
    Query,
    Word,
    Words,
    check_prebound,
    closing,
    query_of,
    rename,
    spell,
    top_level,
    variables,
)
from kg.rules.notations.shacl.vocabulary import local_name, sh
from kg.syntax.functions import AGGREGATES
from kg.syntax.lexer import Kind

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from kg.rules.form import Term
    from kg.rules.notations.shacl.graph import ShapesGraph

_ERROR: Final = "(1/0)"
"""An expression that is always in error: what an optional parameter without an argument is."""

_MAX_CALLS: Final = 20
"""How deep functions may call functions; a function that calls itself has no end."""


@dataclass(frozen=True, slots=True)
class Function:
    """A function; `parameters` are the names of its variables in order, and whether they are optional."""

    node: NamedNode
    parameters: tuple[tuple[str, bool], ...]
    query: Query

    @property
    def result(self) -> str | None:
        """The name of the variable that a SELECT gives; None for ASK and for `SELECT (expression AS ?name)`."""
        names = {name for name, _ in self.parameters}
        projected = [word.text[1:] for word in self.query.head if word.kind is Kind.VARIABLE]
        return next((name for name in projected if name not in names), None)


class Functions:
    """The functions that a shapes graph declares."""

    def __init__(self, graph: ShapesGraph) -> None:
        """Nothing is read before it is called."""
        self._graph = graph
        self._cache: dict[NamedNode, Function] = {}

    def find(self, node: NamedNode, owner: Term) -> Function:
        """Return a declared function; KG201 for an unknown name."""
        if node not in self._cache:
            if not self._graph.is_instance(node, sh("SPARQLFunction")):
                hint = "Declare it as a sh:SPARQLFunction in this file; functions in JavaScript are not supported."
                raise self._graph.error(f"this file does not declare the function {node}", owner, hint=hint)
            parameters = self._parameters(node)
            self._cache[node] = Function(node, parameters, self._query(node, [name for name, _ in parameters]))
        return self._cache[node]

    def _query(self, node: NamedNode, parameters: Collection[str]) -> Query:
        forms = [name for name in ("select", "ask") if self._graph.values(node, sh(name))]
        if len(forms) != 1:
            hint = "Give it exactly one of the two."
            raise self._graph.error(f"the function {node} must have either sh:select or sh:ask", node, hint=hint)
        query = query_of(self._graph, node, forms[0])
        if parameters:
            check_prebound(self._graph, query, parameters)
        if any(word.text.upper() in {"LIMIT", "OFFSET", "ORDER", "GROUP", "HAVING"} for word in query.modifiers):
            hint = "Write it without ORDER BY, LIMIT and GROUP BY; to count, use sh:count where it is called."
            raise self._graph.unsupported(f"a solution modifier in the function {node}", node, hint)
        return query

    def _parameters(self, node: NamedNode) -> tuple[tuple[str, bool], ...]:
        """Return the parameters by sh:order, or where none has one by the local names of their paths."""
        parameters = self._graph.values(node, sh("parameter"))
        names = {parameter: local_name(self._graph.required(parameter, "path")) for parameter in parameters}
        ordered = any(self._graph.values(parameter, sh("order")) for parameter in parameters)
        parameters.sort(key=self._graph.order if ordered else lambda parameter: names[parameter])
        return tuple((names[parameter], self._graph.flag(parameter, "optional")) for parameter in parameters)

    def arguments(
        self, function: Function, given: Sequence[str | None], owner: Term, offset: int | None = None
    ) -> dict[str, str]:
        """Return the texts of arguments by the names of parameters; KG201 for too many, or without a mandatory one."""
        called = f"the function {function.node} is called with {len(given)} argument{'' if len(given) == 1 else 's'}"
        if len(given) > len(function.parameters):
            hint = "Leave arguments out, or declare a sh:parameter for each."
            message = f"{called}; it has {len(function.parameters)} parameters"
            raise self._graph.error(message, owner, hint=hint, offset=offset)
        padded = [*given, *[None] * (len(function.parameters) - len(given))]
        for text, (name, optional) in zip(padded, function.parameters, strict=True):
            if text is None and not optional:
                hint = "Add the argument, or declare the parameter with sh:optional true."
                raise self._graph.error(f"{called}; it requires ${name}", owner, hint=hint, offset=offset)
        pairs = zip(function.parameters, padded, strict=True)
        return {name: _ERROR if text is None else text for (name, _), text in pairs}

    def expression(self, function: Function, arguments: dict[str, str], depth: int = 0) -> str | None:
        """Return a call as an expression; None when the function is a pattern. `depth` counts the calls around it."""
        computed = _computation(function)
        if computed is None:
            return None
        given = {name: f"({text})" for name, text in arguments.items()}
        for name, words in computed:
            given[name] = f"({spell(self._body(function, words, given, depth))})"
        return given[computed[-1][0]]

    def pattern(self, function: Function, arguments: dict[str, str], locals_: dict[str, str]) -> str:
        """Return the group of a function that is a pattern; `locals_` are the names that its own variables get."""
        return spell(self._body(function, function.query.group, {**locals_, **arguments}, 0))

    def inside(self, words: Words, owner: Term, depth: int = 0) -> Words:
        """Return SPARQL with the calls of declared functions replaced; KG230 for one that is a pattern."""
        result: list[Word] = []
        index = 0
        while index < len(words):
            word = words[index]
            call = word.kind is Kind.IRI and index + 1 < len(words) and words[index + 1].text == "("
            node = NamedNode(word.text[1:-1]) if call else None
            if node is None or not self._graph.is_instance(node, sh("SPARQLFunction")):
                result.append(word)
                index += 1
                continue
            end = closing(words, index + 1)
            given = [self.inside(part, owner, depth) for part in top_level(words[index + 2 : end], ",")]
            result.append(self._call(word, node, given, owner, depth))
            index = end + 1
        return result

    def _call(self, word: Word, node: NamedNode, given: list[Words], owner: Term, depth: int) -> Word:
        function = self.find(node, owner)
        if depth > _MAX_CALLS:
            hint = "Functions are put in the place of their calls; write a recursion as a rule."
            raise self._graph.error(f"the function {node} calls itself", node, hint=hint)
        arguments = self.arguments(function, [spell(part) for part in given], owner, word.offset)
        text = self.expression(function, arguments, depth)
        if text is None:
            hint = "Write its pattern into the query, or call it in a node expression."
            what = f"calling {node}, whose query reads the data, in SPARQL"
            raise self._graph.error(f"{what} is not supported", owner, code="KG230", hint=hint, offset=word.offset)
        return Word(Kind.SIGN, text, word.offset)

    def _body(self, function: Function, words: Words, given: dict[str, str], depth: int) -> Words:
        """Return words of a function with its arguments put in, and what it calls replaced."""
        bound: list[Word] = []
        index = 0
        while index < len(words):
            tests_bound = words[index].text.upper() == "BOUND" and index + 3 < len(words)
            name = words[index + 2].text[1:] if tests_bound else ""
            if tests_bound and name in dict(function.parameters):
                has_value = given.get(name) not in {_ERROR, f"({_ERROR})"}
                bound.append(Word(Kind.WORD, "true" if has_value else "false"))
                index += 4
            else:
                bound.append(words[index])
                index += 1
        return self.inside(rename(bound, given), function.node, depth + 1)


def _computation(function: Function) -> list[tuple[str, Words]] | None:
    """Return the expressions that a function computes one after the other; None when it reads the data."""
    binds = _assignments(function.query.group, "FILTER" if function.query.form == "ASK" else "BIND")
    if binds is None:
        return None
    if function.query.form == "ASK":
        joined = [word for words in binds for word in words]
        return [(".ask", joined)] if len(binds) == 1 else None
    head = function.query.head
    opening = next((index for index, word in enumerate(head) if word.text == "("), None)
    if opening is not None:
        projected = head[opening + 1 : closing(head, opening)]
        if any(word.text.upper() in AGGREGATES for word in projected):
            return None
        binds = [*binds, projected]
    named = [(words[-1].text[1:], words[:-2]) for words in binds if len(words) > 2]  # noqa: PLR2004 - expression AS ?v
    last = named[-1][0] if named else None
    return named if last is not None and (opening is not None or last == function.result) else None


def _assignments(group: Words, keyword: str) -> list[Words] | None:
    """Return what is in brackets behind each keyword; None when the group has anything else."""
    result: list[Words] = []
    index = 0
    while index < len(group):
        if group[index].text == ".":
            index += 1
            continue
        if group[index].text.upper() != keyword or index + 1 >= len(group) or group[index + 1].text != "(":
            return None
        end = closing(group, index + 1)
        inside = group[index + 2 : end]
        if any(word.text == "{" for word in inside) or not (keyword == "FILTER" or variables(inside[-1:])):
            return None
        result.append(inside)
        index = end + 1
    return result
