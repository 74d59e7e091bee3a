"""The codes of data sets and their repositories: KG130 to KG139."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG130": CodeEntry(
        "invalid criteria",
        "The file of criteria is not TOML, has an unknown key, or has a value of the wrong type.",
        "Correct the line. See the example `corpus/criteria.toml`.",
    ),
    "KG131": CodeEntry(
        "malformed table of projects",
        "The table is not CSV, lacks a column that the criteria name, or has an invalid cell.",
        "Correct the line, or name other columns in your own file of criteria (`--criteria`).",
    ),
    "KG132": CodeEntry(
        "malformed lock file",
        "The lock file of a corpus is not TOML, has another version, or has an invalid entry.",
        "Correct the line, or write the file again with `kg corpus fetch`.",
    ),
    "KG133": CodeEntry(
        "repository not fetched",
        "A repository of a corpus was removed, is unreachable, or has no branch for the requested version of ROS.",
        "Run the command again, or remove the repository from the list. The others were fetched.",
    ),
    "KG134": CodeEntry(
        "repository refused",
        "An address or a repository could harm this machine. The address is a command, or a path leads outside the "
        "folder.",
        "Remove the repository from the list. The others were fetched.",
    ),
    "KG135": CodeEntry(
        "repository too large or too slow",
        "A repository exceeds the size limit or the time limit. Its partial download was removed.",
        "To fetch it, raise `--max-size` or `--timeout`.",
    ),
    "KG136": CodeEntry(
        "corpus incomplete",
        "The folder of the corpus lacks repositories that the lock file lists.",
        "Fetch them with `kg corpus fetch --lock FILE`.",
    ),
    "KG137": CodeEntry(
        "commit differs from the lock",
        "A checkout is at another commit than the lock file pins, or its files were changed.",
        "Fetch the pinned commit with `kg corpus fetch --lock FILE`, or pin the newest one with `--update`.",
    ),
    "KG138": CodeEntry(
        "corpus in use",
        "Another `kg corpus fetch` is using the same folder.",
        "Wait until it has finished.",
    ),
}
