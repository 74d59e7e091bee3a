"""The codes of rules: KG2xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG209": CodeEntry(
        "not allowed in rules",
        "A rule has a part that rules cannot have (SERVICE, FROM), or that the notation asked for cannot say.",
        "Write the rule without it, or in another notation.",
    ),
    "KG225": CodeEntry(
        "remote server failed",
        "A SPARQL server could not be reached, refused a request, or gave an answer that is no result.",
        "Check the address, user and password, and the server's log; the message has the server's own words.",
    ),
}
