from __future__ import annotations

import json

import click
from click.testing import CliRunner
from search.store import CONTENT

from kg.cli.commands.search import narrow
from kg.search.index import build
from kg.search.searching import Search

SEARCH = Search(build(CONTENT))
WORDS = "scan camera driver merger"


@click.command()
def asking() -> None:
    """Print the filters given by the answers on standard input."""
    click.echo(json.dumps(narrow(SEARCH, WORDS, {})))


def asked(typed: str) -> tuple[dict[str, list[str]], str]:
    """Return the filters given by typed lines, and the output."""
    run = CliRunner().invoke(asking, input=typed)
    assert run.exit_code == 0
    return json.loads(run.stdout.splitlines()[-1]), run.stderr


def test_an_answer_is_a_filter() -> None:
    """An answer is a filter that leaves the number of hits shown by the question."""
    filters, shown = asked("1\nq\n")
    assert len(filters) == 1
    assert len(SEARCH.find(WORDS, filters).hits) < len(SEARCH.find(WORDS).hits)
    assert "  1. " in shown


def test_questions_can_be_skipped() -> None:
    """An empty line skips to the next question, until none is left."""
    filters, shown = asked("\n" * 20)
    assert filters == {}
    assert shown.count("?") > 1


def test_the_end_of_the_input_ends_the_questions() -> None:
    """The end of the input and `q` end the questions; earlier answers remain valid."""
    assert asked("")[0] == asked("q\n")[0] == {}


def test_what_is_no_number_is_asked_again() -> None:
    """Input that is not a number is named, and the question is repeated."""
    filters, shown = asked("x\n99\n1\nq\n")
    assert len(filters) == 1
    assert "`x` is not a number from 1 to" in shown
    assert "`99` is not a number" in shown
