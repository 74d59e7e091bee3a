"""Rules inside the transactions of the pipeline: what is inferred changes together with what it is inferred from."""

from __future__ import annotations

from hashlib import blake2b
from typing import TYPE_CHECKING

from kg import resources
from kg.pipeline.report import Inferred
from kg.rules.folders import families_in_force, user_folders
from kg.rules.reading import packs, rule_files

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.running import Runner
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore
    from kg.store.transaction import EmbeddedTransaction

__all__ = ["Inference", "digest"]


def digest(settings: Settings) -> str:
    """Return what changes whenever a file of a rule in force changes, comes or goes.

    Raises:
        RuleError: KG208 for a pack that cannot be loaded, KG231 for a folder of rules that is closed.
        UsageError: KG002 for a folder or a family of the settings that is not there.
    """
    families = families_in_force(settings)
    found = blake2b(repr(families).encode(), digest_size=16)
    for folder in (resources.folder("rules"), *(pack.folder for pack in packs()), *user_folders(settings)):
        for path, name in rule_files(folder, families):
            found.update(f"{name}{path.suffix}\0".encode())
            found.update(_content(path))
    return found.hexdigest()


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:  # told where the rule is read
        return str(error).encode()


class Inference:
    """The rules in force, run inside a transaction; `remember` when it is committed, so that the next run is short."""

    def __init__(self, store: EmbeddedStore, settings: Settings) -> None:
        self._store = store
        self._settings = settings
        self._runner: Runner | None = None

    def run(self, transaction: EmbeddedTransaction) -> Inferred:
        """Make what is inferred follow from what the transaction has written by now.

        Raises:
            RuleError: KG2xx for rules that cannot be read, KG202 to KG204 for those that cannot run, KG205 at a limit.
        """
        # Numbers are loaded here, not where a build without changes ends.
        from kg.graph.vocabulary import RNKG  # noqa: PLC0415 - see above
        from kg.pipeline.reasoning import rules_over  # noqa: PLC0415 - see above
        from kg.rules.recording import Names  # noqa: PLC0415 - see above
        from kg.rules.running import Runner  # noqa: PLC0415 - see above

        self._runner = Runner(Names.of(self._settings.base, RNKG), self._store.layout.cache)
        found = self._runner.run_within(transaction, rules_over(self._settings, transaction))
        return Inferred(found.inferred, found.added, found.removed, found.seconds.total, found.mode)

    def remember(self, generation: int | None) -> None:
        """Keep what the run read and inferred, as of the generation that its transaction made."""
        if self._runner is not None:
            self._runner.remember(generation)
