"""Generate pages from the code, and the output of commands in other pages: `python docs/generate.py`.

tests/test_docs.py compares the result with the pages.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Final

from command_pages import markdown as commands_page
from command_pages import roff as man_page
from transcripts import refreshed

from kg.lint.question import DECLARED as LINT
from kg.query import stored
from kg.rules.reading import OPTIONAL, discover
from kg.server.options import DECLARED as SERVE
from kg.settings import DECLARED
from kg.shell.actions import key_table

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.rules.files import RuleFile

__all__ = ["PAGES", "SESSIONS", "checkout", "main", "session"]

_FOLDER: Final = Path(__file__).resolve().parent
_DATES: Final = {"GIT_AUTHOR_DATE": "2026-01-01T00:00:00Z", "GIT_COMMITTER_DATE": "2026-01-01T00:00:00Z"}
"""Fixed dates, so that the commit always has the same hash."""
_AUTHOR: Final = ("-c", "user.name=kg", "-c", "user.email=kg@localhost", "-c", "commit.gpgsign=false")

_SETTINGS: Final = """\
# Settings

<!-- Written by docs/generate.py from kg/settings.py. -->

A flag overrides the environment variable. The variable overrides the nearest `kg.toml` in the working folder or above
it, and the file overrides the default. `kg config show` prints each value and its origin. Relative paths in a file are
relative to the file.

    # kg.toml
    store = "/data/kg"
    jobs = 8

    [serve]
    port = 8080
"""
_TABLES: Final = {
    "": ("Settings of all commands", "", DECLARED),
    "lint": (
        "Settings of `kg lint`",
        "Keys of the table `[lint]`, which also lists the findings that are [accepted](lint.md#accept-known-findings).",
        LINT,
    ),
    "serve": (
        "Settings of `kg serve`",
        (
            "Keys of the table `[serve]`. Settings without a key come from flags and variables only: a `kg.toml` that "
            "comes with a checkout cannot open the server to others."
        ),
        SERVE,
    ),
}
_HEAD: Final = "\n| key of kg.toml | flag | variable | default | meaning |\n|---|---|---|---|---|\n"


def settings_page() -> str:
    """Return docs/settings.md: every setting with its three names and its sentence."""
    parts = [_SETTINGS]
    for title, text, declared in _TABLES.values():
        parts += [f"\n## {title}\n", f"\n{text}\n" if text else "", _HEAD]
        for one in declared.values():
            key, flag = f"`{one.key}`" if one.in_files else "", f"{one.flag} {one.metavar}".strip()
            default = f"`{one.shown}`" if one.shown else ""
            parts.append(f"| {key} | `{_cell(flag)}` | `{one.variable}` | {default} | {one.sentence} |\n")
    return "".join(parts)


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


_QUERIES: Final = """\
# Stored queries

<!-- Written by docs/generate.py from queries/. -->

`kg query NAME` runs a stored query, `kg query --list` lists them. The last part of a name is enough if it is unique.
Parameters are optional unless a query says otherwise:

    kg query who-publishes --param topic=/cmd_vel
    kg query 'SELECT ?node { ?node a ?class }' --param class:=ros:Node

`NAME=VALUE` is a value of the type that the query declares, and a text in other queries, whatever it looks like.
`NAME:=TERM` is a term as in Turtle, with the known prefixes and those of the query: `<urn:a>`, `ros:Node`, `42`,
`true`, `"text"`, `"text"@en`, `"2026-01-01"^^xsd:date`.

Add folders of your own with the [setting](settings.md) `queries`. A file is a SPARQL query that runs without changes,
under a header of comments like those in [queries/](../queries).
"""


def queries_page() -> str:
    """Return docs/queries.md: every query that is shipped, by family, with its description and parameters."""
    parts, family = [_QUERIES], ""
    for name, query in sorted(stored.discover(()).items()):
        first = name.split("/")[0]
        if first != family:
            family = first
            parts.append(f"\n## {family}\n")
        parts.append(f"\n### `{name}`\n\n{query.title}.".replace("?.", "?") + f" {query.description}".rstrip() + "\n")
        if query.parameters:
            parts.append("\n| parameter | example | meaning |\n|---|---|---|\n")
        parts += [f"| `{one.name}` | `{one.example}` | {one.description} |\n" for one in query.parameters]
    return "".join(parts)


_RULES: Final = """\
# The rules of kg

<!-- Written by docs/generate.py from rules/. -->

