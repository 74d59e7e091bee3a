"""Fetching of the repositories of a corpus at pinned commits: many of them, one, its branch, its lock file, a cache."""
