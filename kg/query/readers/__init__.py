"""Processes that read the store for others and can be killed, since the engine itself cannot be interrupted.

A reader holds the generation of the store that is in force and answers one request at a time. Deadline, cancelling,
the cap of memory and a crash of the engine all end in the same way: the process ends, the caller gets an error, and
another process takes its place. Faces use `pool.Readers`; docs/query-core.md tells how a query travels.

In a reader: `child` answers, `parts` gives answers out, `forkserver` is what readers are forked from. In the process
that owns them: `processes` and `fleet` are the readers that there are, `scheduler` with `slots` and `sharing` decides
which request runs when, `answers` and `jobs` are what callers see of it, `cache` what is known already. `messages` is
what is said between.
"""
