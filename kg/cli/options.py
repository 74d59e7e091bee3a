"""The options that come from settings, and those that several commands share."""

from typing import Annotated, Any

import typer

from kg.cli.completion import launches, packages
from kg.settings import DECLARED

__all__ = [
    "Base",
    "Calls",
    "Families",
    "Format",
    "Jobs",
    "Json",
    "Limit",
    "MaxFileBytes",
    "Memory",
    "NlpModel",
    "NoRules",
    "PackageName",
    "Places",
    "Queries",
    "Robot",
    "Rules",
    "SearchModel",
    "Store",
    "System",
    "Timeout",
    "from_setting",
]


def from_setting(name: str, *short: str, **more: Any) -> Any:
    """Return the option of a setting; its value stays text until `kg.settings.load` reads it."""
    declaration = DECLARED[name]
    return typer.Option(
        declaration.flag,
        *short,
        metavar=declaration.metavar,
        help=f"{declaration.sentence} [{declaration.variable}]",
        show_default=False,
        **more,
    )


Store = Annotated[str | None, from_setting("store", "-s")]
Base = Annotated[str | None, from_setting("base")]
Jobs = Annotated[str | None, from_setting("jobs", "-j")]
Calls = Annotated[str | None, from_setting("calls")]
MaxFileBytes = Annotated[str | None, from_setting("max_file_bytes")]
Memory = Annotated[str | None, from_setting("memory")]
NlpModel = Annotated[str | None, from_setting("nlp_model")]
SearchModel = Annotated[str | None, from_setting("search_model", "--model")]
Timeout = Annotated[str | None, from_setting("timeout")]
Limit = Annotated[str | None, from_setting("limit", "-n")]
Format = Annotated[str | None, from_setting("format")]
Robot = Annotated[str | None, from_setting("robot")]
Places = Annotated[str | None, from_setting("places")]
Exclusive = Annotated[
    bool, typer.Option("--exclusive", help="Refuse to move what another node also moves, and stop if one appears.")
]
WatchdogSeconds = Annotated[str | None, from_setting("watchdog")]
Queries = Annotated[str | None, from_setting("queries")]
Rules = Annotated[str | None, from_setting("rules")]
Families = Annotated[str | None, from_setting("rule_families")]
Json = Annotated[bool, typer.Option("--json", help="Write JSON Lines: one object per line.")]
NoRules = Annotated[bool, typer.Option("--no-rules", help="Do not run rules; the next build updates inferred triples.")]
PackageName = Annotated[
    str | None,
    typer.Option(
        "--package",
        "-p",
        metavar="NAME",
        help="Only this package (`name` or `repository:name`).",
        autocompletion=packages,
    ),
]
System = Annotated[
    str | None,
    typer.Option(
        "--system",
        metavar="LAUNCH",
        help="Only what these launch files start: a path, `package/launch/x.launch`, or a suffix of either.",
        autocompletion=launches,
    ),
]
