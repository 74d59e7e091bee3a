"""`kg rules compile`: one rule in any notation, and in the form that is evaluated."""

from typing import Annotated, Final

import typer

from kg.cli.completion import rules as rule_names
from kg.cli.options import with_settings
from kg.cli.output import write
from kg.errors import UsageError
from kg.settings import Settings

_FORMS: Final = ("form", "rq", "srl", "ttl")

Name = Annotated[
    str, typer.Argument(metavar="RULE", help="FAMILY/NAME, NAME alone, or a file.", autocompletion=rule_names)
]
To = Annotated[str, typer.Option("--to", metavar="NOTATION", help="form, rq (SPARQL), srl or ttl (SHACL).")]


@with_settings("rules", "rule_families")
def compile_rule(name: Name, *, settings: Settings, to: To = "form") -> None:
    """Print a rule as it is evaluated, or in another notation.

    A rule with alternatives (UNION, OPTIONAL, paths) is compiled into several; all are printed, in SPARQL each after
    its name. For example:

        kg rules compile communication/feeds
        kg rules compile communication/feeds --to srl
    """
    from kg.cli.rules_view import here  # noqa: PLC0415 - start-up time
    from kg.pipeline.reasoning import ontology_schema  # noqa: PLC0415 - start-up time
    from kg.rules import printing  # noqa: PLC0415 - start-up time
    from kg.rules.authoring.library import Library  # noqa: PLC0415 - start-up time
    from kg.rules.authoring.manual import manual  # noqa: PLC0415 - start-up time
    from kg.rules.authoring.naming import find_rule  # noqa: PLC0415 - start-up time

    if to not in _FORMS:
        raise UsageError("KG003", f"unknown notation `{to}`", hint=f"Use one of {', '.join(_FORMS)}.")
    library = Library.of(settings)
    entry = find_rule(library, name)
    file = library.read(entry.name)
    prefixes = file.known_prefixes
    if to == "form":
        strata = manual(library, entry, ontology_schema(settings)).strata
        text = printing.to_form(file.rules, prefixes, strata)
        write(text.replace(str(file.path), here(file.path)))
        return
    printers = {"rq": printing.to_rq, "srl": printing.to_srl, "ttl": printing.to_turtle}
    write(printers[to](file.rules, prefixes))
