"""Conformance to a shape (SHACL, section 3.4) as filters on a term: sh:condition and sh:filterShape.

A shape with a path speaks of the values of that path: that all conform is that none has a case in which it does not.

A constraint on single values is a filter on a term (sections 4.1 to 4.4 and 4.8), one on all values of a path together
compares them: pairs of properties, closed shapes (SHACL, sections 4.4, 4.5, 4.8).

A condition over the values of a path is a filter with EXISTS. Its negation needs no more than that: that no value has
one of several cases is one NOT EXISTS for each of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, product
from typing import TYPE_CHECKING, Final, TypeAlias

from pyoxigraph import BlankNode, Literal, NamedNode

from kg.rules.notations.shacl.expressions import Expressions
from kg.rules.notations.shacl.paths import Branch, Names, path_of, steps
from kg.rules.notations.shacl.query import PREBOUND, check_prebound, query_of, rename, spell, variables
from kg.rules.notations.shacl.targets import INSTANCE
from kg.rules.notations.shacl.vocabulary import RDF, SH, XSD, sh
from kg.syntax.functions import AGGREGATES
from kg.syntax.lexer import Kind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from kg.rules.form import Term
    from kg.rules.notations.shacl.functions import Functions
    from kg.rules.notations.shacl.graph import ShapesGraph

Cases: TypeAlias = list[list[str]]
"""Alternatives; each is a list of elements of a SPARQL group, in no order."""

MAX_CASES: Final = 256

TRUE: Final[Cases] = [[]]
FALSE: Final[Cases] = []


def every(parts: Iterable[Cases]) -> Cases:
    """Return that all hold; `OverflowError` when that has more than `MAX_CASES` alternatives."""
    result = TRUE
    for part in parts:
        if len(result) * len(part) > MAX_CASES:
            raise OverflowError
        result = [[*left, *(one for one in right if one not in left)] for left, right in product(result, part)]
    return result


def some(parts: Iterable[Cases]) -> Cases:
    """Return that one holds at least."""
    result: Cases = []
    for part in parts:
        if [] in part:
            return TRUE
        result += [case for case in part if case not in result]
    return result


def exists(pattern: str, cases: Cases) -> Cases:
    """Return that the pattern has a solution in which one of the cases holds."""
    return [[f"FILTER EXISTS {{ {group(pattern, case)} }}"] for case in cases]


def none(pattern: str, cases: Cases) -> Cases:
    """Return that the pattern has no solution in which one of the cases holds."""
    return [[f"FILTER NOT EXISTS {{ {group(pattern, case)} }}" for case in cases]]


def matched(pattern: str, *, wanted: bool) -> Cases:
    """Return that the pattern has a solution, or that it has none."""
    return (exists if wanted else none)(pattern, TRUE)


def for_all(values: Iterable[Branch], each: Callable[[str, bool], Cases], *, wanted: bool) -> Cases:
    """Return that all values pass a test, or that one does not; `each` tells of a term whether it does, or does not."""
    parts = []
    for branch in values:
        if branch.pattern:
            parts.append((none if wanted else exists)(branch.pattern, each(branch.term, False)))
        else:
            parts.append(each(branch.term, wanted))
    return every(parts) if wanted else some(parts)


def group(pattern: str, case: list[str]) -> str:
    """Return what is between the braces of a group with a pattern and filters."""
    return " ".join(part for part in (pattern, *case) if part)


def check(expression: str, *, wanted: bool, safe: bool = False) -> Cases:
    """Return that an expression is true, or that it is not; `safe`: it is never in error."""
    if wanted:
        return [[f"FILTER({expression})"]]
    return [[f"FILTER(!({expression}))" if safe else f"FILTER(!COALESCE({expression}, false))"]]


_FEW: Final = 4
"""Up to here, different values are written out; more are counted by a sub-SELECT."""


def _among(values: list[Branch], term: str, *, wanted: bool) -> Cases:
    """Return that a term is one of the values, or that it is none."""
    parts = []
    for branch in values:
        given = branch.giving(term)
        if given is None:
            parts.append(check(f"sameTerm({branch.term}, {term})", wanted=wanted, safe=True))
        else:
            parts.append(matched(given.pattern, wanted=wanted))
    return some(parts) if wanted else every(parts)


@dataclass(frozen=True, slots=True)
class Comparison:
    """The values of a path of `term` against those of a property, whose name is an IRI in brackets."""

    term: str
    values: list[Branch]
    name: str
    other: str
    """A variable for a value of the property."""

    @property
    def reached(self) -> str:
        """The pattern of the values of the property."""
        return f"{self.term} {self.name} {self.other} ."

    def has(self, one: str, wanted: bool) -> Cases:  # noqa: FBT001 - a fact
        """Return that a value of the path is one of the property, or that it is none."""
        return matched(f"{self.term} {self.name} {one} .", wanted=wanted)


def _equals(pair: Comparison, *, wanted: bool) -> Cases:
    own = for_all(pair.values, pair.has, wanted=wanted)
    theirs = (none if wanted else exists)(pair.reached, _among(pair.values, pair.other, wanted=False))
    return every([own, theirs]) if wanted else some([own, theirs])


def _disjoint(pair: Comparison, *, wanted: bool) -> Cases:
    return for_all(pair.values, lambda one, passes: pair.has(one, not passes), wanted=wanted)


def _less(operator: str) -> Callable[..., Cases]:
    def read(pair: Comparison, *, wanted: bool) -> Cases:
        def each(one: str, passes: bool) -> Cases:  # noqa: FBT001 - a fact
            other = check(f"{one} {operator} {pair.other}", wanted=False)
            return (none if passes else exists)(pair.reached, other)

        return for_all(pair.values, each, wanted=wanted)

    return read


def unique_languages(pair: tuple[list[Branch], list[Branch]], *, wanted: bool) -> Cases:
    """Return that no two values have the same language (sh:uniqueLang)."""
    parts = []
    for one, two in product(*pair):
        if not one.pattern and not two.pattern:
            continue
        same = f'LANG({one.term}) != "" && LCASE(LANG({one.term})) = LCASE(LANG({two.term}))'
        pattern = f"{one.pattern} {two.pattern}".strip()
        parts.append((none if wanted else exists)(pattern, [[f"FILTER(!sameTerm({one.term}, {two.term}) && {same})"]]))
    return every(parts) if wanted else some(parts)


def closed(graph: ShapesGraph, shape: Term, term: str, names: Names, *, wanted: bool) -> Cases:
    """Return that a term has values of no other properties than those of the shape (sh:closed)."""
    if not graph.flag(shape, "closed"):
        return every([]) if wanted else some([])
    ignored = [name for listed in graph.values(shape, sh("ignoredProperties")) for name in graph.members(listed, shape)]
    paths = [path for inner in graph.values(shape, sh("property")) for path in graph.values(inner, sh("path"))]
    allowed = [str(name) for name in dict.fromkeys([*paths, *ignored]) if isinstance(name, NamedNode)]
    predicate = names.fresh()
    others = [[f"FILTER({predicate} NOT IN ({', '.join(allowed)}))"]] if allowed else [[]]
    return (none if wanted else exists)(f"{term} {predicate} {names.fresh()} .", others)


RELATIONS: Final[Mapping[NamedNode, Callable[..., Cases]]] = {
    sh("equals"): _equals,
    sh("disjoint"): _disjoint,
    sh("lessThan"): _less("<"),
    sh("lessThanOrEquals"): _less("<="),
}
"""Constraint to the cases in which a comparison holds, or does not."""


def at_least(
    reach: Callable[[], list[Branch]], term: str, number: int, names: Names, extra: Callable[[str], Cases] | None
) -> Cases:
    """Return that a term reaches `number` different values that have one of the cases of `extra`.

    Each case is one filter with EXISTS (or tests of the term alone), so that its negation is to put NOT before it.
    """
    if number == 0:
        return TRUE
    first = reach()
    if number > _FEW and term.startswith("?") and all(branch.matched for branch in first):
        return [[_counted(first, term, number, names, extra)]]
    cases: Cases = []
    for chosen in product(*(reach() for _ in range(number))):
        pattern = " ".join(branch.pattern for branch in chosen if branch.pattern)
        different = [f"FILTER(!sameTerm({one.term}, {two.term}))" for one, two in combinations(chosen, 2)]
        tests = every(extra(branch.term) for branch in chosen) if extra else TRUE
        if len({branch.term for branch in chosen}) == number:
            cases += [[f"FILTER EXISTS {{ {' '.join([pattern, *different, *test])} }}"] for test in tests]
    return cases or FALSE


def _counted(
    first: Sequence[Branch], term: str, number: int, names: Names, extra: Callable[[str], Cases] | None
) -> str:
    value = names.fresh()
    groups = []
    for branch in first:
        given = branch.giving(value)
        pattern = given.pattern if given else branch.pattern
        groups += [" ".join([pattern, *test]) for test in (extra(value) if extra else TRUE)]
    union = groups[0] if len(groups) == 1 else " UNION ".join(f"{{ {group} }}" for group in groups)
    having = f"HAVING(COUNT(DISTINCT {value}) >= {number})"
    return f"FILTER EXISTS {{ {{ SELECT {term} WHERE {{ {union} }} GROUP BY {term} {having} }} }}"


_TRUE: Final = Literal(True)
"""The one spelling that sh:uniqueLang heeds (SHACL, section 4.4.5)."""


class Conditions:
    """Turns shapes into filters for one rule."""

    def __init__(self, graph: ShapesGraph, functions: Functions, names: Names, binder: str) -> None:
        """Take the state that the rule shares."""
        self._graph = graph
        self._functions = functions
        self._names = names
        self._binder = binder
        self._around: list[Term] = []

    def conforms(self, shape: Term, term: str, *, wanted: bool = True) -> Cases:
        """Return the cases in which a term conforms to a shape, or those in which it does not.

        Raises `RuleError`: KG201 for a shape that is ill-formed, KG230 for one that refers to itself and for
        constraints that are not supported.
        """
        if isinstance(shape, Literal):
            hint = "Point at a shape: an IRI or a blank node."
            raise self._graph.error(f"{shape} is not a shape", self._around[-1] if self._around else shape, hint=hint)
        if shape in self._around:
            hint = "The standard leaves open what recursive shapes mean; break the cycle."
            raise self._graph.unsupported(f"{self._graph.called(shape)}, a shape that refers to itself,", shape, hint)
        if self._graph.flag(shape, "deactivated"):
            return TRUE if wanted else FALSE
        self._around.append(shape)
        try:
            parts = [
                cases
                for predicate in self._graph.predicates(shape)
                for value in self._graph.values(shape, predicate)
                if (cases := self._constraint(shape, predicate, value, term, wanted=wanted)) is not None
            ]
            return every(parts) if wanted else some(parts)
        except OverflowError:
            hint = "Split the rule, or the shape, in several."
            raise self._graph.unsupported(f"a condition of more than {MAX_CASES} cases", shape, hint) from None
        finally:
            self._around.pop()

    def _values(self, shape: Term, term: str) -> list[Branch]:
        """Return how the value nodes of a shape are reached, with new variables at each call."""
        path = self._graph.one(shape, "path")
        if path is None:
            if self._graph.is_instance(shape, sh("PropertyShape")):
                raise self._graph.error(
                    f"{self._graph.called(shape)} is a property shape without sh:path",
                    shape,
                    hint="Give it a path, or the type sh:NodeShape.",
                )
            return [Branch("", term)]
        return [*steps(path_of(self._graph, path, shape), term, self._names)]

    def _constraint(self, shape: Term, predicate: NamedNode, value: Term, term: str, *, wanted: bool) -> Cases | None:
        each = self._each(shape, predicate, value)
        if each is not None:
            return for_all(self._values(shape, term), each, wanted=wanted)
        if predicate in RELATIONS:
            if not isinstance(value, NamedNode):
                message = f"{self._graph.called(shape)} is compared with {value}, but a property is needed"
                raise self._graph.error(message, shape, hint="Give it the IRI of a property.")
            comparison = Comparison(term, self._values(shape, term), str(value), self._names.fresh())
            return RELATIONS[predicate](comparison, wanted=wanted)
        if predicate == sh("sparql"):
            return self._selected(shape, value, term, wanted=wanted)
        name = predicate.value.removeprefix(SH) if predicate.value.startswith(SH) else ""
        if name in {"minCount", "maxCount", "qualifiedMinCount", "qualifiedMaxCount"}:
            return self._counted(shape, name, value, term, wanted=wanted)
        if name == "hasValue":
            return _among(self._values(shape, term), constant(self._graph, value, shape, name), wanted=wanted)
        if name == "uniqueLang":
            pair = (self._values(shape, term), self._values(shape, term))
            return unique_languages(pair, wanted=wanted) if value == _TRUE else None
        self._refuse(shape, predicate, name)
        return None

    def _refuse(self, shape: Term, predicate: NamedNode, name: str) -> None:
        """Raise KG230 for constraints in JavaScript and of components that the file declares."""
        component = [
            owner
            for parameter in self._graph.subjects(sh("path"), predicate)
            for owner in self._graph.subjects(sh("parameter"), parameter)
            if self._graph.is_instance(owner, sh("ConstraintComponent"))
        ]
        if name == "js" or component:
            hint = "Write the constraint with sh:sparql, or out of the constraints of SHACL Core."
            raise self._graph.unsupported(f"{predicate} in a condition", shape, hint)

    def _each(self, shape: Term, predicate: NamedNode, value: Term) -> Callable[[str, bool], Cases] | None:
        """Return the test of one value node that a constraint makes; None for constraints on all of them."""
        if predicate in VALUE_TESTS:
            reader = VALUE_TESTS[predicate]
            return lambda term, wanted: reader(self._graph, shape, value, term, wanted=wanted)
        readers: dict[NamedNode, Callable[[str, bool], Cases]] = {
            sh("node"): lambda term, wanted: self.conforms(value, term, wanted=wanted),
            sh("property"): lambda term, wanted: self.conforms(value, term, wanted=wanted),
            sh("not"): lambda term, wanted: self.conforms(value, term, wanted=not wanted),
            sh("and"): lambda term, wanted: (every if wanted else some)(self._members(shape, value, term, wanted)),
            sh("or"): lambda term, wanted: (some if wanted else every)(self._members(shape, value, term, wanted)),
            sh("xone"): lambda term, wanted: self._one(shape, value, term, wanted=wanted),
            sh("closed"): lambda term, wanted: closed(self._graph, shape, term, self._names, wanted=wanted),
            sh("expression"): lambda term, wanted: Expressions(
                self._graph, self._functions, self._names, self, self._binder
            ).true(value, term, wanted=wanted),
        }
        return readers.get(predicate)

    def _selected(self, shape: Term, node: Term, term: str, *, wanted: bool) -> Cases:
        """Return that the constraint `node` in SPARQL has no solution for a term, or that it has one.

        `?this` is the focus node, other variables are new. Raises `RuleError` KG230 for queries with modifiers,
        aggregates or sub-SELECT.
        """
        graph = self._graph
        if graph.flag(node, "deactivated"):
            return TRUE if wanted else FALSE
        query = query_of(graph, node, "select")
        check_prebound(graph, query, PREBOUND | {"PATH"})
        texts = {word.text.upper() for word in [*query.head, *query.group] if word.kind is Kind.WORD}
        if query.modifiers or texts & {"SELECT", *AGGREGATES}:
            hint = "Write the query without sub-SELECT, aggregates, GROUP BY, ORDER BY and LIMIT."
            raise graph.unsupported("such a query of sh:sparql in a condition", node, hint)
        own = variables(query.group)
        if "shapesGraph" in own:
            raise graph.unsupported("$shapesGraph", node, "Write what the query needs of the shapes into it.")
        given = {name: self._names.fresh() for name in sorted(own - {"this"})} | {"currentShape": str(shape)}
        if "PATH" in given:
            path = path_of(graph, graph.required(shape, "path"), shape)
            if path.text is None or path.empty:
                raise graph.unsupported("$PATH for a path that may be empty", node, "Write the path into the query.")
            given["PATH"] = path.text
        # First the new names: the term that `?this` stands for may have the name of a variable of the query.
        solutions = self._functions.inside(rename(query.group, given), node)
        return matched(spell(rename(solutions, {"this": term})), wanted=not wanted)

    def _members(self, shape: Term, value: Term, term: str, wanted: bool) -> list[Cases]:  # noqa: FBT001 - a fact
        return [self.conforms(one, term, wanted=wanted) for one in self._graph.members(value, shape)]

    def _one(self, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
        shapes = self._graph.members(value, shape)
        if wanted:
            return some(every(self.conforms(other, term, wanted=other is one) for other in shapes) for one in shapes)
        pairs = [every(self.conforms(one, term) for one in pair) for pair in combinations(shapes, 2)]
        return some([every(self.conforms(one, term, wanted=False) for one in shapes), *pairs])

    def _counted(self, shape: Term, name: str, value: Term, term: str, *, wanted: bool) -> Cases:
        """Return that a path has at least or at most a number of values (that conform to a shape)."""
        if name.startswith("qualified") and self._graph.one(shape, "path") is None:
            return TRUE if wanted else FALSE
        limit = whole_number(self._graph, shape, name, value)
        self._graph.required(shape, "path")
        least = name in {"minCount", "qualifiedMinCount"}
        extra = self._qualified(shape) if name.startswith("qualified") else None
        reach = at_least(lambda: self._values(shape, term), term, limit if least else limit + 1, self._names, extra)
        if wanted == least:
            return reach
        if reach == TRUE:
            return FALSE
        return [[filter_.replace("FILTER EXISTS", "FILTER NOT EXISTS", 1) for case in reach for filter_ in case]]

    def _qualified(self, shape: Term) -> Callable[[str], Cases]:
        """Return the test that a value conforms to sh:qualifiedValueShape and to no sibling (SHACL, 4.7.3)."""
        own = self._graph.required(shape, "qualifiedValueShape")
        siblings: list[Term] = []
        if self._graph.flag(shape, "qualifiedValueShapesDisjoint"):
            siblings = [
                qualified
                for parent in self._graph.subjects(sh("property"), shape)
                for sibling in self._graph.values(parent, sh("property"))
                for qualified in self._graph.values(sibling, sh("qualifiedValueShape"))
                if qualified != own
            ]
        return lambda term: every(
            [self.conforms(own, term), *(self.conforms(other, term, wanted=False) for other in siblings)]
        )


_KINDS: Final = {
    "IRI": ("isIRI",),
    "BlankNode": ("isBlank",),
    "Literal": ("isLiteral",),
    "BlankNodeOrIRI": ("isBlank", "isIRI"),
    "BlankNodeOrLiteral": ("isBlank", "isLiteral"),
    "IRIOrLiteral": ("isIRI", "isLiteral"),
}
_NAMES: Final = """
integer decimal float double nonPositiveInteger negativeInteger long int short byte
nonNegativeInteger unsignedLong unsignedInt unsignedShort unsignedByte positiveInteger
"""
_NUMBERS: Final = frozenset(f"{XSD}{name}" for name in _NAMES.split())
_DATES: Final = frozenset(f"{XSD}{name}" for name in ("dateTime", "date"))


def constant(graph: ShapesGraph, node: Term, shape: Term, name: str) -> str:
    """Return a term of the shapes graph as SPARQL; KG230 for a blank node, which is not a node of the data."""
    if isinstance(node, BlankNode):
        raise graph.unsupported(f"a blank node as the value of sh:{name}", shape, "Give it an IRI or a literal.")
    return str(node)


def whole_number(graph: ShapesGraph, shape: Term, name: str, value: Term) -> int:
    """Return the number of a constraint; KG201 if it is none."""
    if not isinstance(value, Literal) or not value.value.isdecimal():
        raise graph.error(f"sh:{name} of {graph.called(shape)} is {value}", shape, hint="It is a whole number.")
    return int(value.value)


def _class(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
    return matched(f"{term} {INSTANCE} {constant(graph, value, shape, 'class')} .", wanted=wanted)


def _datatype(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
    """Test the datatype and, where SPARQL can tell, that the value is well-formed."""
    name = constant(graph, value, shape, "datatype")
    if name == f"<{RDF}langString>":
        return check(f'isLiteral({term}) && LANG({term}) != ""', wanted=wanted)
    formed = ""
    if name[1:-1] in _NUMBERS:
        formed = f" && isNumeric({term})"
    elif name == f"<{XSD}boolean>":
        formed = f" && ({term} = true || {term} = false)"
    elif name[1:-1] in _DATES:
        formed = f" && YEAR({term}) = YEAR({term})"
    return check(f"isLiteral({term}) && DATATYPE({term}) = {name}{formed}", wanted=wanted)


def _node_kind(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
    name = value.value.removeprefix(SH) if isinstance(value, NamedNode) else str(value)
    if name not in _KINDS:
        hint = f"It is one of {', '.join(f'sh:{kind}' for kind in _KINDS)}."
        raise graph.error(f"sh:nodeKind of {graph.called(shape)} is {name}", shape, hint=hint)
    return check(" || ".join(f"{function}({term})" for function in _KINDS[name]), wanted=wanted, safe=True)


def _compared(operator: str, name: str) -> Callable[..., Cases]:
    def read(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
        return check(f"{term} {operator} {constant(graph, value, shape, name)}", wanted=wanted)

    return read


def _length(operator: str, name: str) -> Callable[..., Cases]:
    def read(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
        length = whole_number(graph, shape, name, value)
        return check(f"!isBlank({term}) && STRLEN(STR({term})) {operator} {length}", wanted=wanted)

    return read


def _pattern(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
    flags = graph.one(shape, "flags")
    if not isinstance(value, Literal) or not isinstance(flags, Literal | None):
        raise graph.error(
            f"sh:pattern and sh:flags of {graph.called(shape)} are strings", shape, hint="Put them in quotes."
        )
    arguments = ", ".join(str(Literal(one.value)) for one in (value, flags) if one is not None)
    return check(f"!isBlank({term}) && REGEX(STR({term}), {arguments})", wanted=wanted)


def _languages(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
    tags = [tag.value for tag in graph.members(value, shape) if isinstance(tag, Literal)]
    matches = " || ".join(f"LANGMATCHES(LANG({term}), {Literal(tag)})" for tag in tags) or "false"
    return check(f"isLiteral({term}) && ({matches})", wanted=wanted)


def _in(graph: ShapesGraph, shape: Term, value: Term, term: str, *, wanted: bool) -> Cases:
    """Test that a term is one of some constants: the term itself, and not its value."""
    members = [constant(graph, member, shape, "in") for member in graph.members(value, shape)]
    names = [member for member in members if member.startswith("<")]
    others = [f"sameTerm({term}, {member})" for member in members if not member.startswith("<")]
    listed = [f"{term} IN ({', '.join(names)})"] if names else []
    return check(" || ".join([*listed, *others]) or "false", wanted=wanted, safe=True)


VALUE_TESTS: Final[Mapping[NamedNode, Callable[..., Cases]]] = {
    sh("class"): _class,
    sh("datatype"): _datatype,
    sh("nodeKind"): _node_kind,
    sh("minExclusive"): _compared(">", "minExclusive"),
    sh("minInclusive"): _compared(">=", "minInclusive"),
    sh("maxExclusive"): _compared("<", "maxExclusive"),
    sh("maxInclusive"): _compared("<=", "maxInclusive"),
    sh("minLength"): _length(">=", "minLength"),
    sh("maxLength"): _length("<=", "maxLength"),
    sh("pattern"): _pattern,
    sh("languageIn"): _languages,
    sh("in"): _in,
}
"""Constraint to its test: graph, shape, value of the constraint and term to cases."""
