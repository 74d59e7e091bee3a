"""Functions that may lead to an effect, by the words of their code."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, cast

import pytest

from kg.symbolic.descriptions import Descriptions
from kg.symbolic.reach import Reach

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.symbolic.form import Function
    from kg.symbolic.reach import Code

DESCRIBED = """
[[call]]
name = "advertise"
publishes = { name = 0 }

[[call]]
name = "get"
in = ["ros::param"]
reads = { name = 0 }

[[call]]
name = "publish"
on = ["DebugPublisher"]
publishes = { name = 0 }
"""


class Toy:
    """A program of functions, given as the words of each; a word after `=` is assigned."""

    def __init__(self, **functions: str) -> None:
        self.revision = 0
        self.made: dict[str, Function] = {}
        self.code: dict[str, str] = {}
        for name, code in functions.items():
            self.add(name, code)

    def add(self, name: str, code: str) -> None:
        """Add a function."""
        self.made[name] = cast("Function", SimpleNamespace(name=name, template=("T",), owner=None))
        self.code[name] = code
        self.revision += 1

    def words(self, code: Code) -> frozenset[str] | None:
        """Return the words of a function."""
        return frozenset(self.code[code.name].replace("=", "").split())

    def assigned(self, code: Code) -> frozenset[str]:
        """Return the words that a function assigns."""
        return frozenset(word[1:] for word in self.code[code.name].split() if word.startswith("="))

    def definitions(self, words: frozenset[str]) -> Iterable[Function]:
        """Return the functions of some names."""
        return [self.made[word] for word in words & self.made.keys()]

    def is_alias(self, word: str) -> bool:
        """Return False: nothing has other names."""
        return word == ""

    def mentions(self, word: str) -> bool:
        """Check whether any function has a word."""
        return any(word in code.split() for code in self.code.values())


def reach(program: Toy) -> Reach:
    """Return the analysis of a program."""
    described = Descriptions()
    described.read(DESCRIBED)
    return Reach(described, program)


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("advertise", True),
        ("sum", False),
        ("get", False),
        ("ros param get", True),
        ("publish", False),
        ("publish T", True),
        ("setup", True),
        ("compute", False),
        ("again", False),
        ("T value", True),
        ("generic", False),
    ],
)
def test_a_function_reaches_an_effect_by_its_words(code: str, *, expected: bool) -> None:
    """A described call counts with the words that its description needs, in the function or in one that it names.

    Only its own template parameters, such as T, can stand for any class.
    """
    program = Toy(run=code, setup="helper", helper="advertise", compute="sum", again="run again", generic="T value")
    assert reach(program).reaches(program.made["run"]) is expected


def test_a_call_on_a_class_counts_where_the_program_names_the_class() -> None:
    """A method of a described class is an effect only if the class occurs in the program."""
    program = Toy(run="publish", other="DebugPublisher")
    assert reach(program).reaches(program.made["run"])


def test_an_answer_changes_with_the_program() -> None:
    """A function without effects is analysed again when the program has more code."""
    program = Toy(run="setup")
    analysis = reach(program)
    assert not analysis.reaches(program.made["run"])
    program.add("setup", "advertise")
    assert analysis.reaches(program.made["run"])


def test_changes_are_those_of_all_functions_that_can_run() -> None:
    """The changes of a function include those of the functions it names."""
    program = Toy(run="helper =ready", helper="=count deep", deep="=last run", other="=unseen")
    assert reach(program).changes(program.made["run"]) == {"ready", "count", "last"}


def test_uses_are_the_words_of_all_functions_that_can_run() -> None:
    """The uses of a function include the words of the functions it names."""
    program = Toy(run="helper one", helper="two")
    assert reach(program).uses([program.made["run"]]) == {"helper", "one", "two"}
