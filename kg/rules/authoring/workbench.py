"""A store on which rules are tried: its triples as columns, cached between tries; nothing is written."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode, RdfFormat, Triple, parse

from kg.rules.columns import EVERYTHING, Wanted, read_columns, stated, union_of, wanted
from kg.rules.engine.evaluate import Outcome, Program, evaluate
from kg.rules.engine.facts import Facts, lacking
from kg.rules.engine.terms import Dictionary
from kg.rules.specialise import schema_pattern, specialise

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.rules.engine.limits import Limits
    from kg.rules.files import RuleFile
    from kg.rules.form import Rule
    from kg.rules.recording import Names
    from kg.store.snapshot import EmbeddedSnapshot

_NOTHING: Final = Wanted(frozenset())
_CACHED: Final = 3  # how many answers are kept: all rules, all but those that are being written, and one more


@dataclass(frozen=True, slots=True)
class Try:
    """Inferences of rules.

    `read` are the triples they were given, `stated` those of them that files state and the store does not have,
    `asserted` adds the axioms, and `facts` adds the inferred triples.
    """

    rules: tuple[Rule, ...]
    read: Facts
    stated: Facts
    asserted: Facts
    outcome: Outcome
    facts: Facts


@dataclass(slots=True)
class Workbench:
    """One snapshot of a store; columns read from it are cached."""

    snapshot: EmbeddedSnapshot
    names: Names
    dictionary: Dictionary = field(default_factory=Dictionary)
    _asserted: Facts = field(default_factory=Facts)
    _wanted: Wanted = _NOTHING
    _schema: tuple[Triple, ...] | None = None
    _inferred: Facts | None = None
    _tries: dict[tuple[tuple[str, str], ...], Try] = field(default_factory=dict)

    @property
    def schema(self) -> tuple[Triple, ...]:
        """The axioms of the store, which rules about any schema are cut to."""
        if self._schema is None:
            query = f"SELECT ?s ?p ?o WHERE {schema_pattern()}"
            rows = b"".join(self.snapshot.table(query, graph) for graph in self._graphs)
            text = b"".join(row.replace(b"\t", b" ") + b" .\n" for row in rows.splitlines())
            self._schema = tuple(quad.triple for quad in parse(text, RdfFormat.TURTLE))
        return self._schema

    @property
    def _graphs(self) -> list[NamedNode | None]:
        """The graphs of asserted triples."""
        return self.names.read_by_rules(self.snapshot.graphs())

    def infer(self, files: Sequence[RuleFile], limits: Limits | None = None) -> Try:
        """Return the inferences of the rules of some files; the last are cached. Raises what `evaluate` raises."""
        key = tuple((file.name, file.text) for file in files)
        result = self._tries.pop(key, None) or self._try(files, limits)
        self._tries[key] = result
        while len(self._tries) > _CACHED:
            del self._tries[next(iter(self._tries))]
        return result

    def _try(self, files: Sequence[RuleFile], limits: Limits | None) -> Try:
        rules = specialise((rule for file in files for rule in file.rules), self.schema)
        given = self._reading(rules)
        extra = lacking(stated((triple for file in files for triple in file.data), self.dictionary), given)
        read = union_of([given, extra])
        outcome = evaluate(Program(rules), self.dictionary, read, limits=limits)
        asserted = union_of([read, stated(self.schema, self.dictionary)])
        return Try(rules, read, extra, asserted, outcome, union_of([asserted, outcome.inferred]))

    def read(self, files: Sequence[RuleFile]) -> None:
        """Read the columns that the rules of some files need."""
        self._reading(specialise((rule for file in files for rule in file.rules), self.schema))

    def _reading(self, rules: Sequence[Rule]) -> Facts:
        """Return the asserted triples that rules read or might infer, reading more of the store where needed."""
        needed = self._wanted | wanted(rules)
        if needed != self._wanted:
            self._asserted = read_columns(self.snapshot, needed, self._graphs, self.dictionary)
            self._wanted = needed
        return self._asserted

    @property
    def inferred(self) -> Facts:
        """The inferred triples of the store."""
        if self._inferred is None:
            self._inferred = read_columns(self.snapshot, EVERYTHING, [self.names.inferred], self.dictionary)
        return self._inferred
