"""Packages that a build would read again, and whether rules changed: without reading, fetching or waiting."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from kg.corpus.sources import is_address
from kg.corpus.workspace import Workspace
from kg.errors import SourceError
from kg.pipeline.inferring import last_run
from kg.pipeline.plan import make_plan, version
from kg.pipeline.reasoning import digest
from kg.pipeline.report import Report
from kg.pipeline.sources import gather, installed_folders
from kg.pipeline.state import State, load

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.layout import Layout


def pending(layout: Layout, settings: Settings) -> dict[str, tuple[str, ...] | None]:
    """Return the packages that a build would read again, for each source of earlier builds.

    The value is None for a source that no longer exists. For git addresses, the last fetched state counts. Sources on
    other machines are left out.
    """
    state = load(layout.cache)
    named = [root for root in _roots(state, layout) if Path(root).exists()]
    changed: dict[str, tuple[str, ...] | None] = {
        name: None for name, source in state.sources.items() if not source.elsewhere
    }
    try:
        sources = gather(named, layout.checkouts, Report())
    except SourceError:
        return changed
    workspace = Workspace(sources, installed_folders(settings))
    plan = make_plan(workspace, state, layout.cache, version(settings, layout.cache), settings.max_file_bytes)
    for source in sources:
        name = source.repository.name
        changed[name] = tuple(package.name for one, package in plan.read if one.repository.name == name)
    return changed


def rules_changed(layout: Layout, settings: Settings) -> bool:
    """Return whether the enabled rules differ from those that ran last; False if none ran.

    Raises as `kg.pipeline.reasoning.digest`.
    """
    last = last_run(layout.cache)
    return last is not None and last.digest != digest(settings, layout.cache)


def _roots(state: State, layout: Layout) -> list[str]:
    """Return the folders that earlier builds read; for git addresses their clones."""
    clones = [one.repository.root for one in state.sources.values()]
    checkouts = str(layout.checkouts)
    return [root for root in state.roots if not is_address(root)] + [one for one in clones if one.startswith(checkouts)]
