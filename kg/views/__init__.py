"""What faces show: plain objects made from a snapshot, the same for pages, the shell and assistants.

A view is a function `(snapshot, settings, **arguments)` that returns what `msgspec.json` can write; `calls.CALLS` names
them all. Readers (`kg.query.readers`) run them beside queries, with the same deadlines.
"""
