"""`kg doctor`: is everything there that `kg` needs?"""

import sys
from dataclasses import asdict

import typer

from kg.cli.diagnostics import colored, say
from kg.cli.options import Json, with_settings
from kg.cli.output import json_lines, write
from kg.errors import Exit
from kg.lazily import lazily
from kg.render.text import count, printable
from kg.settings import Settings

with lazily():
    from kg.cli.checks import checks


@with_settings("store")
def doctor(*, settings: Settings, json: Json = False) -> None:
    """Check the installation and the store.

    Checks Python and the packages that kg needs, git, Java, the disk, the store and the settings. Exits with 1 if a
    check fails.
    """
    wrong = 0
    marks = {"ok": "32", "note": "36", "wrong": "1;31"}
    for check in checks(settings):
        wrong += check.state == "wrong"
        if json:
            json_lines([asdict(check)])
            continue
        state = f"\x1b[{marks[check.state]}m{check.state:<5}\x1b[0m" if colored(sys.stdout) else f"{check.state:<5}"
        write(f"{state}  {check.subject:<18} {printable(check.finding)}")
        if check.way_out:
            write(f"{'':<26}{printable(check.way_out)}")
    if wrong:
        say(f"{count(wrong, 'thing is', 'things are')} wrong")
        raise typer.Exit(Exit.FOUND)
