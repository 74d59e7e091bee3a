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
    "KG203": CodeEntry(
        "unsafe rule",
        "A variable of the head or of an expression is not bound by the body before it, or is bound twice.",
        "Bind the variable by a triple, or by SET or BIND, before it is read.",
    ),
    "KG202": CodeEntry(
        "rules cannot be stratified",
        "A rule depends, directly or through others, on the negation or the count of what it derives.",
        "Follow the cycle in the message and let the negated or counted pattern read something else.",
    ),
    "KG204": CodeEntry(
        "terms made in recursion",
        "A rule makes new terms (blank nodes, computed values, triple terms) or calls a function that differs from call to "
        "call, and feeds itself: it may never end.",
        "Move what makes terms to a rule that does not recur, or run with a deadline or a limit of triples.",
    ),
    "KG205": CodeEntry(
        "limit of a run of rules",
        "Inference took longer or inferred more triples than allowed. The store is unchanged.",
        "Make the rule named more specific, or raise the limit.",
    ),
    "KG206": CodeEntry(
        "header malformed",
        "The comments that document a rule have a heading or a severity that there is not, or one twice.",
        "Use the headings and severities that the message names.",
    ),
    "KG207": CodeEntry(
        "two rules of one name",
        "Two files of rules have the same name: the path below their folders without the ending.",
        "Rename or remove one of the files.",
    ),
    "KG208": CodeEntry(
        "import not resolved",
        "A rule set or a pack of rules that is asked for cannot be found or loaded.",
        "Correct the name; rule sets are read from files, never fetched.",
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
