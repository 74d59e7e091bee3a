"""The options before the command, stored for the command: `Session` is the object of typer's context."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

from kg.settings import Settings, load
from kg.store.failure import remote_refusal

REMOTE: Final = frozenset(
    {
        "action",
        "actions",
        "build",
        "compose",
        "config",
        "export",
        "graph",
        "impact",
        "import",
        "instances",
        "lint",
        "mcp",
        "node",
        "nodes",
        "packages",
        "param",
        "publish",
        "query",
        "search",
        "serve",
        "shell",
        "stats",
        "service",
        "services",
        "show",
        "topic",
        "topics",
        "why",
        "why-not",
    }
)
"""Commands that give the same results over a SPARQL server as over an embedded store with the same graph."""


@dataclass(slots=True)
class Session:
    """One run of `kg`: the settings given before the command, and its name, empty until it is known."""

    flags: dict[str, object] = field(default_factory=dict)
    command: str = ""

    def settings(self, **flags: object) -> Settings:
        """Return the settings in force; `flags` are the command's own and override those before the command.

        Raises:
            UsageError: KG002 an invalid value.
            StoreError: KG309 a SPARQL server, but the command needs an embedded store.
        """
        given = {name: value for name, value in flags.items() if value is not None}
        settings = load({**self.flags, **given})
        if isinstance(settings.store, str) and self.command and self.command not in REMOTE:
            raise remote_refusal(settings.store)
        return settings


def session(context: Any) -> Session:
    """Return the session of a typer context."""
    stored = context.find_object(Session)
    return Session(stored.flags if isinstance(stored, Session) else {}, context.info_name or "")
