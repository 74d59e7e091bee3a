"""Rules on a SPARQL 1.1 server: the fixpoint is reached by updates that the server runs; no triple leaves it.

`graphs` names the temporary graphs and fills the one of what is asserted, `updates` writes a rule as an update,
`running` runs the strata.
"""

from __future__ import annotations

from kg.rules.remote.running import RemoteReport, StratumReport, run

__all__ = ["RemoteReport", "StratumReport", "run"]
