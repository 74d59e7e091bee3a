"""`kg ontology`: are the ontologies free of contradictions, and does the data conform to their shapes?"""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.diagnostics import report, say
from kg.cli.options import Json, Store
from kg.cli.output import Column, json_lines, listing, terminal, write
from kg.cli.session import session
from kg.errors import Exit
from kg.render.text import count
from kg.store.opening import reading

if TYPE_CHECKING:
    from kg.graph.findings import OntologyCheck

__all__ = ["check", "validate"]

Files = Annotated[list[str] | None, typer.Argument(metavar="FILE", help="Ontologies; by default those that kg ships.")]
Shapes = Annotated[
    str | None, typer.Option("--shapes", metavar="FILE", help="SHACL shapes; by default those that kg ships.")
]


def check(files: Files = None, *, json: Json = False) -> None:
    """Check ontologies with the reasoner HermiT (OWL 2 DL).

    Each ontology is checked alone, then all together. Exits with 1 on a contradiction. Needs Java and `pip install
    'kg-ros[ontology]'`. For example:

        kg ontology check
        kg ontology check my-robot.ttl
    """
    from kg.graph import ontology  # noqa: PLC0415 - start-up time

    verdicts = ontology.check([Path(file) for file in files] if files else None)
    if json:
        json_lines(_object(one) for one in verdicts)
    else:
        for one in verdicts:
            names = " + ".join(path.name for path in one.files)
            verdict = "consistent, every class can have instances" if one.good else "NOT GOOD"
            write(f"{names}: {verdict} ({one.seconds:.1f} s)")
    errors = [error for one in verdicts if (error := one.error())]
    for error in errors:
        report(error)
    if errors:
        raise typer.Exit(Exit.FOUND)


def validate(context: typer.Context, *, shapes: Shapes = None, json: Json = False, store: Store = None) -> None:
    """Validate the data of the store against SHACL shapes.

    Exits with 1 if the data does not conform. Needs `pip install 'kg-ros[ontology]'`. Large stores take minutes.
    """
    from pyoxigraph import RdfFormat  # noqa: PLC0415 - start-up time

    from kg.graph import ontology  # noqa: PLC0415 - start-up time

    with reading(session(context).settings(store=store)) as snapshot:
        triples = snapshot.dump(RdfFormat.N_TRIPLES)
    found = ontology.validate(triples, Path(shapes) if shapes else None)
    columns = (Column("severity"), Column("message"), Column("node"), Column("path"), Column("value"))
    rows = [(one.severity, one.message, one.focus, one.path, one.value) for one in found]
    if found or json or not terminal():
        listing(columns, rows, objects=map(asdict, found) if json else None)
    say(f"{count(len(found), 'finding')}" if found else "the data conforms")
    if found:
        raise typer.Exit(Exit.FOUND)


def _object(verdict: "OntologyCheck") -> dict[str, object]:
    return {
        "files": [str(path) for path in verdict.files],
        "consistent": verdict.consistent,
        "unsatisfiable": list(verdict.unsatisfiable),
        "seconds": round(verdict.seconds, 3),
    }
