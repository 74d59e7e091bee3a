"""Views: plain objects made from a snapshot, the same for pages, the shell and assistants.

A view is a function `(snapshot, settings, **arguments)` whose result `msgspec.json` can write; `calls.CALLS` names
them all. Readers (`kg.query.readers`) run them like queries, with the same deadlines.
"""
