"""`kg rules lsp`: the language server that editors start."""

import os
import sys
from dataclasses import replace
from typing import TYPE_CHECKING

import typer

from kg.cli.options import Families, Rules, Store
from kg.cli.session import session
from kg.errors import GraphError, StoreError
from kg.store.opening import reading

if TYPE_CHECKING:
    from kg.rules.checks.finding import Context
    from kg.rules.lsp.terms import Terms
    from kg.settings import Settings

__all__ = ["lsp"]


def lsp(context: typer.Context, *, rules: Rules = None, rule_families: Families = None, store: Store = None) -> None:
    """Serve editors: errors as you type, completion, documentation, definitions.

    Speaks the Language Server Protocol on standard input and output; docs/editors.md has configurations for two
    editors. Needs the extra `lsp`: pip install 'kg-ros[lsp]'.
    """
    try:
        from kg.rules.lsp.server import Knowledge, language_server  # noqa: PLC0415 - start-up time
    except ImportError as error:
        raise GraphError("KG605", f"{error.name} is not installed", hint="pip install 'kg-ros[lsp]'") from error
    from kg.pipeline.reasoning import rule_folders  # noqa: PLC0415 - start-up time

    settings = session(context).settings(store=store, rules=rules, rule_families=rule_families)
    knowledge = Knowledge(rule_folders(settings), lambda: _context(settings), lambda: _terms(settings))
    # Copies: the server closes its streams when the editor leaves, and the command still has words to say.
    with os.fdopen(os.dup(sys.stdin.fileno()), "rb") as source, os.fdopen(os.dup(sys.stdout.fileno()), "wb") as target:
        language_server(knowledge).start_io(source, target)


def _context(settings: "Settings") -> "Context":
    """Return what rules are checked against; without the store's data, whose checks take longer than a key press."""
    from kg.pipeline.reasoning import check_context, rule_folders  # noqa: PLC0415 - start-up time
    from kg.rules.checks.run import beside, read_all  # noqa: PLC0415 - start-up time
    from kg.rules.folders import families_in_force  # noqa: PLC0415 - start-up time
    from kg.rules.reading import packs  # noqa: PLC0415 - start-up time

    found = read_all(rule_folders(settings), packs(), families_in_force(settings))
    try:
        with reading(settings) as snapshot:
            known = replace(check_context(settings, snapshot), store=None)
    except StoreError:
        known = check_context(settings, None)
    return beside(found.rules, known)


def _terms(settings: "Settings") -> "Terms":
    from kg.graph.ontology_files import ontologies_in_force  # noqa: PLC0415 - start-up time
    from kg.pipeline.reasoning import term_uses  # noqa: PLC0415 - start-up time
    from kg.rules.lsp.terms import Terms  # noqa: PLC0415 - start-up time

    try:
        with reading(settings) as snapshot:
            uses = term_uses(snapshot)
    except StoreError:
        uses = None
    return Terms.of(ontologies_in_force(settings), uses)
