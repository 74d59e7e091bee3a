"""SHACL rules: a Turtle file with shapes that have sh:rule becomes rules of the internal form.

The standard is "SHACL Advanced Features" (W3C, 2017). Each rule is written as CONSTRUCT queries (`statements`): the
targets of its shape bind `?this`, its conditions become filters (`conditions`), its node expressions patterns
(`expressions`). The rest is as for any query.
"""

from __future__ import annotations

from kg.rules.notations.shacl.graph import prefixes
from kg.rules.notations.shacl.statements import rules

__all__ = ["prefixes", "rules"]
