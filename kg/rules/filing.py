"""Runs rules from files of RDF to a file of N-Triples, without a store."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np
from pyoxigraph import RdfFormat, parse

from kg.errors import GraphError, Place, SourceError, UsageError
from kg.rules.columns import by_predicate
from kg.rules.engine.evaluate import Limits, Program, evaluate
from kg.rules.engine.facts import Facts, distinct
from kg.rules.engine.terms import Dictionary
from kg.rules.lines import lacking, lines, stored
from kg.rules.patches import stated
from kg.rules.reports import Difference, RunReport, Seconds
from kg.store.failure import translated
from kg.store.layout import write_atomically
from kg.store.terms import parts_of_lines, spell

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from kg.rules.files import RuleSet

__all__ = ["rdf_format", "run_files"]


def run_files(
    files: Sequence[Path], output: Path | None, rule_set: RuleSet, *, limits: Limits | None = None
) -> RunReport:
    """Write what the rules infer from files of RDF to `output`, sorted by predicate; None writes nothing.

    The ending of a file names its format; N-Triples are read fastest. Of quads the graph is left out.

    Terms are what they would be in a store (`kg.store.terms`). Blank nodes of a single file keep their labels; those
    of several files get new ones, since each file has labels of its own.

    Raises:
        RuleError: KG202, KG203, KG204 for rules that cannot run, KG205 at a limit; `output` is as it was.
        UsageError: KG003 for a file whose ending names no format.
        SourceError: KG101 when a file cannot be opened.
        GraphError: KG601 with the line when it is not valid.
    """
    begin = time.perf_counter()
    program = Program(rule_set.rules)
    dictionary = Dictionary()
    columns: dict[int, list[NDArray[np.int64]]] = {}
    for file in files:
        for predicate, keys in by_predicate(_rows(file, dictionary, rename=len(files) > 1)):
            columns.setdefault(predicate, []).append(keys)
    given, asserted = Facts(), stated(rule_set.data, dictionary)
    for predicate, parts in columns.items():
        given.replace(predicate, distinct(np.concatenate(parts)))
    data = lacking(asserted, given)
    for predicate, keys in given:
        asserted.add(predicate, keys)
    read = time.perf_counter()
    found = evaluate(program, dictionary, asserted, limits=limits or Limits())
    inferred = stored(found.inferred, dictionary)
    for predicate, keys in data:
        inferred.add(predicate, keys)
    evaluated = time.perf_counter()
    if output is not None:
        with translated(str(output)):
            write_atomically(output, b"".join(lines(inferred, dictionary)), durable=False)
    seconds = Seconds(read - begin, evaluated - read, time.perf_counter() - evaluated)
    change = Difference(dictionary, inferred, Facts())
    size = len(inferred)
    reports = tuple(found.reports)
    return RunReport(len(asserted), size, size, 0, seconds, program.levels, "full", reports, change, program.rules)


def _rows(file: Path, dictionary: Dictionary, *, rename: bool) -> NDArray[np.int64]:
    """Return the triples of a file as rows of identifiers."""
    try:
        text = file.read_bytes()
    except OSError as error:
        raise SourceError("KG101", f"cannot be opened: {error.strerror}", place=Place(str(file))) from error
    kind = rdf_format(file)
    found = parts_of_lines(text) if kind == RdfFormat.N_TRIPLES else None
    return dictionary.intern_all(found or _parsed(file, text, kind, rename=rename)).reshape(-1, 3)


def rdf_format(file: Path) -> RdfFormat:
    """Return the format that the ending of a file names; UsageError KG003 for one that names none."""
    found = RdfFormat.from_extension(file.suffix.removeprefix("."))
    if found is None:
        hint = "The endings are .nt, .ttl, .nq, .trig, .n3, .rdf, .xml and .jsonld."
        raise UsageError("KG003", f"the ending of {file} names no format of RDF", hint=hint)
    return found


def _parsed(file: Path, text: bytes, kind: RdfFormat, *, rename: bool) -> Iterator[bytes]:
    """Yield the terms of a text as a store spells them."""
    try:
        for triple in parse(text, kind, base_iri=file.absolute().as_uri(), rename_blank_nodes=rename):
            yield from (spell(triple.subject), spell(triple.predicate), spell(triple.object))
    except SyntaxError as error:
        raise GraphError("KG601", error.msg, place=Place(str(file), error.lineno, error.offset)) from error
