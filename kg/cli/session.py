"""What the options before the command say, kept for the command: `Session` is the object of typer's context."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from kg.settings import load

if TYPE_CHECKING:
    from kg.settings import Settings

__all__ = ["Session", "session"]


@dataclass(slots=True)
class Session:
    """One run of `kg`: the settings given before the command."""

    flags: dict[str, object] = field(default_factory=dict)

    def settings(self, **flags: object) -> Settings:
        """Return the settings in force; `flags` are the command's own and win over those before the command."""
        given = {name: value for name, value in flags.items() if value is not None}
        return load({**self.flags, **given})


def session(context: Any) -> Session:
    """Return the session of a typer context."""
    found = context.find_object(Session)
    return found if isinstance(found, Session) else Session()
