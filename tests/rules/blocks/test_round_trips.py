"""Rules as blocks and as text: texts of blocks pass the check, and both forms convert to each other."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from kg.errors import RuleError
from kg.pipeline.reasoning import check_context
from kg.resources import folder
from kg.rules.blocks.read import read
from kg.rules.blocks.tree import (
    Absent,
    Bound,
    Compare,
    Either,
    Fact,
    Is,
    Join,
    Let,
    Logic,
    Match,
    Name,
    Not,
    Number,
    Of,
    Only,
    Other,
    Perhaps,
    Present,
    Reckon,
    Rule,
    Text,
    Thing,
    Truth,
)
from kg.rules.blocks.write import write
from kg.rules.checks.run import check_file, with_rules
from kg.rules.files import RuleSet
from kg.rules.reading import read_text
from kg.settings import load

if TYPE_CHECKING:
    from hypothesis.strategies import DrawFn

    from kg.rules.blocks.tree import Condition, Term, Test, Value
    from kg.rules.checks.finding import Context

SHIPPED = sorted((folder("rules")).rglob("*.rq"))
EXAMPLES = sorted((folder("examples") / "rules").rglob("*.rq"))

_WORDS = st.text(st.characters(categories=["L", "N", "P", "Zs"], exclude_characters="#`"), min_size=1, max_size=40).map(
    lambda text: " ".join(text.split())
)
_SAID = _WORDS.filter(lambda text: text and not text.startswith(("since:", "severity:")))
_LITERALS: Any = st.one_of(
    st.builds(Text, value=st.text(st.characters(exclude_categories=["Cs"]), max_size=20)),
    st.builds(Text, value=_WORDS, language=st.sampled_from(["en", "de"])),
    st.builds(Number, value=st.sampled_from(["0", "7", "-3", "1.5", "-0.25", "2e3"])),
    st.builds(Truth, value=st.booleans()),
)
_RELATIONS = st.sampled_from(["rnkg:publishes", "rnkg:subscribes", "rnkg:hasMessage", "ros:hasComponent", "rnkg:calls"])
_KINDS = st.sampled_from(["ros:Node", "ros:Topic", "ros:Publisher", "rnkg:MessageType"])
_VALUES = st.sampled_from(["rdfs:label", "rnkg:name", "rnkg:implicit"])
_CONCLUDED = st.sampled_from(["rnkg:usesHardware", "rnkg:hasFunction"])
"""Properties read by stored queries, so no check reports them as unused."""
_PATHS = st.sampled_from(["rnkg:publishes/rnkg:hasMessage", "^ros:hasComponent", "rnkg:publishes|rnkg:subscribes"])


@st.composite
def _facts(draw: DrawFn, bound: list[str], fresh: str) -> Condition:
    """Return a pattern that starts at a bound variable; it may bind one more."""
    subject = Thing(name=draw(st.sampled_from(bound)))
    kind = draw(st.integers(0, 4))
    if kind == 0:
        return Is(subject=subject, kind=draw(_KINDS))
    if kind == 1:
        return Fact(subject=subject, property=draw(_VALUES), object=draw(_LITERALS))
    name = fresh if draw(st.booleans()) else draw(st.sampled_from(bound))
    if name not in bound:
        bound.append(name)
    return Fact(subject=subject, property=draw(_RELATIONS if kind < 4 else _PATHS), object=Thing(name=name))


@st.composite
def _values(draw: DrawFn, bound: list[str], depth: int = 2) -> Value:
    thing = Thing(name=draw(st.sampled_from(bound)))
    if not depth:
        leaf: Value = draw(st.one_of(st.just(thing), _LITERALS, st.just(Name(name="capability:ranging"))))
        return leaf
    inner = _values(bound, depth - 1)
    made: Value = draw(
        st.one_of(
            st.just(thing),
            st.builds(Join, parts=st.tuples(st.just(thing), inner)),
            st.builds(Of, function=st.sampled_from(["STR", "LCASE", "STRLEN"]), of=st.just(thing)),
            st.builds(Reckon, operator=st.sampled_from("+-*/"), left=st.just(thing), right=inner),
        )
    )
    return made


@st.composite
def _tests(draw: DrawFn, bound: list[str], depth: int = 2) -> Test:
    thing, value = _values(bound, 1), _values(bound, 0)
    leaves: list[Any] = [
        st.builds(Compare, operator=st.sampled_from(["=", "!=", "<", "<=", ">", ">="]), left=thing, right=value),
        st.builds(Match, how=st.sampled_from(["CONTAINS", "STRSTARTS", "STRENDS", "REGEX"]), value=thing, text=value),
        st.builds(Bound, name=st.sampled_from(bound)),
    ]
    if depth:
        inner = _tests(bound, depth - 1)
        leaves += [
            st.builds(Logic, operator=st.sampled_from(["and", "or"]), left=inner, right=inner),
            st.builds(Not, of=inner),
        ]
    found: Test = draw(st.one_of(leaves))
    return found


@st.composite
def _patterns(draw: DrawFn, bound: list[str], depth: int) -> list[Condition]:
    """Return conditions over bound variables, which they extend with their own for later conditions."""
    found: list[Condition] = []
    for number in range(draw(st.integers(1, 3))):
        kind = draw(st.integers(0, 5 if depth else 0))
        if kind < 2:
            found.append(draw(_facts(bound, f"thing{depth}{number}")))
        elif kind == 2:
            found.append(Only(test=draw(_tests(bound))))
        elif kind == 3:
            made: Any = draw(st.sampled_from([Absent, Present, Perhaps]))
            # Variables of an optional part are not used after it.
            found.append(made(when=tuple(draw(_inside(list(bound), depth - 1)))))
        elif kind == 4:
            branches = tuple(tuple(draw(_inside(list(bound), depth - 1))) for _ in range(2))
            found.append(Either(branches=branches))
        else:
            name = f"value{depth}{number}"
            found.append(Let(name=name, value=draw(_values(list(bound)))))
    return found


@st.composite
def _inside(draw: DrawFn, bound: list[str], depth: int) -> list[Condition]:
    """Return conditions that start with a fact of their own, which joins each part to its surroundings."""
    stem = f"inner{depth}{draw(st.integers(0, 9))}"
    first = Fact(subject=Thing(name=bound[0]), property=draw(_RELATIONS), object=Thing(name=stem))
    return [first, *(draw(_facts([*bound, stem], f"{stem}x")) for _ in range(draw(st.integers(0, 2))))]


@st.composite
def rules(draw: DrawFn) -> Rule:
    """Return a rule of blocks with all parts joined."""
    bound = ["node", "topic"]
    first = Fact(subject=Thing(name="node"), property=draw(_RELATIONS), object=Thing(name="topic"))
    when = [first, *draw(_patterns(bound, 2))]
    objects: list[Term] = [Name(name="hardware:lidar"), Name(name="hardware:camera")]
    then = [
        Fact(subject=Thing(name="node"), property=draw(_CONCLUDED), object=one)
        for one in draw(st.lists(st.sampled_from(objects), min_size=1, max_size=2, unique=True))
    ]
    return Rule(
        name=draw(st.sampled_from(["mine/rule", "a/b/c-d"])),
        title=draw(_SAID),
        why=draw(_SAID),
        infers=draw(st.one_of(st.just(""), _SAID)),
        limits=draw(st.one_of(st.just(""), _SAID)),
        since=draw(st.sampled_from(["0.1", "2.0"])),
        when=tuple(when),
        then=tuple(then),
    )


@cache
def _context() -> Context:
    return check_context(load({}, environment={}), None)


@settings(max_examples=60)
@given(rules())
def test_what_blocks_say_passes_the_check(rule: Rule) -> None:
    """The text of a rule with joined parts has no finding, except the missing examples."""
    text = write(rule).text
    file = read_text(text, Path("rules/rule.rq"), rule.name)
    assume(file.rules)  # a filter that never holds gives no solution: it is reported, as below
    found = [one for one in check_file(file, with_rules(RuleSet((file,)), _context())) if one.code != "KG219"]
    assert found == [], text


def test_a_test_that_never_holds_is_told() -> None:
    """The negation of a part that always matches never holds: the check reports the filter."""
    text = """CONSTRUCT { ?node rnkg:usesHardware hardware:lidar }
    WHERE { ?node rnkg:publishes ?_topic FILTER(!BOUND(?node)) }"""
    file = read_text(text, Path("rules/rule.rq"), "mine/rule")
    found = next(one for one in check_file(file, with_rules(RuleSet((file,)), _context())) if one.code == "KG201")
    assert found.message == "no rule here can infer anything"
    assert "filters that can hold" in str(found.hint)


@given(rules())
def test_blocks_are_read_from_their_text(rule: Rule) -> None:
    """The text of blocks is parsed to the same blocks, also by JSON."""
    assert read(write(rule).text, rule.name) == rule
    assert msgspec.json.decode(msgspec.json.encode(rule), type=Rule) == rule


@pytest.mark.parametrize("path", [*SHIPPED, *EXAMPLES], ids=lambda path: path.stem)
def test_any_rule_can_be_shown(path: Path) -> None:
    """The blocks of a rule in SPARQL are equivalent to its text: both compile to the same rules."""
    name, text = f"{path.parent.name}/{path.stem}", path.read_text("utf-8")
    rule = read(text, name)
    written = write(rule).text
    assert read(written, name) == rule
    one, other = (read_text(each, path, name) for each in (text, written))
    assert one.documentation == other.documentation
    assert [str(rule.head) for rule in one.rules] == [str(rule.head) for rule in one.rules]
    assert [len(rule.body) for rule in one.rules] == [len(rule.body) for rule in other.rules]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_examples_have_blocks_throughout(path: Path) -> None:
    """The starting rules have no part in SPARQL, and are written unchanged."""
    name = f"{path.parent.name}/{path.stem}"
    rule = read(path.read_text("utf-8"), name)
    assert not any(sign in repr(rule) for sign in ("Other(", "Formula(", "RawTest("))
    assert write(rule).text == path.read_text("utf-8")


def test_lines_have_the_blocks_that_wrote_them() -> None:
    """Each line of a pattern has its block, and lines of nested blocks have theirs."""
    inner = Fact(id="inner", subject=Thing(name="x"), property="rnkg:calls", object=Thing(name="y"))
    rule = Rule(
        when=(Is(id="kind", subject=Thing(name="x"), kind="ros:Node"), Absent(id="absent", when=(inner,))),
        then=(Is(id="head", subject=Thing(name="x"), kind="my:Idle"),),
    )
    written = write(rule)
    lines = written.text.split("\n")
    assert {lines[number - 1].strip(): owner for number, owner in written.lines.items()} == {
        "CONSTRUCT { ?x a my:Idle }": "head",
        "?x a ros:Node .": "kind",
        "FILTER NOT EXISTS {": "absent",
        "?x rnkg:calls ?_y .": "inner",
        "}": "absent",
    }


def test_what_has_no_block_stays_sparql() -> None:
    """VALUES, sub-SELECTs and functions without a block remain unchanged, and variables keep their names."""
    text = """CONSTRUCT { ?a my:b ?n }
    WHERE { VALUES ?a { <x:a> <x:b> } { SELECT ?a (COUNT(*) AS ?n) WHERE { ?a rnkg:calls ?c } GROUP BY ?a }
      FILTER(?n IN (1, 2)) [] rnkg:calls ?a }"""
    rule = read("PREFIX my: <x:>\n" + text, "mine/rule")
    values, select, only, fact = rule.when
    assert isinstance(values, Other)
    assert values.text == "VALUES ?a { <x:a> <x:b> }"
    assert isinstance(select, Other)
    assert select.text.startswith("{ SELECT ?a")
    assert "?n IN (1, 2)" in repr(only)
    assert isinstance(fact, Fact)
    assert rule.prefixes == {"my": "x:"}
    assert read(write(rule).text, "mine/rule") == rule


def test_a_head_without_names_is_refused() -> None:
    """A rule that creates unnamed nodes cannot be shown, and the error explains why."""
    with pytest.raises(RuleError, match="without a name"):
        read("CONSTRUCT { ?a rnkg:calls [] } WHERE { ?a a ros:Node }", "mine/rule")


@pytest.mark.parametrize(
    "wrong",
    [
        {"name": "no family"},
        {"severity": "grave"},
        {"prefixes": {"a": "not > an IRI"}},
        {"when": [{"block": "let", "name": "two words", "value": {"term": "truth", "value": True}}]},
        {"then": [{"block": "absent", "when": []}]},
    ],
)
def test_blocks_that_are_none_are_refused(wrong: dict[str, Any]) -> None:
    """JSON that is not a rule is rejected on parsing."""
    with pytest.raises(msgspec.ValidationError):
        msgspec.convert(wrong, Rule)
