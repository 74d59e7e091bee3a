"""The codes of reading sources: KG1xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

__all__ = ["CODES"]

CODES: Final = {
    "KG101": CodeEntry(
        "source not found",
        "A folder, repository address or list of sources does not exist or cannot be opened.",
        "Check the path or address.",
    ),
    "KG102": CodeEntry(
        "no package",
        "Nothing below the folder looks like a ROS package: there is no package.xml.",
        "Give the `src` folder of a workspace or the root of a repository.",
    ),
    "KG103": CodeEntry(
        "checkout failed",
        "git could not clone or update a repository.",
        "Read git's message; check the network, the address and your rights.",
    ),
    "KG104": CodeEntry(
        "unknown commit",
        "A repository has no commit, branch or tag of that name, or two commits have none in common.",
        "`git log --all` lists commits; a shallow clone has only the last ones.",
    ),
    "KG110": CodeEntry(
        "unreadable file",
        "A file could not be opened: its permissions, a broken link, or the disk.",
        "Mend the file or leave it; the rest was built.",
    ),
    "KG111": CodeEntry(
        "file too large",
        "A file is larger than the limit for one source file and was not read.",
        "Raise the limit with `max_file_bytes` if it really is source code.",
    ),
    "KG112": CodeEntry(
        "binary file",
        "A file with the name of a source file holds binary data.",
        "Remove or rename it; the rest was built.",
    ),
    "KG113": CodeEntry(
        "encoding",
        "A file is not UTF-8; bytes that are not were read as Latin-1.",
        "Convert the file to UTF-8.",
    ),
    "KG114": CodeEntry(
        "nested too deep",
        "A file is nested deeper than code written by people is; the part below was not read.",
        "Nothing to do unless facts are missing from that file.",
    ),
    "KG115": CodeEntry(
        "syntax error",
        "Part of a file does not parse; what could be recovered was read.",
        "Mend the file at the line given.",
    ),
    "KG116": CodeEntry(
        "malformed XML",
        "An XML file (package.xml, plugin description) is not well-formed, or uses entities, which are refused.",
        "Mend the file at the line given.",
    ),
    "KG117": CodeEntry(
        "malformed CMake",
        "A CMakeLists.txt does not parse at the line given; the commands before it were read.",
        "Mend the file at the line given.",
    ),
    "KG118": CodeEntry(
        "malformed interface definition",
        "A msg, srv or action file does not follow the grammar of interface definitions.",
        "Mend the file at the line given.",
    ),
    "KG119": CodeEntry(
        "malformed YAML",
        "A YAML file does not parse.",
        "Mend the file at the line given.",
    ),
    "KG120": CodeEntry(
        "duplicate package",
        "Two packages of one name stand in the same source; the second is kept under its folder.",
        "Remove or ignore (COLCON_IGNORE, CATKIN_IGNORE) one of them.",
    ),
    "KG121": CodeEntry(
        "extraction failed",
        "A defect in `kg` stopped the extraction of one package; the rest was built.",
        "Please report it with the message and, if you can, the package.",
    ),
    "KG122": CodeEntry(
        "too much to evaluate",
        "A CMakeLists.txt computes more than is followed while reading; what it declared until then was read.",
        "Nothing to do unless nodes of that package are missing.",
    ),
    "KG123": CodeEntry(
        "wrong description of calls",
        "A file of the setting `calls` has a column, value, word or argument number that docs/calls.md does not list.",
        "Correct the file at the line given; `kg extract check` lists all errors.",
    ),
    "KG124": CodeEntry(
        "description that never matches",
        "An earlier row of the setting `calls` matches all calls, or the class, that a row describes.",
        "Remove one of the two rows, or write the narrower one first.",
    ),
}
