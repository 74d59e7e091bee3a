"""Random programs in SPARQL: rules in layers, whose bodies have all constructs of rules, and graphs for them.

Rule `n` derives `<urn:dN>` and reads what the rules before it derive; one more may close the first over `<urn:p>`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from pyoxigraph import BlankNode, Literal, NamedNode, Triple
from rules.decompose.texts import NODES, OBJECTS, PREDICATES, VARIABLES, Texts

from kg.errors import RuleError
from kg.rules.decompose import decompose
from kg.rules.decompose.renaming import possible
from kg.rules.stratify import stratify
from kg.syntax.parser import parse_rq

if TYPE_CHECKING:
    from random import Random

    from rules.engine.oracle import Fact

    from kg.rules.form import Rule, Term

__all__ = ["Programs", "facts"]

BLANK: Final = BlankNode("b1")
SUBJECTS: Final[list[NamedNode | BlankNode]] = [*NODES, BLANK]
VALUES: Final[list[Term]] = [
    *OBJECTS,
    Literal("ab"),
    Literal("a", language="en"),
    BLANK,
    Triple(NODES[0], PREDICATES[0], NODES[1]),
    Triple(BLANK, PREDICATES[1], NODES[2]),
]
FUNCTIONS: Final = (
    """
CONCAT(STR({0}), STR({1}))|STRLEN(STR({0}))|UCASE({0})|SUBSTR(STR({0}), 1, 5)|REPLACE(STR({0}), "urn", "x")
STRAFTER(STR({0}), ":")|IRI(CONCAT("urn:n", STR({0})))|xsd:string({0})|xsd:integer({0})|LANG({0})|DATATYPE({0})
<<( {0} <urn:p> {1} )>>|SUBJECT({0})|OBJECT({0})|TRIPLE({0}, <urn:q>, {1})|isTRIPLE({0})|SHA1(STR({0}))|{0} * 2
""".strip()
    .replace("\n", "|")
    .split("|")
)
TESTS: Final = (
    """
CONTAINS(STR({0}), "a")|STRSTARTS(STR({0}), STR({1}))|REGEX(STR({0}), "b$")|isBlank({0})|isTRIPLE({0})
STRLEN(STR({0})) > 5|sameTerm({0}, {1})|LANGMATCHES(LANG({0}), "*")
""".strip()
    .replace("\n", "|")
    .split("|")
)
TERMS: Final = ["<<( ?x <urn:p> ?y )>>", "<<( ?x ?w ?z )>>", "<<( <urn:a> <urn:p> ?v )>>", "<<( ?z <urn:q> ?y )>>"]
COLUMNS: Final = [
    "?x (SAMPLE(?z) AS ?n)",
    "?y (GROUP_CONCAT(?z) AS ?n)",
    '?x (GROUP_CONCAT(DISTINCT STR(?y); SEPARATOR = "|") AS ?n)',
    "?x (AVG(?z) AS ?n)",
    "?x (MAX(STRLEN(STR(?z))) AS ?n)",
    '?x (CONCAT(STR(MIN(?y)), "-") AS ?n)',
]


def facts(random: Random, least: int, most: int) -> set[Fact]:
    """Return triples, some of them of derived predicates."""
    predicates = [*PREDICATES, *PREDICATES, NamedNode("urn:d0"), NamedNode("urn:d1")]
    count = random.randint(least, most)
    return {(random.choice(SUBJECTS), random.choice(predicates), random.choice(VALUES)) for _ in range(count)}


@dataclass(slots=True)
class Programs(Texts):
    """Generator of programs."""

    predicates: list[NamedNode] = field(default_factory=lambda: list(PREDICATES))

    def rules(self) -> list[Rule] | None:
        """Return the rules of a program; None for one that rules cannot express."""
        found: list[Rule] = []
        try:
            for number, text in enumerate(self.texts()):
                found += decompose(parse_rq(text, "x.rq").rules[0], f"test/r{number}", "x.rq", text)
            stratify(found)
        except RuleError:
            return None
        return found

    def texts(self) -> list[str]:
        """Return the rules as texts."""
        found = []
        for layer in range(self.random.randint(2, 4)):
            derived = [NamedNode(f"urn:d{lower}") for lower in range(layer)]
            self.predicates = [*PREDICATES, *derived, *derived]
            body = self.group(self._of([1, 2, 2, 3]))
            bound = possible(parse_rq(f"CONSTRUCT {{ }} WHERE {body}", "x.rq").rules[0].group.nodes)
            ends = [name for name in (*VARIABLES, "?t", "?n") if name[1:] in bound] or ["<urn:a>"]
            head = f"{self._of(ends)} <urn:d{layer}> {self._of([*ends, *ends, *ends, '_:b', '?new'])} ."
            if self._maybe(0.2):
                head += f" {self._of(ends)} <urn:d{layer}> <<( {self._of(ends)} <urn:p> {self._of(ends)} )>> ."
            tail = "BIND(BNODE() AS ?new)" if "?new" in head else ""
            found.append(f"CONSTRUCT {{ {head} }} WHERE {body[:-1]} {tail} }}")
        if self._maybe(0.3):
            found.append("CONSTRUCT { ?x <urn:d0> ?z } WHERE { ?x <urn:d0> ?y . ?y <urn:p> ?z }")
        return found

    def triple(self) -> str:
        """Return a triple pattern, some with a triple term."""
        if self._maybe(0.12):
            return f"{self._of(VARIABLES)} {self._iri()} {self._of(TERMS)} ."
        return Texts.triple(self)

    def test(self, depth: int) -> str:
        """Return an expression that is true, false or an error."""
        if self._maybe(0.25):
            return self._of(TESTS).format(self._of(VARIABLES), self._of(VARIABLES))
        return Texts.test(self, depth)

    def _bind(self) -> str:
        if self._maybe(0.5):
            value = self._of(FUNCTIONS).format(self._of(VARIABLES), self._of(VARIABLES))
            return f"BIND({value} AS {self._of(['?v', '?v', '?z', '?t'])})"
        return Texts._bind(self)

    def _select(self, depth: int) -> str:
        if self._maybe(0.4):
            columns = self._of(COLUMNS)
            return f"{{ SELECT {columns} WHERE {self.group(depth)} GROUP BY {columns[:2]} }}"
        return Texts._select(self, depth)

    def _iri(self) -> str:
        return str(self._of(self.predicates))
