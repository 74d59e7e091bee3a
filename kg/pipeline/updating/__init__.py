"""Requested changes of the store: SPARQL updates and writes of whole graphs.

`applying.apply` makes one change in one transaction, with the rules; `writer.Writer` has a process do it that can be
killed, one change after the other. docs/updates.md describes atomicity, refusals and the effect of rules.
"""
