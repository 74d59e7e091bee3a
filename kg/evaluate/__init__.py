"""How good the graph is: completeness, correctness and retrieval, as section 4 of RNKG measures them."""

from __future__ import annotations
