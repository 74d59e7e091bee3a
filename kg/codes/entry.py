"""What is known of a code."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["CodeEntry"]


@dataclass(frozen=True, slots=True)
class CodeEntry:
    """What a code means, for every face that explains it."""

    title: str
    explanation: str
    way_out: str
