"""The codes of rules: KG2xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG201": CodeEntry(
        "rule does not parse",
        "The text of a rule does not follow its notation at the place given.",
        "Correct the rule there.",
    ),
    "KG202": CodeEntry(
        "rules cannot be stratified",
        "A rule depends, directly or through others, on the negation or the count of what it derives.",
        "Break the cycle in the message: the negated or counted pattern must read something else.",
    ),
    "KG203": CodeEntry(
        "unsafe rule",
        "A variable of the head or of an expression is not bound before it is read, or is bound twice.",
        "Bind the variable first, by a triple, SET or BIND.",
    ),
    "KG204": CodeEntry(
        "terms created in recursion",
        "A rule creates new terms (blank nodes, computed values, triple terms) or calls a nondeterministic function, "
        "and feeds itself. It might never end.",
        "Create the terms in a rule that does not recur, or run with a deadline or a limit of triples.",
    ),
    "KG205": CodeEntry(
        "inference limit reached",
        "Inference exceeded its time limit or its limit of triples. The store is unchanged.",
        "Make the named rule more specific, or raise the limit.",
    ),
    "KG206": CodeEntry(
        "malformed header",
        "The documentation comments of a rule have an unknown heading or severity, or one of them twice.",
        "Use the headings and severities that the message lists.",
    ),
    "KG207": CodeEntry(
        "duplicate rule name",
        "Two rule files have the same name: the path below their folders without the extension.",
        "Rename or remove one of the files.",
    ),
    "KG208": CodeEntry(
        "import not resolved",
        "A requested rule set or rule pack cannot be found or loaded.",
        "Correct the name. Rule sets are read from files, never downloaded.",
    ),
    "KG209": CodeEntry(
        "not allowed in rules",
        "A rule has a part that rules do not support (SERVICE, FROM) or that the notation cannot express.",
        "Write the rule without it, or in another notation.",
    ),
    "KG211": CodeEntry(
        "unknown class or property",
        "A rule names an unknown class or property. No ontology defines it, no other rule derives it, and the store "
        "lacks it.",
        "Correct the name, or define it in an ontology.",
    ),
    "KG212": CodeEntry(
        "cartesian product",
        "Parts of a rule's body share no variable. Every match of one is combined with every match of the other.",
        "Join the parts by a variable, or compare them in a filter.",
    ),
    "KG213": CodeEntry(
        "never fires",
        "In this store nothing matches the body of a rule.",
        "Check the part named: a name might be misspelt, or data might be missing. `kg why-not` gives details.",
    ),
    "KG214": CodeEntry(
        "always fires",
        "The body of a rule matches even without any data.",
        "Add a condition to the body, or assert the facts in an ontology.",
    ),
    "KG215": CodeEntry(
        "head never read",
        "No other rule and no stored query reads what the rule derives.",
        "Write a stored query that shows it, or remove the rule.",
    ),
    "KG216": CodeEntry(
        "duplicate or subsumed",
        "Another rule derives everything that this rule derives, or the rule derives only what it reads.",
        "Remove one of the two.",
    ),
    "KG217": CodeEntry(
        "variable used once",
        "A variable occurs only once in a rule. It might be misspelt.",
        "Correct it, write `[]`, or begin its name with `_`.",
    ),
    "KG218": CodeEntry(
        "documentation missing",
        "The header of a rule lacks its title, a required heading, or the version that introduced the rule.",
        "Add the missing part. `kg rules new` writes a template.",
    ),
    "KG219": CodeEntry(
        "examples missing",
        "A rule has no file of examples next to it.",
        "Write NAME.md with blocks `turtle given` and `turtle expect`. `kg rules new` writes a template.",
    ),
    "KG220": CodeEntry(
        "example failed",
        "An example expects triples that its rule does not infer, or its rule infers unexpected triples.",
        "Compare the triples shown. Then correct the rule or its example.",
    ),
    "KG221": CodeEntry(
        "malformed example",
        "An example block does not parse, is outside an example, or tests nothing.",
        "Correct the block at the line given. docs/rule-examples.md describes the format.",
    ),
    "KG225": CodeEntry(
        "remote server failed",
        "A SPARQL server is unreachable, refused a request, or returned an invalid result.",
        "Check the address, user, password and the server's log. The message quotes the server.",
    ),
    "KG226": CodeEntry(
        "nothing to explain",
        "The fact is not in the store, or no active rule derives it any more.",
        "Run `kg why-not` to see what is missing, or `kg rules run` to update the inferred facts.",
    ),
    "KG230": CodeEntry(
        "SHACL feature not supported",
        "A shapes graph uses a SHACL feature without an exact counterpart in rules. Examples are constraints in "
        "JavaScript, custom components and recursive shapes. Results that depend on node order are unsupported, and "
        "so are entailment regimes except RDFS.",
        "Write it as the hint suggests, or as a SPARQL rule.",
    ),
    "KG231": CodeEntry(
        "unreadable rules",
        "A file or folder of rules does not exist, or its permissions forbid reading.",
        "Make it readable, or remove its folder from the setting `rules`.",
    ),
}
