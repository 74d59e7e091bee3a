"""Evaluation of the graph: completeness, correctness and retrieval, as in section 4 of RNKG."""

from __future__ import annotations
