"""Input for testing rules: the enabled rules, and a snapshot to test them on."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kg.graph.vocabulary import RNKG
from kg.pipeline.reasoning import explained_vocabulary
from kg.rules.authoring.library import Library
from kg.rules.authoring.starting import choose
from kg.rules.authoring.workbench import Workbench
from kg.rules.engine.limits import Limits
from kg.rules.explain.view import View
from kg.rules.recording import Names
from kg.store.opening import reading

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.rules.files import RuleFile
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


@dataclass(frozen=True, slots=True)
class Attempt:
    """The enabled rules and a store to test them on; `chosen` contains the named ones, empty for all."""

    library: Library
    files: list[RuleFile]
    chosen: list[RuleFile]
    bench: Workbench
    view: View
    limits: Limits

    @classmethod
    def of(cls, settings: Settings, snapshot: EmbeddedSnapshot, named: Sequence[str] = ()) -> Attempt:
        """Return the rules of the settings, with those `named`.

        Raises:
            UnknownNameError: KG001 for an unknown rule.
            RuleError: for the first file that cannot be read.
        """
        library = Library.of(settings)
        entries = choose(library, named) if named else ()
        files = library.with_those_in_force(entries)
        names = {entry.name for entry in entries}
        bench = Workbench(snapshot, Names.of(settings.base, RNKG))
        view = View(snapshot, explained_vocabulary(settings))
        chosen = [file for file in files if file.name in names]
        explicit = settings.origin("timeout").kind != "default"  # the default is for queries
        return cls(library, files, chosen, bench, view, Limits((settings.timeout or None) if explicit else None))


@contextmanager
def attempt(settings: Settings, named: Sequence[str] = ()) -> Iterator[Attempt]:
    """Yield the rules in force next to the store in force; raises as `Attempt.of`, and KG301 without a store."""
    with reading(settings) as snapshot:
        yield Attempt.of(settings, snapshot, named)
