from __future__ import annotations

import json

import click
from click.testing import CliRunner
from search.store import CONTENT

from kg.cli.narrowing import narrow
from kg.search.index import build
from kg.search.searching import Search

SEARCH = Search(build(CONTENT))
WORDS = "scan camera driver merger"


@click.command()
def asking() -> None:
    """Print the filters that the answers on standard input give."""
    click.echo(json.dumps(narrow(SEARCH, WORDS, {})))


def asked(typed: str) -> tuple[dict[str, list[str]], str]:
    """Return the filters that typed lines give, and what was shown."""
    run = CliRunner().invoke(asking, input=typed)
    assert run.exit_code == 0
    return json.loads(run.stdout.splitlines()[-1]), run.stderr


def test_an_answer_is_a_filter() -> None:
    """It leaves as many hits as the question told."""
    filters, shown = asked("1\nq\n")
    assert len(filters) == 1
    assert len(SEARCH.find(WORDS, filters).hits) < len(SEARCH.find(WORDS).hits)
    assert "  1. " in shown


def test_questions_can_be_skipped() -> None:
    """An empty line goes on to the next question, until there is none."""
    filters, shown = asked("\n" * 20)
    assert filters == {}
    assert shown.count("?") > 1


def test_the_end_of_the_input_ends_the_questions() -> None:
    """So does `q`, and what was answered before holds."""
    assert asked("")[0] == asked("q\n")[0] == {}


def test_what_is_no_number_is_asked_again() -> None:
    """The line that was typed is named."""
    filters, shown = asked("x\n99\n1\nq\n")
    assert len(filters) == 1
    assert "`x` is not a number from 1 to" in shown
    assert "`99` is not a number" in shown
