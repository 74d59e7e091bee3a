"""Requested changes of the store: SPARQL updates and writes of whole graphs.

`applying.apply` makes one change in one transaction, with the rules. `writer.Writer` makes changes one after the other,
in a process that can be killed. docs/updates.md describes atomicity, refusals and the effect of rules.
"""
