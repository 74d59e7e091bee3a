"""`kg rules compile`: one rule in any notation, and in the form that is evaluated."""

from typing import Annotated, Final

import typer

from kg.cli.options import RuleName, require_one_of, with_settings
from kg.cli.output import write
from kg.errors import Place, RuleError
from kg.lazily import lazily
from kg.settings import Settings

with lazily():
    from kg.cli.rules_view import here
    from kg.pipeline.reasoning import ontology_schema
    from kg.rules import printing
    from kg.rules.authoring.library import Library
    from kg.rules.authoring.manual import manual
    from kg.rules.authoring.naming import find_rule

_FORMS: Final = ("form", "rq", "srl", "ttl")

To = Annotated[str, typer.Option("--to", metavar="NOTATION", help="form, rq (SPARQL), srl or ttl (SHACL).")]


@with_settings("rules", "rule_families")
def compile_rule(name: RuleName, *, settings: Settings, to: To = "form") -> None:
    """Print a rule as it is evaluated, or in another notation.

    A rule with alternatives (UNION, OPTIONAL, paths) is compiled into several. In another notation they are a file
    that derives the same; in SPARQL one rule, with UNION. For example:

        kg rules compile communication/feeds
        kg rules compile communication/feeds --to srl
    """
    require_one_of(to, _FORMS, "notation")
    library = Library.of(settings)
    entry = find_rule(library, name)
    file = library.read(entry.name)
    prefixes = file.all_prefixes
    if to == "form":
        strata = manual(library, entry, ontology_schema(settings)).strata
        text = printing.to_form(file.rules, prefixes, strata)
        write(text.replace(str(file.path), here(file.path)))
        return
    if not file.rules and not file.data:
        hint = "Its pattern matches no graph, or its head is empty."
        message = "the file derives nothing: there is no rule to print"
        raise RuleError("KG209", message, place=Place(str(file.path)), hint=hint)
    if to == "srl":
        write(printing.to_srl(file.rules, prefixes, file.data))
    else:
        printer = printing.to_rq if to == "rq" else printing.to_turtle
        write(printer((*file.rules, *printing.of_data(file)), prefixes))
