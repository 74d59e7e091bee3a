"""What checks of ontologies and data find, as every face shows it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kg.errors import GraphError

if TYPE_CHECKING:
    from pathlib import Path


@dataclass(frozen=True, slots=True)
class OntologyCheck:
    """What the reasoner says of one ontology or of several taken together.

    `files` are the paths taken together. An inconsistent ontology contradicts itself as a whole; otherwise
    `unsatisfiable` holds the IRIs of the classes that can have no instances. `seconds` is the time it took.
    """

    files: tuple[Path, ...]
    consistent: bool
    unsatisfiable: tuple[str, ...]
    seconds: float

    @property
    def good(self) -> bool:
        """Whether there is nothing to mend."""
        return self.consistent and not self.unsatisfiable

    def error(self) -> GraphError | None:
        """Return what is wrong as an error KG602, None when nothing is."""
        names = ", ".join(path.name for path in self.files)
        if not self.consistent:
            return GraphError("KG602", f"{names}: the axioms contradict each other", hint=self._hint())
        if self.unsatisfiable:
            return GraphError("KG602", f"{names}: no instance is possible of {', '.join(self.unsatisfiable)}")
        return None

    def _hint(self) -> str:
        if len(self.files) > 1:
            return "each may be consistent alone: look where they use the same class or individual"
        return "look for an individual of two disjoint classes, or a property used outside its domain and range"


@dataclass(frozen=True, slots=True)
class ShapeFinding:
    """A place in the data that does not conform to a shape; terms are written as N-Triples writes them.

    `severity` is violation, warning or info; `shape` is the IRI of the shape, None when it has none of its own.
    """

    severity: str
    message: str
    focus: str
    path: str | None
    value: str | None
    shape: str | None

    def error(self) -> GraphError:
        """Return the finding as an error KG604."""
        at = " ".join(part for part in (self.path, self.value) if part)
        return GraphError("KG604", f"{self.focus}{f', {at}' if at else ''}: {self.message}")
