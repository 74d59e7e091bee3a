"""The codes of data sets and their repositories: KG130 to KG139."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG130": CodeEntry(
        "criteria cannot be used",
        "The file of criteria is no TOML, has a key that there is not, or a value of another kind than the key has.",
        "Correct the line; `corpus/criteria.toml` is an example.",
    ),
    "KG131": CodeEntry(
        "malformed table of projects",
        "The table is no CSV, lacks a column that the criteria name, or has a cell that cannot be what it should.",
        "Correct the line, or name other columns in a file of criteria of your own (`--criteria`).",
    ),
    "KG132": CodeEntry(
        "malformed lock file",
        "The lock file of a corpus is no TOML, of another version, or has an entry that cannot be used.",
        "Correct the line, or let `kg corpus fetch` write the file anew.",
    ),
    "KG133": CodeEntry(
        "repository not fetched",
        "A repository of a corpus is gone, cannot be reached, or has no branch for the version of ROS asked for.",
        "The others were fetched. Run the command again, or take it off the list.",
    ),
    "KG134": CodeEntry(
        "repository refused",
        "An address or a repository could harm this machine: a command for an address, a path that leads out.",
        "The others were fetched. Take it off the list.",
    ),
    "KG135": CodeEntry(
        "repository too large or too slow",
        "A repository is larger than the limit for one, or did not come in time; what had come of it was removed.",
        "Raise `--max-size` or `--timeout` if you want it.",
    ),
    "KG136": CodeEntry(
        "corpus incomplete",
        "Repositories of a lock file are not checked out in its folder.",
        "`kg corpus fetch --lock FILE` fetches them.",
    ),
    "KG137": CodeEntry(
        "commit differs from the lock",
        "A checkout stands at another commit than the lock file pins, or its files were changed.",
        "`kg corpus fetch --lock FILE` fetches the pinned commit, or `--update` pins the newest one.",
    ),
    "KG138": CodeEntry(
        "corpus in use",
        "Another `kg corpus fetch` fetches into the same folder.",
        "Wait until it has ended.",
    ),
}
