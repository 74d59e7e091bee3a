"""Changes of the store that somebody asks for: SPARQL updates and writes of whole graphs.

`applying.apply` makes one change in one transaction, with the rules; `writer.Writer` has a process do it that can be
killed, one change after the other. docs/updates.md says what is atomic, what is refused and what the rules do.
"""
