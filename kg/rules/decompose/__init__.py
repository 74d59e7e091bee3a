"""Rules as written, in any notation, become rules of the internal form.

Only what is exact is taken apart; the rest stays SPARQL, in an `EngineBlock`. Why each rewriting is exact is in the
module that does it: paths in `paths` and `patterns`, groups in `groups`, sub-SELECTs in `selects`. All are exact for
sets of solutions: a rule derives a triple or not, how often does not matter. Where it does, inside aggregates, only
what keeps the number of solutions is taken apart.
"""

from __future__ import annotations

from kg.rules.decompose.rules import decompose

__all__ = ["decompose"]
