"""Reader processes, which can be killed because a query in the engine cannot be interrupted.

A reader opens the current generation of the store and answers one request at a time. Deadlines, cancellation, the
memory limit and a crash of the engine all have the same effect: the process exits, the caller gets an error, and
another process replaces it. Interfaces use `pool.Readers`; docs/query-core.md describes the path of a query.

`forkserver` is the parent of the readers, and contains what each does. In the process that owns them: `processes`
manages them, `scheduler` decides which request runs when, callers see `answers`, and `cache` has earlier responses.
`messages` defines the protocol.
"""
