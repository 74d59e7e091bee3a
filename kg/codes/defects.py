"""The codes of internal errors: KG9xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG900": CodeEntry(
        "internal error",
        "`kg` failed because of a defect in its own code.",
        "Report the error with the command that you ran.",
    ),
}
