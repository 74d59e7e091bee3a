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
    "KG202": CodeEntry(
        "rules cannot be stratified",
        "A rule depends, directly or through others, on the negation or the count of what it derives.",
        "Follow the cycle in the message and let the negated or counted pattern read something else.",
    ),
    "KG203": CodeEntry(
        "unsafe rule",
        "A variable of the head or of an expression is not bound by the body before it, or is bound twice.",
        "Bind the variable by a triple, or by SET or BIND, before it is read.",
    ),
    "KG204": CodeEntry(
        "terms made in recursion",
        "A rule makes new terms (blank nodes, computed values, triple terms) or calls a function that differs from "
        "call to call, and feeds itself: it may never end.",
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
    "KG211": CodeEntry(
        "unknown class or property",
        "A rule names a class or property that no ontology defines, no other rule derives and the store does not have.",
        "Correct the name, or define it in an ontology.",
    ),
    "KG212": CodeEntry(
        "cartesian product",
        "Parts of a rule's body share no variable: every match of one is combined with every match of the other.",
        "Join the parts by a variable, or compare them in a filter.",
    ),
    "KG213": CodeEntry(
        "never fires",
        "On this store nothing matches the body of a rule.",
        "Look at the part named: a name may be misspelt, or the data are not there yet. `kg why-not` goes deeper.",
    ),
    "KG214": CodeEntry(
        "always fires",
        "The body of a rule matches even without any data.",
        "Add what the rule should depend on, or state the facts in an ontology.",
    ),
    "KG215": CodeEntry(
        "head never read",
        "No other rule and no stored query reads what a rule derives.",
        "Write a stored query that shows it, or leave the rule out.",
    ),
    "KG216": CodeEntry(
        "duplicate or subsumed",
        "Another rule derives everything that this one derives, or it derives only what it reads.",
        "Remove one of the two.",
    ),
    "KG217": CodeEntry(
        "variable used once",
        "A variable stands in one place of a rule only: it may be misspelt.",
        "Correct it, write `[]`, or begin its name with `_`.",
    ),
    "KG218": CodeEntry(
        "documentation missing",
        "The header of a rule lacks its title, a heading that every rule has, or the version it came with.",
        "Write what is missing; `kg rules new` makes a header to fill in.",
    ),
    "KG219": CodeEntry(
        "examples missing",
        "No file of examples stands beside a rule.",
        "Write NAME.md with blocks `turtle given` and `turtle expect`; `kg rules new` makes one to fill in.",
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
    "KG230": CodeEntry(
        "SHACL feature not supported",
        "A shapes graph uses a feature of SHACL that has no exact counterpart in rules: constraints in JavaScript, "
        "components of its own, recursive shapes, results that depend on an order of nodes, entailment regimes other "
        "than RDFS.",
        "Write it as the hint says, or as a SPARQL rule.",
    ),
    "KG231": CodeEntry(
        "rules not readable",
        "A file or a folder of rules is not there, or may not be opened.",
        "Make it readable, or take its folder out of the setting `rules`.",
    ),
}
