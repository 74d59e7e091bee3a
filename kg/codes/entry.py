"""Entry of the catalogue of codes."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CodeEntry:
    """Title, explanation and fix of a code."""

    title: str
    explanation: str
    way_out: str
