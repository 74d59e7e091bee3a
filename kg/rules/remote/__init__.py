"""Rules on a SPARQL 1.1 server: updates on the server reach the fixpoint; no triple is transferred."""

from __future__ import annotations

from kg.rules.remote.running import RemoteReport, StratumReport, run

__all__ = ["RemoteReport", "StratumReport", "run"]
