from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING

from repository import ROOT

from kg.settings import DECLARED

sys.path.append(str(ROOT / "docs"))
from command_pages import markdown

if TYPE_CHECKING:
    from cli.program import Program


def test_the_page_of_commands_is_current() -> None:
    """docs/cli.md matches the commands; `python docs/generate.py` updates it."""
    page = ROOT / "docs" / "cli.md"
    assert page.read_text(encoding="utf-8") == markdown()


def test_programs_can_read_what_commands_there_are(kg: Program) -> None:
    """`kg --spec` prints one JSON object with every command, option, setting and exit code."""
    described = json.loads(kg("--spec").out)
    commands = {one["command"]: one for one in described["commands"]}
    assert {"kg", "kg build", "kg query", "kg config show", "kg ontology check"} <= set(commands)
    assert "--help-query" in {option["name"] for option in commands["kg query"]["options"]}
    assert [one["setting"] for one in described["settings"]] == list(DECLARED)
    assert described["exit_codes"]["interrupted"] == 130
