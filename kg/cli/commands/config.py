"""`kg config`: the settings in force and where each comes from."""

import os

import typer

from kg.cli.options import Json
from kg.cli.output import Column, json_lines, print_table
from kg.cli.session import session
from kg.lint import question
from kg.server import options as server
from kg.settings import table_values


def setting_rows(context: typer.Context) -> list[dict[str, object]]:
    """Return each setting with its value, origin and sentence, as `kg config show --json` writes them."""
    rows: list[dict[str, object]] = []
    entries = [*session(context).settings().values()]
    for table in (question.DECLARED, server.DECLARED):
        entries += table_values(table)
    for declaration, value, origin in entries:
        plain = [str(path) for path in value] if isinstance(value, tuple) else value
        plain = plain if isinstance(plain, int | float | str | list | None) else str(plain)
        rows.append(
            {
                "setting": ".".join(filter(None, (declaration.table, declaration.key))),
                "value": plain,
                "origin": str(origin),
                "flag": declaration.flag,
                "variable": declaration.variable,
                "about": declaration.sentence,
            }
        )
    return rows


def show(context: typer.Context, *, json: Json = False) -> None:
    """Show all settings with their values and origins.

    A flag overrides the environment variable, which overrides the nearest kg.toml in this folder or above, which
    overrides the default:

        # kg.toml
        store = "/data/kg"
        jobs = 8
        [serve]
        port = 8080
    """
    rows = setting_rows(context)
    if json:
        json_lines(rows)
        return
    columns = (Column("setting", "name"), Column("value"), Column("origin"), Column("about", "dim", spare=1))
    shown = []
    for row in rows:
        value = row["value"]
        if value is None or value == []:
            value = "-"
        text = os.pathsep.join(value) if isinstance(value, list) else str(value)
        shown.append((row["setting"], text, row["origin"], row["about"]))
    print_table(columns, shown)
