"""The codes of rules: KG2xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG201": CodeEntry(
        "rule does not parse",
        "The text of a rule is not of its notation at the place given.",
        "Correct the rule there.",
    ),
    "KG209": CodeEntry(
        "not allowed in rules",
        "A rule has a part that rules cannot have (SERVICE, FROM), or that the notation asked for cannot say.",
        "Write the rule without it, or in another notation.",
    ),
    "KG220": CodeEntry(
        "example failed",
        "An example expects triples that its rule does not infer, or its rule infers triples that it should not.",
        "Compare the triples shown; correct the rule or its example.",
    ),
    "KG221": CodeEntry(
        "example malformed",
        "A block of examples does not parse, stands in no example, or says nothing that can be tested.",
        "Correct the block at the line given; docs/rule-examples.md has the format.",
    ),
    "KG225": CodeEntry(
        "remote server failed",
        "A SPARQL server could not be reached, refused a request, or gave an answer that is no result.",
        "Check the address, user and password, and the server's log; the message has the server's own words.",
    ),
    "KG226": CodeEntry(
        "nothing to explain",
        "The fact to explain is not in the store, or no rule in force derives it any more.",
        "Ask `kg why-not` what is missing, or bring the inferred facts up to date with `kg rules run`.",
    ),
}
