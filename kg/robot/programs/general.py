"""All that robots can do by the ontology: what programs are checked against when no robot is named."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.robot.capability import Capabilities
from kg.robot.live.inference import knowledge

if TYPE_CHECKING:
    from kg.settings import Settings

__all__ = ["general"]

_OF: Final = "the ontology"


def general(settings: Settings) -> Capabilities:
    """Return every capability of the ontologies, without ways to reach them; raises as `knowledge`."""
    found = [one.capability() for one in knowledge(settings).definitions.values()]
    return Capabilities(of=_OF, capabilities=tuple(sorted(found, key=lambda each: (each.kinds, each.label))))
