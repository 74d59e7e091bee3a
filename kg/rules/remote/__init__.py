"""Rules on a SPARQL 1.1 server: the fixpoint is reached by updates that the server runs; no triple leaves it."""

from __future__ import annotations

from kg.rules.remote.running import RemoteReport, StratumReport, run

__all__ = ["RemoteReport", "StratumReport", "run"]
