"""The codes of what should not happen: KG9xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG900": CodeEntry(
        "defect",
        "Something happened in `kg` that should not.",
        "Please report it with what you ran.",
    ),
}
