"""Programs as behaviour trees of BehaviorTree.CPP 4, and back."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from hypothesis import assume, given, settings
from lxml import etree
from patience import examples
from robot.programs.btcpp import programs, violations
from robot.programs.trolley import CAPABILITIES

from kg.errors import RobotError
from kg.robot.programs.check import check
from kg.robot.programs.parse import parse
from kg.robot.programs.trees import behavior_tree, program_of
from kg.robot.programs.write import write

if TYPE_CHECKING:
    from kg.robot.programs.tree import Program

_HINTS = re.compile(r' (?:_kg|_description|unit)="[^"]*"')


def _sound(program: Program) -> None:
    assume(not any(problem.severity == "error" for problem in check(program, CAPABILITIES)))


def _root(text: str) -> etree._Element:
    return etree.fromstring(text.encode())


@settings(max_examples=examples(100, 400))
@given(programs)
def test_a_tree_is_read_as_the_program_that_it_was_written_for(program: Program) -> None:
    """Export and import give the same program, with its units, names and comments."""
    _sound(program)
    assert write(program_of(behavior_tree(program, CAPABILITIES), CAPABILITIES)) == write(program)


@settings(max_examples=examples(60, 300))
@given(programs)
def test_without_hints_a_tree_still_means_the_same(program: Program) -> None:
    """A program read from the nodes alone has the same tree; units of logged values are hints, too."""
    _sound(program)
    plain = _HINTS.sub("", behavior_tree(program, CAPABILITIES))
    again = program_of(plain, CAPABILITIES)
    _sound(again)
    assert _HINTS.sub("", behavior_tree(again, CAPABILITIES)) == plain


@settings(max_examples=examples(100, 400))
@given(programs)
def test_a_tree_follows_the_rules_of_version_4(program: Program) -> None:
    """Attributes, ports, children and the model of nodes follow the rules of BehaviorTree.CPP 4."""
    _sound(program)
    assert list(violations(_root(behavior_tree(program, CAPABILITIES)))) == []


def _imported(body: str) -> str:
    text = f'<root BTCPP_format="4"><BehaviorTree ID="Main">{body}</BehaviorTree></root>'
    return write(program_of(text, CAPABILITIES)).removeprefix('program "Main"\n')


@pytest.mark.parametrize(
    ("body", "text"),
    [
        ('<Sequence><goingToPose x="3"/><Sleep msec="500"/></Sequence>', "goingToPose  x: 3\nwait 0.5\n"),
        ('<Action ID="saying" words="hello"/>', 'saying  words: "hello"\n'),
        ('<Repeat num_cycles="3"><Sleep msec="1000"/></Repeat>', "repeat 3 times\n  wait 1\nend\n"),
        ('<Repeat num_cycles="-1"><Sleep msec="1000"/></Repeat>', "forever\n  wait 1\nend\n"),
        ('<Script code="n := 1; n += 2"/>', "set n to 1\nset n to n + 2\n"),
        ('<Script code="a := !(1 &lt; 2) || true"/>', "set a to not 1 < 2 or true\n"),
        (
            '<RetryUntilSuccessful num_attempts="-1"><ScriptCondition code="a == \'x\'"/></RetryUntilSuccessful>',
            'wait until a = "x"\n',
        ),
        (
            '<IfThenElse><ScriptCondition code="!a"/><Sleep msec="1000"/><AlwaysSuccess/></IfThenElse>',
            "if not a then\n  wait 1\nend\n",
        ),
        (
            '<ParallelAll max_failures="0"><Sleep msec="1000"/><Sleep msec="2000"/></ParallelAll>',
            "at the same time\n  wait 1\nalso\n  wait 2\nend\n",
        ),
    ],
)
def test_trees_of_others_are_read_as_far_as_nodes_mean_statements(body: str, text: str) -> None:
    """Nodes written by other tools become statements, too."""
    assert _imported(body) == text


def test_a_subtree_is_read_in_its_place() -> None:
    """Statements of a SubTree replace its reference; values of its ports are variables."""
    text = (
        '<root BTCPP_format="4" main_tree_to_execute="A"><BehaviorTree ID="A"><SubTree ID="B" far="2"/></BehaviorTree>'
        '<BehaviorTree ID="B"><goingToPose x="{far}"/></BehaviorTree></root>'
    )
    assert write(program_of(text, CAPABILITIES)).splitlines()[1:] == ["set far to 2", "goingToPose  x: far"]


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("<Sequence><Fallback><Sleep msec='1'/><Sleep msec='1'/></Fallback></Sequence>", "no statement for what fails"),
        ("<Sequence><AlwaysFailure/></Sequence>", "no statement means <AlwaysFailure> here"),
        ("<WhileDoElse><AlwaysSuccess/><Sleep msec='1'/></WhileDoElse>", "no statement means <WhileDoElse> here"),
        ("<Sleep msec='{x}'/>", "must be a whole number"),
        ("<Sleep msec='1' _skipIf='a'/>", "have no `_skipIf`"),
        ("<IfThenElse><AlwaysSuccess/><Sleep msec='1'/></IfThenElse>", "no statement that fails"),
        ("<Script code='a := b ? 1 : 2'/>", "have no `?`"),
        ("<SubTree ID='Main'/>", "contains itself"),
        ("<LoopDouble queue='1;2;4' value='{x}'><Sleep msec='1'/></LoopDouble>", "equally far"),
        ("<Sequence><Sleep msec='1'/></Sequence><Sleep msec='1'/>", "must have one child"),
    ],
)
def test_what_no_statement_means_is_named(body: str, message: str) -> None:
    """A node without an equivalent statement is KG842, with its line."""
    with pytest.raises(RobotError, match=re.escape(message)) as error:
        _imported(body)
    assert error.value.code == "KG842"
    assert error.value.place is not None
    assert error.value.place.line == 1


@pytest.mark.parametrize("text", ["", "<root/>", "<a", '<!DOCTYPE r [<!ENTITY a "b">]><root>&a;</root>'])
def test_what_is_no_tree_is_refused(text: str) -> None:
    """Other files are KG842, and so are those that define entities."""
    with pytest.raises(RobotError) as error:
        program_of(text, CAPABILITIES)
    assert error.value.code == "KG842"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("whenever pressed of sensingContact\n  stop\nduring\n  wait 1 s\nend", "`whenever` has no node"),
        ("if absolute(x of sensingPose) < 1 m then stop end", "scripts have no `absolute`"),
        ('log "it\'s " + "late"', "a text joined to a text"),
        ("for each one in places of sensingContact\n  wait 1 s\nend", "has no lists"),
        ("wait 0.5 ms", "a whole number of milliseconds"),
        ("set t to 1 s\nwait t", "a number, not a calculation"),
        ("set 'a b' to 1\nset a_b to 2", "needs a name of its own"),
    ],
)
def test_what_no_tree_says_is_named(text: str, message: str) -> None:
    """A statement without equivalent nodes is KG841."""
    with pytest.raises(RobotError, match=re.escape(message)) as error:
        behavior_tree(parse(text), CAPABILITIES)
    assert error.value.code == "KG841"


def test_a_hint_that_the_nodes_contradict_is_left_alone() -> None:
    """An edited port takes precedence over its outdated hint."""
    tree = behavior_tree(parse("go to a pose  x: 300 cm"), CAPABILITIES)
    edited = tree.replace('x="3"', 'x="4"')
    assert write(program_of(edited, CAPABILITIES)) == "goingToPose  x: 4\n"
