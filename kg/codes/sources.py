"""The codes of reading sources, fetching corpora and tagging texts: KG1xx."""

from __future__ import annotations

from typing import Final

from kg.codes.entry import CodeEntry

CODES: Final = {
    "KG101": CodeEntry(
        "source not found",
        "A folder, repository address or list of sources does not exist or cannot be opened.",
        "Check the path or address.",
    ),
    "KG102": CodeEntry(
        "no package",
        "The folder contains no ROS package: no package.xml was found in it or below it.",
        "Name the `src` folder of a workspace or the root of a repository.",
    ),
    "KG103": CodeEntry(
        "checkout failed",
        "git could not clone or update a repository.",
        "Read git's message. Check the network, the address and your access rights.",
    ),
    "KG104": CodeEntry(
        "unknown commit",
        "The repository has no commit, branch or tag of this name, or the two commits have no common ancestor.",
        "Use a commit that `git log --all` lists. A shallow clone contains only the latest ones.",
    ),
    "KG110": CodeEntry(
        "unreadable file",
        "A file could not be opened. Its permissions, a broken link or the disk might be the cause.",
        "Repair the file or ignore this. Everything else was built.",
    ),
    "KG111": CodeEntry(
        "file too large",
        "A file is larger than the limit for one source file, and was skipped.",
        "If it really is source code, raise the limit `max_file_bytes`.",
    ),
    "KG112": CodeEntry(
        "binary file",
        "A file is named like a source file, but contains binary data.",
        "Remove or rename the file. Everything else was built.",
    ),
    "KG113": CodeEntry(
        "not UTF-8",
        "A file is not valid UTF-8. The invalid bytes were read as Latin-1.",
        "Convert the file to UTF-8.",
    ),
    "KG114": CodeEntry(
        "nested too deep",
        "A file exceeds the maximum nesting depth. The deeper part was skipped.",
        "Ignore this unless facts from the file are missing.",
    ),
    "KG115": CodeEntry(
        "syntax error",
        "Part of a file does not parse. The rest of the file was read.",
        "Correct the file at the line given.",
    ),
    "KG116": CodeEntry(
        "malformed XML",
        "An XML file (package.xml, plugin description) is not well-formed or uses entities, which kg refuses.",
        "Correct the file at the line given.",
    ),
    "KG117": CodeEntry(
        "malformed CMake",
        "A CMakeLists.txt does not parse at the line given. The commands before it were read.",
        "Correct the file at the line given.",
    ),
    "KG118": CodeEntry(
        "malformed interface definition",
        "A msg, srv or action file violates the grammar of interface definitions.",
        "Correct the file at the line given.",
    ),
    "KG119": CodeEntry(
        "malformed YAML",
        "A YAML file does not parse.",
        "Correct the file at the line given.",
    ),
    "KG120": CodeEntry(
        "duplicate package",
        "Two packages in the same source have the same name. The second one is stored under the name of its folder.",
        "Remove one of them, or exclude it with COLCON_IGNORE or CATKIN_IGNORE.",
    ),
    "KG121": CodeEntry(
        "extraction failed",
        "A defect in `kg` stopped the extraction of one package. Everything else was built.",
        "Report the message and, if possible, the package.",
    ),
    "KG122": CodeEntry(
        "too much to evaluate",
        "A CMakeLists.txt exceeds the evaluation limit. The declarations before that point were read.",
        "Ignore this unless nodes of the package are missing.",
    ),
    "KG123": CodeEntry(
        "malformed description of calls",
        "A file of the setting `calls` has a column, value, word or argument number that docs/calls.md does not list.",
        "Correct the file at the line given. `kg extract check` lists all errors.",
    ),
    "KG124": CodeEntry(
        "description that never matches",
        "A row of the setting `calls` has no effect. An earlier row matches the same calls or class.",
        "Remove one of the two rows, or move the narrower one up.",
    ),
    "KG125": CodeEntry(
        "cluster support not installed",
        "`kg build --cluster` needs Dask, which is part of the extra `cluster`.",
        "Install the extra: `pip install 'kg-ros[cluster]'`.",
    ),
    "KG126": CodeEntry(
        "cluster not usable",
        "No scheduler answered at the address of `--cluster`, no worker joined it, or the connection was lost.",
        "Check that the scheduler and its workers run. A second build finds what the first one read.",
    ),
    "KG127": CodeEntry(
        "unsuitable worker",
        "A worker of the cluster has another version of kg, Python or its libraries, or cannot read the sources.",
        "Install the same versions everywhere, and share the sources under the same paths.",
    ),
    "KG128": CodeEntry(
        "store of results not usable",
        "The folder or address of the setting `artifacts` cannot be read or written.",
        "Name a folder that all machines can write to under the same path, or an address that fsspec opens.",
    ),
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
    "KG141": CodeEntry(
        "pipeline not loaded",
        "spaCy cannot load the pipeline that the setting `nlp_model` names.",
        "Install the pipeline, or correct its name or path. If the setting is empty, kg uses its own pipeline.",
    ),
    "KG142": CodeEntry(
        "pipeline without tags",
        "The spaCy pipeline of the setting `nlp_model` assigns no parts of speech or no lemmas.",
        "Name a pipeline with a tagger or morphologizer and a lemmatizer, such as en_core_web_sm.",
    ),
    "KG143": CodeEntry(
        "invalid patterns",
        "The file of hardware phrase patterns is not TOML, or contains an invalid pattern.",
        "Correct the file at the place given. The head of ontology/hardware-patterns.toml describes the format.",
    ),
}
