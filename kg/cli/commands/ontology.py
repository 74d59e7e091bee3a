"""`kg ontology`: contradictions in ontologies, what follows from them, and whether data conforms to their shapes."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from kg.cli.diagnostics import report, say
from kg.cli.options import Json, OutputFile, argument, option, with_settings
from kg.cli.output import Column, json_lines, listing, terminal, write, write_text
from kg.errors import Exit
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.store.opening import reading

with lazily():
    from pyoxigraph import RdfFormat, serialize

    from kg.graph import ontology

Files = Annotated[list[str] | None, argument("FILE", "Ontologies; by default those that kg ships.")]
Shapes = Annotated[str | None, option("--shapes FILE", "SHACL shapes; by default those that kg ships.")]


def check(files: Files = None, *, json: Json = False) -> None:
    """Check ontologies with the reasoner HermiT (OWL 2 DL).

    Each ontology is checked alone, then all together. Exits with 1 on a contradiction. Needs Java and `pip install
    'kg-ros[ontology]'`. For example:

        kg ontology check
        kg ontology check my-robot.ttl
    """
    verdicts = list(ontology.check([Path(file) for file in files] if files else None))
    if json:
        json_lines(
            {
                "files": [str(path) for path in one.files],
                "consistent": one.consistent,
                "unsatisfiable": list(one.unsatisfiable),
                "seconds": round(one.seconds, 3),
            }
            for one in verdicts
        )
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


def classify(files: Files = None, *, output: OutputFile = None) -> None:
    """Print what follows from ontologies by OWL 2 DL, as Turtle.

    This is the hierarchy of classes and properties, equivalent ones, and the classes of individuals. Your FILEs are
    read together with the ontologies that kg ships; what follows from these alone is left out. `kg import` loads the
    result into a store. Needs Java and `pip install 'kg-ros[ontology]'`. For example:

        kg ontology classify my-robot.ttl -o entailed.ttl
        kg import entailed.ttl
    """
    from kg.syntax.names import PREFIXES  # noqa: PLC0415 - start-up time

    inferred = ontology.classify([Path(file) for file in files] if files else None)
    text = serialize(inferred, format=RdfFormat.TURTLE, prefixes=dict(PREFIXES)) or b""
    write_text(f"{text.decode()}\n", output)
    say(f"{count(len(inferred), 'triple')} inferred")


@with_settings("store")
def validate(*, settings: Settings, shapes: Shapes = None, json: Json = False) -> None:
    """Validate the data of the store against SHACL shapes.

    Exits with 1 if the data does not conform. Needs `pip install 'kg-ros[ontology]'`. Large stores take minutes.
    """
    with reading(settings) as snapshot:
        triples = snapshot.dump(RdfFormat.N_TRIPLES)
    violations = ontology.validate(triples, Path(shapes) if shapes else None)
    columns = (Column("severity"), Column("message"), Column("node"), Column("path"), Column("value"))
    rows = [(one.severity, one.message, one.focus, one.path, one.value) for one in violations]
    if violations or json or not terminal():
        listing(columns, rows, objects=map(asdict, violations) if json else None)
    say(f"{count(len(violations), 'finding')}" if violations else "the data conforms")
    if violations:
        raise typer.Exit(Exit.FOUND)
