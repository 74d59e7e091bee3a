"""What the language server reads: rules, ontologies, the store, and the sources behind it."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from kg import resources
from kg.editors.rules import Knowledge
from kg.errors import StoreError
from kg.graph.ontology_files import default_ontologies, ontologies_in_force
from kg.graph.source_states import sources
from kg.lint.question import DECLARED, Question
from kg.lint.running import Checked, check_store
from kg.pipeline.reasoning import check_context, rule_folders, term_uses
from kg.query.stored import discover
from kg.rules.checks.run import read_all, with_rules
from kg.rules.lsp.symbols import Terms
from kg.rules.reading import families_in_force, packs, user_folders
from kg.settings import Settings, load_table
from kg.store.opening import layout_of, reading
from kg.views.line import line


class Source:
    """The store and the rules in force in the working folder.

    `load` returns the settings there, `options` are those of the command line, which builds get too.
    """

    def __init__(self, load: Callable[[], Settings], options: Sequence[str] = ()) -> None:
        self._load = load
        self._options = tuple(options)
        self._settings = load()

    def enter(self, folder: Path) -> None:
        """Work in another folder.

        Raises UsageError: KG002 for settings there that cannot be used; the settings before stay in force.
        """
        os.chdir(folder)
        self._settings = self._load()

    def knowledge(self) -> Knowledge:
        """Read rules, ontologies and the store's vocabulary; a store is not needed.

        Raises UsageError: KG002 for a folder of the settings that does not exist.
        """
        settings = self._settings
        folders = rule_folders(settings)
        files = read_all(folders, packs(), families_in_force(settings))
        try:
            with reading(settings) as snapshot:
                # Without the store's data, whose checks take longer than a key press.
                context, uses = replace(check_context(settings, snapshot), store=None), term_uses(snapshot)
        except StoreError:
            context, uses = check_context(settings, None), None
        ontologies = ontologies_in_force(settings)
        names = {name: path.resolve() for name, path in reversed(files.paths)}
        own = _own(settings, names)
        shipped = [path for path in (*names.values(), *default_ontologies()) if path.resolve() not in own]
        context = with_rules(files.rules, context)
        return Knowledge(folders, context, Terms.of(ontologies, uses), names, own, tuple(dict.fromkeys(shipped)))

    def findings(self) -> Checked | None:
        """Return what `kg lint` reports; None without a store. UsageError KG002, KG420 and KG421, as `kg lint`."""
        folder = Path.cwd()
        question = Question(**load_table(DECLARED, {}, folder=folder))
        try:
            return check_store(self._settings, question, folder)
        except StoreError as error:
            if error.code == "KG301":
                return None
            raise

    def line(self, path: Path, number: int) -> dict[str, Any]:
        """Return what a line of a file does, see `kg.views.line`; StoreError KG301 without a store."""
        with reading(self._settings) as snapshot:
            return line(snapshot, self._settings, file=path, number=number)

    def build(self, path: Path) -> list[str] | None:
        """Return the command that reads the source of a file again; None if no source in the store has the file.

        Raises StoreError: KG301 without a store.
        """
        with reading(self._settings) as snapshot:
            roots = [Path(one.root).resolve() for one in sources(snapshot) if one.root]
        inside = [root for root in roots if path.is_relative_to(root)]
        if not inside:
            return None
        store = str(layout_of(self._settings).root)
        nearest = max(inside, key=lambda root: len(root.parts))
        return [sys.executable, "-m", "kg", "build", str(nearest), *self._options, "--store", store]


def _own(settings: Settings, names: Mapping[str, Path]) -> tuple[Path, ...]:
    """Return the files of the user that may name a rule or a term, without links."""
    folders = [folder.resolve() for folder in user_folders(settings)]
    rules = [path for path in names.values() if any(path.resolve().is_relative_to(folder) for folder in folders)]
    shipped = {path.resolve() for path in default_ontologies()}
    ontologies = [path for path in ontologies_in_force(settings) if path.resolve() not in shipped]
    own_queries = resources.folder("queries").resolve()
    paths = (query.path for query in discover(settings.queries).values())
    queries = [path for path in paths if not path.resolve().is_relative_to(own_queries)]
    pages = [path.with_suffix(".md") for path in rules]
    every = (*rules, *pages, *ontologies, *queries, Path.cwd() / "kg.toml")
    return tuple(dict.fromkeys(path.resolve() for path in every if path.is_file()))