`kg build` runs these rules after reading sources, and again after changes. `kg why` proves what they infer. Each rule
is a file below [rules/](../rules), with its [examples](rule-examples.md) next to it. `kg rules show NAME` prints the
documentation below and the text of the rule. Add folders of your own with the [setting](settings.md) `rules`; select
families with `rule_families`.
"""

_FAMILIES: Final = {
    "architecture": "Errors in the wiring of systems, as launch files start them. Each finding has a code, KG401 to "
    "KG417. `kg lint` reports the findings, `kg explain` explains the codes. ontology/architecture.ttl lists "
    "exceptions; add your own with `DATA { ... }` in an .srl file.",
    "capability": "What robots can sense, do and know. Messages, services and actions evoke capabilities, by "
    "ontology/capability.ttl. Otherwise names of nodes and topics do, by ontology/capability-contexts.ttl. "
    "See docs/capabilities.md.",
    "communication": "Direct relations of nodes (RNKG), communications (onto-ros), and whether types agree.",
    "copies": "Packages, repositories and definitions that occur in several sources.",
    "function": "The purpose of nodes, in seven categories, by the words and types of ontology/function.ttl.",
    "hardware": "The devices that nodes work with, by the words and types of ontology/hardware.ttl.",
    "ontobot": "Answers to the competency questions of OntoBOT, in its terms, by ontology/ontobot-alignment.ttl.",
    "owl": "The entailments of OWL 2 RL that the loaded ontologies use, named as in the profile. Before they run, "
    "they are specialised to the axioms in the store: `prp-spo1` becomes one plain rule for each "
    "`rdfs:subPropertyOf`. Other rules can therefore negate what they derive, and only useful triples are read. "
    "`kg ontology check` reports contradictions.",
    "owl-rl": "The whole profile, tables 4 to 9, for foreign ontologies. It runs only if `rule_families` lists it, "
    "because rules with negation or new names cannot be stratified together with it. The profile's `false` is "
    "derived as membership in `owl:Nothing`. Of its 78 rules, three are missing: `dt-type2`, `dt-eq` and `dt-diff` "
    "have literals as subjects, which RDF does not allow. Lists of properties in chains and keys have a maximum "
    "length. The triples are the same as those of owlrl, except that owlrl supports more data types, and does not "
    "derive that a class is a subclass of and equivalent to itself.",
}
"""Descriptions of the rule families."""


def rules_page() -> str:
    """Return docs/rules.md: every rule that is shipped, by family, with its documentation."""
    folder = _FOLDER.parent / "rules"
    files = discover([folder], families=list(_FAMILIES)).files
    parts = [_RULES]
    for family, about in _FAMILIES.items():
        parts.append(f"\n## {family}\n\n{fill(about, 120, break_on_hyphens=False)}\n")
        members = [file for file in files if file.family == family]
        if (folder / family / OPTIONAL).exists():
            parts.append("\n| rule | |\n|---|---|\n")
            parts += [f"| `{file.name}` | {file.documentation.title} |\n" for file in members]
        else:
            parts += [_rule(file) for file in members]
    return "".join(parts)


def _rule(file: RuleFile) -> str:
    sections = file.documentation.sections or {}
    mend = f"\n*How to fix.* {sections['How to fix']}\n" if "How to fix" in sections else ""
    limits = f"\n*Known limits.* {sections['Known limits']}\n" if "Known limits" in sections else ""
    link = f"[{file.path.name}](../rules/{file.name}{file.notation})"
    told = f"{sections['What it infers']}\n\n{sections['Why']}\n"
    return f"\n### `{file.name}`\n\n{file.documentation.title} ({link}).\n\n{told}{mend}{limits}"


def rover_picture() -> str:
    """Return docs/rover.svg: what `kg graph` draws of a launch file of the example workspace."""
    from kg import api  # noqa: PLC0415 - only this picture needs a store
    from kg.graph.reading.systems import system_names, systems  # noqa: PLC0415 - as above
    from kg.render.system_graph import system_graph  # noqa: PLC0415 - as above
    from kg.render.system_svg import system_svg  # noqa: PLC0415 - as above
    from kg.settings import load  # noqa: PLC0415 - as above
    from kg.store.opening import reading  # noqa: PLC0415 - as above

    with tempfile.TemporaryDirectory() as folder:
        workspace, store = Path(folder) / "robots", Path(folder) / ".kg"
        shutil.copytree(_FOLDER.parent / "examples" / "workspace", workspace)  # lines are named as seen from its root
        api.build([workspace], store=store)
        settings = load({"store": store})
        with reading(settings) as snapshot:
            names = [one for one in system_names(snapshot) if one.path.endswith("/rover.launch")]
            (rover,) = systems(snapshot, names, settings.base)
    return system_svg(system_graph(rover))


def shell_page() -> str:
    """Return docs/shell.md with the current keys of the shell."""
    page = (_FOLDER / "shell.md").read_text("utf-8")
    head, mark, _ = page.partition("<!-- keys: written by docs/generate.py from kg/shell/actions.py -->\n\n")
    return head + mark + key_table()


PAGES: Final[dict[str, Callable[[], str]]] = {
    "cli.md": commands_page,
    "kg.1": man_page,
    "queries.md": queries_page,
    "rules.md": rules_page,
    "settings.md": settings_page,
    "shell.md": shell_page,
    "rover.svg": rover_picture,
}
"""Generated pages and their generators."""

SESSIONS: Final = (
    "../README.md",
    "quickstart.md",
    "search.md",
    "robots.md",
    "writing-rules.md",
    "compose.md",
    "impact.md",
)
"""Pages with transcripts, whose commands are run."""


def main() -> None:
    """Write every page, and report which changed."""
    for name, make in PAGES.items():
        _write(_FOLDER / name, make())
    for name in SESSIONS:
        path = (_FOLDER / name).resolve()
        with tempfile.TemporaryDirectory() as folder:
            _write(path, session(path, checkout(Path(folder))))


def checkout(folder: Path) -> Path:
    """Make a checkout with `examples/` in `folder` and return its path.

    It is called `kg`, so that readers in a clone see the same names of sources and files.
    """
    clone = folder / "kg"
    shutil.copytree(_FOLDER.parent / "examples", clone / "examples")
    identity = (["config", "user.name", "kg"], ["config", "user.email", "kg@localhost"])  # for commits on a page
    commit = [*_AUTHOR, "commit", "-q", "-m", "The example workspace"]
    for arguments in (["init", "-q"], *identity, ["add", "examples"], commit):
        subprocess.run(["git", "-C", str(clone), *arguments], check=True, env={**os.environ, **_DATES})  # noqa: S607 - the reader's git
    return clone


def session(page: Path, clone: Path) -> str:
    """Return a page with the current output of its commands, run in a checkout."""
    return refreshed(page.read_text(encoding="utf-8"), clone)


def _write(path: Path, text: str) -> None:
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
        sys.stderr.write(f"wrote {path.name}\n")


if __name__ == "__main__":
    main()
