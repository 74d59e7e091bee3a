"""The codes of rules: KG2xx."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final[dict[str, CodeEntry]] = {}
