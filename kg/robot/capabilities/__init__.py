"""What a system or a package can do, as rules inferred it: from triples to `Capabilities`."""

from __future__ import annotations

from kg.robot.capabilities.definitions import Definition, definitions
from kg.robot.capabilities.packages import added, package_iri
from kg.robot.capabilities.reading import capabilities_of, held, read

__all__ = ["Definition", "added", "capabilities_of", "definitions", "held", "package_iri", "read"]
