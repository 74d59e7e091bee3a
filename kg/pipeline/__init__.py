"""Build pipeline from sources to the store: incremental reading, worker processes, and updates of the store."""
