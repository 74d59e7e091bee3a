"""Runs of the rules in force: over the store, over a SPARQL server, over files."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING

from pyoxigraph import RdfFormat, parse

from kg.errors import Place, SourceError, UsageError
from kg.graph.vocabulary import RNKG
from kg.pipeline.inferring import Inference, LastRun, costs, digest, note_run
from kg.pipeline.reasoning import rules_in_force, rules_over, schema_of
from kg.rules.filing import rdf_format
from kg.rules.recording import Names
from kg.rules.remote.running import run as run_remotely
from kg.rules.running import Runner, run, run_files
from kg.rules.specialise import is_schema, specialised
from kg.store.opening import existing
from kg.store.remote import RemoteStore

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from pyoxigraph import Triple

    from kg.rules.engine.limits import Limits
    from kg.rules.remote.running import RemoteReport
    from kg.rules.reports import RunReport
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore

__all__ = ["run_on_files", "run_on_server", "run_on_store"]


def run_on_store(
    settings: Settings, *, full: bool = False, dry_run: bool = False, limits: Limits | None = None
) -> RunReport:
    """Update the inferred triples of the store in force from its other graphs; only with `full` from scratch.

    Ontologies whose files have changed are updated first. Raises:
        GraphError: KG601 for an ontology that cannot be read; the store is as it was.
        RuleError: KG2xx for rules that cannot be read or run, KG205 at a limit; the store is as it was.
        StoreError: KG301 without a store, KG302 while another process writes.
    """
    store, mark = existing(settings), digest(settings)
    inference = Inference(store, settings)
    if inference.outdated():
        report = _run_with_ontologies(store, settings, inference, full=full, dry_run=dry_run, limits=limits)
        base = report.generation
    else:
        with store.read() as snapshot:
            rules, base = rules_over(settings, snapshot), snapshot.generation
        names = Names.of(settings.base, RNKG)
        report = run(store, rules, names, limits=limits, incremental=not full, dry_run=dry_run)
    if not dry_run:
        base = report.generation or base
        spent = costs(report, store.layout.cache)
        last = LastRun(mark, settings.base, base, report.asserted, report.inferred, report.strata, spent)
        note_run(store.layout.cache, last)
    return report


def _run_with_ontologies(  # noqa: PLR0913 - what `run_on_store` was asked, and on what
    store: EmbeddedStore, settings: Settings, inference: Inference, *, full: bool, dry_run: bool, limits: Limits | None
) -> RunReport:
    """Update the ontologies and run the rules in one transaction."""
    runner = Runner(Names.of(settings.base, RNKG), store.layout.cache)
    with store.write("kg rules run") as transaction:
        inference.update_ontologies(transaction)
        rules = rules_over(settings, transaction)
        report = runner.run_within(transaction, rules, limits=limits, incremental=not full)
        if dry_run:
            transaction.roll_back()
            return replace(report, dry_run=True)
        generation = transaction.commit()
    runner.remember(generation)
    inference.remember(generation)
    return replace(report, generation=generation)


def run_on_server(
    settings: Settings, query_address: str, update_address: str | None = None, *, limits: Limits | None = None
) -> RemoteReport:
    """Run the rules on a SPARQL 1.1 server; raises as `run_on_store`, and KG225 when the server fails."""
    store = RemoteStore(query_address, update_address)
    rules = specialised(rules_in_force(settings), schema_of(store.read()))
    return run_remotely(store, rules, inferred_graph=Names.of(settings.base, RNKG).inferred, limits=limits)


def run_on_files(
    settings: Settings, files: Sequence[Path], output: Path | None, *, limits: Limits | None = None
) -> RunReport:
    """Write what the rules infer from files of RDF to `output`, or nowhere.

    Raises as `run_files`, and UsageError KG003 before anything is inferred where `output` cannot be written.
    """
    if output is not None:
        _check_output(output)
    schema = [triple for file in files for triple in _schema(file)]
    return run_files(files, output, specialised(rules_in_force(settings), schema), limits=limits)


def _check_output(output: Path) -> None:
    folder = output.absolute().parent
    problem = None
    if not os.path.isdir(folder):  # noqa: PTH112 - False for what is closed, where Path raises
        problem = f"the folder {folder} does not exist"
    elif os.path.isdir(output):  # noqa: PTH112 - the same
        problem = "it is a folder"
    elif not os.access(folder, os.W_OK | os.X_OK):
        problem = f"the folder {folder} may not be written"
    if problem:
        raise UsageError("KG003", f"cannot be written: {problem}", place=Place(str(output)), hint="Name another file.")


def _schema(file: Path) -> Iterator[Triple]:
    """Yield the axioms of a file; of N-Triples only candidate lines are parsed. Other errors are reported later."""
    kind = rdf_format(file)
    plain = kind == RdfFormat.N_TRIPLES
    try:
        with file.open("rb") as lines:
            found = [line for line in lines if not plain or b"/owl#" in line or b"/rdf-schema#" in line]
    except OSError as error:
        raise SourceError("KG101", f"cannot be opened: {error.strerror}", place=Place(str(file))) from error
    address = file.absolute().as_uri()
    try:
        triples = [quad.triple for quad in parse(b"".join(found), kind, base_iri=address, lenient=True)]
    except SyntaxError:
        return
    yield from (triple for triple in triples if is_schema(triple.predicate, triple.object))
