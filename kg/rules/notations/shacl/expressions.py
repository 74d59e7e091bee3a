"""Node expressions (SHACL-AF, section 6): how their nodes are reached from the focus node, as patterns.

An expression gives a set of nodes; it becomes branches, each of which gives some of them. Of the drafts that followed
the standard those expressions are there whose result does not depend on an order of nodes.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Final

from pyoxigraph import BlankNode

from kg.rules.notations.shacl.paths import Branch, Names, path_of, steps
from kg.rules.notations.shacl.query import variables
from kg.rules.notations.shacl.vocabulary import SH, XSD, sh

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.rules.form import Term
    from kg.rules.notations.shacl.conditions import Conditions
    from kg.rules.notations.shacl.functions import Function, Functions
    from kg.rules.notations.shacl.graph import ShapesGraph

_BOOLEAN: Final = {
    True: '"true"^^<http://www.w3.org/2001/XMLSchema#boolean>',
    False: '"false"^^<http://www.w3.org/2001/XMLSchema#boolean>',
}
_ZERO: Final = '"0"^^<http://www.w3.org/2001/XMLSchema#integer>'
_MAX_DEPTH: Final = 40


class Expressions:
    """Turns the expressions of one rule into patterns; `binder` is the pattern that binds the focus node."""

    def __init__(
        self, graph: ShapesGraph, functions: Functions, names: Names, conditions: Conditions, binder: str
    ) -> None:
        """Take the state that the rule shares."""
        self._graph = graph
        self._functions = functions
        self._names = names
        self._conditions = conditions
        self._binder = binder
        self._depth = 0

    def branches(self, node: Term, this: str) -> list[Branch]:
        """Return the branches of an expression at a focus node; KG201 when it is none, KG230 for unknown ones."""
        if node == sh("this"):
            return [Branch("", this)]
        if not isinstance(node, BlankNode):
            return [Branch("", str(node))]
        if self._depth > _MAX_DEPTH:
            raise self._graph.error("a node expression contains itself", node, hint="Break the cycle.")
        self._depth += 1
        try:
            return self._reader(node)(node, this)
        finally:
            self._depth -= 1

    def _reader(self, node: Term) -> Callable[[Term, str], list[Branch]]:
        has = {predicate.value.removeprefix(SH) for predicate in self._graph.predicates(node)}
        kinds: dict[str, Callable[[Term, str], list[Branch]]] = {
            "path": self._path,
            "filterShape": self._filtered,
            "intersection": self._intersection,
            "union": self._union,
            "minus": self._minus,
            "distinct": lambda node, this: self.branches(self._graph.required(node, "distinct"), this),
            "count": self._aggregated("count", zero=True),
            "min": self._aggregated("min"),
            "max": self._aggregated("max"),
            "sum": self._aggregated("sum", zero=True),
            "exists": self._exists,
            "if": self._if,
            "limit": self._cut,
            "offset": self._cut,
            "orderBy": self._nodes,
        }
        present = [name for name in kinds if name in has]
        if len(present) > 1 and not set(present) <= {"limit", "offset", "orderBy"}:
            raise self._graph.error(
                f"a node expression has both sh:{present[0]} and sh:{present[1]}", node, hint="Nest them with sh:nodes."
            )
        return kinds[present[0]] if present else self._function

    def _nodes(self, node: Term, this: str) -> list[Branch]:
        return self.branches(self._graph.required(node, "nodes"), this)

    def _path(self, node: Term, this: str) -> list[Branch]:
        nodes = self._graph.one(node, "nodes")
        path = path_of(self._graph, self._graph.required(node, "path"), node)
        starts = [Branch("", this)] if nodes is None else self.branches(nodes, this)
        return [
            Branch(f"{start.pattern} {step.pattern}".strip(), step.term, step.matched or start.matched)
            for start in starts
            for step in steps(path, start.term, self._names)
        ]

    def _filtered(self, node: Term, this: str) -> list[Branch]:
        shape = self._graph.required(node, "filterShape")
        return [
            branch.filtered(*case)
            for branch in self._nodes(node, this)
            for case in self._conditions.conforms(shape, branch.term)
        ]

    def _list(self, node: Term, name: str, this: str) -> list[list[Branch]]:
        members = self._graph.members(self._graph.required(node, name), node)
        if len(members) < 2:  # noqa: PLR2004 - the standard asks for two
            raise self._graph.error(
                f"sh:{name} has fewer than two members", node, hint="Name the one expression alone."
            )
        return [self.branches(member, this) for member in members]

    def _union(self, node: Term, this: str) -> list[Branch]:
        return [branch for branches in self._list(node, "union", this) for branch in branches]

    def _intersection(self, node: Term, this: str) -> list[Branch]:
        result, *others = self._list(node, "intersection", this)
        for other in others:
            result = [_both(left, right) for left, right in product(result, other)]
        return result

    def _minus(self, node: Term, this: str) -> list[Branch]:
        taken = self.branches(self._graph.required(node, "minus"), this)
        left = self._nodes(node, this)
        return [branch.filtered(*(_absent(branch.term, other) for other in taken)) for branch in left]

    def _cut(self, node: Term, this: str) -> list[Branch]:
        del this
        hint = "Which nodes are left depends on an order of nodes; use sh:min or sh:max where one is meant."
        raise self._graph.unsupported("sh:limit and sh:offset in a node expression", node, hint)

    def _all(self, branches: Sequence[Branch], this: str) -> tuple[str, str]:
        """Return one group that has the nodes of all branches as the values of one variable."""
        value = self._names.fresh()
        groups = []
        for branch in branches:
            given = branch.giving(value)
            pattern = given.pattern if given else f"{branch.pattern} BIND({branch.term} AS {value})"
            binds_this = branch.matched and branch.pattern.startswith(f"{this} ")
            groups.append(pattern if binds_this else f"{self._binder} {pattern}".strip())
        return value, groups[0] if len(groups) == 1 else " UNION ".join(f"{{ {group} }}" for group in groups)

    def _grouped(self, function: str, branches: Sequence[Branch], this: str) -> Branch:
        value, group = self._all(branches, this)
        result = self._names.fresh()
        call = f"({function}(DISTINCT {value}) AS {result})"
        return Branch(f"{{ SELECT {this} {call} WHERE {{ {group} }} GROUP BY {this} }}", result)

    def _aggregated(self, name: str, *, zero: bool = False) -> Callable[[Term, str], list[Branch]]:
        """Return the reader of an aggregate; with `zero` it is 0 where there are no nodes."""

        def read(node: Term, this: str) -> list[Branch]:
            branches = self.branches(self._graph.required(node, name), this)
            result = [self._grouped(name.upper(), branches, this)]
            if zero and all(branch.pattern for branch in branches):
                result.append(Branch(_all_none(branches), _ZERO))
            return result

        return read

    def _exists(self, node: Term, this: str) -> list[Branch]:
        branches = self.branches(self._graph.required(node, "exists"), this)
        if any(not branch.pattern for branch in branches):
            return [Branch("", _BOOLEAN[True])]
        none = _all_none(branches)
        return [*(Branch(_some(branch), _BOOLEAN[True]) for branch in branches), Branch(none, _BOOLEAN[False])]

    def _if(self, node: Term, this: str) -> list[Branch]:
        true = [_tested(branch) for branch in self.branches(self._graph.required(node, "if"), this)]
        result = []
        for name, tests in (("then", [_some(branch) for branch in true]), ("else", [_all_none(true)])):
            chosen = self._graph.one(node, name)
            for branch, tested in product(self.branches(chosen, this) if chosen is not None else [], tests):
                result.append(Branch(f"{tested} {branch.pattern}".strip(), branch.term))
        return result

    def _function(self, node: Term, this: str) -> list[Branch]:
        """Return a call: the one triple of the node whose object is a list (SHACL-AF, section 6.4)."""
        calls = [
            (predicate, value)
            for predicate in self._graph.predicates(node)
            for value in self._graph.values(node, predicate)
            if self._graph.is_list(value)
        ]
        if len(calls) != 1:
            hint = "A node expression is sh:this, a constant, or a blank node with sh:path, sh:union, sh:intersection, "
            hint += "sh:filterShape, or one function with the list of its arguments."
            raise self._graph.error("a blank node is not a node expression", node, hint=hint)
        predicate, arguments = calls[0]
        given = [self.branches(member, this) for member in self._graph.members(arguments, node)]
        if predicate.value.startswith(XSD) and len(given) == 1:  # a cast of SPARQL
            return [self._bound(branch.pattern, f"{predicate}({branch.term})") for branch in given[0]]
        function = self._functions.find(predicate, node)
        optional = [flag for _, flag in function.parameters]
        # Without a term: an argument has no nodes.
        choices = [
            [*branches, Branch(_all_none(branches), "")] if number < len(optional) and optional[number] else branches
            for number, branches in enumerate(given)
        ]
        return [result for chosen in product(*choices) for result in self._call(function, chosen, node)]

    def _bound(self, pattern: str, expression: str) -> Branch:
        value = self._names.fresh()
        return Branch(f"{pattern} BIND({expression} AS {value})".strip(), value)

    def _call(self, function: Function, chosen: Sequence[Branch], node: Term) -> list[Branch]:
        before = " ".join(branch.pattern for branch in chosen if branch.pattern)
        arguments = self._functions.arguments(function, [branch.term or None for branch in chosen], node)
        if (expression := self._functions.expression(function, arguments)) is not None:
            return [self._bound(before, expression)]
        own = variables(function.query.group) | variables(function.query.head)
        renamed = {name: self._names.fresh() for name in sorted(own - set(arguments))}
        pattern = self._functions.pattern(function, arguments, renamed)
        if function.query.form == "ASK":
            return [
                Branch(f"{before} FILTER EXISTS {{ {pattern} }}".strip(), _BOOLEAN[True]),
                Branch(f"{before} FILTER NOT EXISTS {{ {pattern} }}".strip(), _BOOLEAN[False]),
            ]
        if function.result is None or any(word.text == "(" for word in function.query.head):
            hint = "Let its query be SELECT ?result WHERE { ... BIND(... AS ?result) }."
            raise self._graph.unsupported(f"the query of the function {function.node}", function.node, hint)
        return [Branch(f"{before} {pattern}".strip(), renamed[function.result])]

    def true(self, node: Term, this: str, *, wanted: bool) -> list[list[str]]:
        """Return the cases in which an expression gives `true` and nothing else (SHACL-AF, section 7), or not."""
        branches = self.branches(node, this)
        value = _BOOLEAN[True]
        is_true = [_tested(branch) for branch in branches]
        other = [branch.filtered(f"FILTER(!sameTerm({branch.term}, {value}))") for branch in branches]
        if wanted:
            return [[_some(branch), *(_none(one) for one in other)] for branch in is_true]
        return [[_some(one)] for one in other] + [[_none(branch) for branch in is_true]]


def _some(branch: Branch) -> str:
    return f"FILTER EXISTS {{ {branch.pattern} }}"


def _none(branch: Branch) -> str:
    # An expression in error gives no node, but a solution in which its variable is unbound.
    computed = branch.pattern.endswith(f"AS {branch.term})")
    return f"FILTER NOT EXISTS {{ {branch.pattern} {f'FILTER(BOUND({branch.term})) ' if computed else ''}}}"


def _all_none(branches: Sequence[Branch]) -> str:
    return " ".join(_none(branch) for branch in branches)


def _tested(branch: Branch) -> Branch:
    return branch.filtered(f"FILTER(sameTerm({branch.term}, {_BOOLEAN[True]}))")


def _both(left: Branch, right: Branch) -> Branch:
    """Return the branch of the nodes that two branches give."""
    for one, other in ((left, right), (right, left)):
        if (joined := other.giving(one.term)) is not None:
            return one.filtered(joined.pattern)
    same = f"FILTER(sameTerm({left.term}, {right.term}))"
    return Branch(" ".join(part for part in (left.pattern, right.pattern, same) if part), left.term)


def _absent(term: str, branch: Branch) -> str:
    """Return the filter that a branch does not give a term."""
    if not branch.pattern:
        return f"FILTER(!sameTerm({term}, {branch.term}))"
    joined = branch.giving(term)
    if joined is not None:
        return f"FILTER NOT EXISTS {{ {joined.pattern} }}"
    return f"FILTER NOT EXISTS {{ {branch.pattern} FILTER(sameTerm({term}, {branch.term})) }}"
