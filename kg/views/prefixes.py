"""The prefixes by which faces shorten IRIs: the view `prefixes`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.query.completion.statistics import declared
from kg.syntax.names import PREFIXES
from kg.views.remembered import once

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def prefixes(snapshot: EmbeddedSnapshot, settings: Settings) -> dict[str, str]:  # noqa: ARG001 - every view is given settings
    """Return prefix to namespace: those predefined in queries, and those that the store declares (`sh:declare`)."""
    return {**_declared(snapshot), **PREFIXES}


@once
def _declared(snapshot: EmbeddedSnapshot) -> dict[str, str]:
    return declared(snapshot)
