from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lint.robot import finding

from kg.errors import Place, UsageError
from kg.lint.allowing import Allowance, Comments, allowances, allowed_by
from kg.lint.finding import Evidence
from kg.lint.report import Choice, report
from kg.settings import table

if TYPE_CHECKING:
    from pathlib import Path

    from kg.lint.finding import Finding

HERE = Place("kg.toml", 1)
HEAD = '[[lint.allow]]\ncode = "KG420"\nreason = "so"\n'


def entry(**more: str) -> Allowance:
    """Return an entry that allows all of a code, narrowed by globs."""
    return Allowance("KG407", "so", HERE, **more)


@pytest.mark.parametrize(
    ("globs", "names"),
    [
        ({}, True),
        ({"subject": "/a"}, True),
        ({"subject": "/*"}, True),
        ({"subject": "/b"}, False),
        ({"file": "*/base.launch"}, True),
        ({"file": "base.launch"}, False),
        ({"system": "bringup/*"}, True),
        ({"system": "other/*"}, False),
        ({"rule": "architecture/*"}, True),
        ({"rule": "mine/*"}, False),
        ({"subject": "/a", "system": "other/*"}, False),
    ],
)
def test_an_entry_names_what_all_its_globs_fit(globs: dict[str, str], names: bool) -> None:  # noqa: FBT001 - a case
    """Subject, file, system and rule narrow a code; each given glob has to match."""
    assert entry(**globs).names(finding()) is names


def test_an_entry_names_only_its_code() -> None:
    """An entry matches only its code, whatever its globs."""
    assert not entry().names(finding(code="KG401"))


def test_entries_are_read_with_their_lines(tmp_path: Path) -> None:
    """Each entry has the line of kg.toml at which it begins."""
    (tmp_path / "kg.toml").write_text(f'jobs = 2\n\n{HEAD}subject = "/x/*"\n{HEAD}', encoding="utf-8")
    first, second = allowances(table("lint", tmp_path), ())
    assert (first.subject, first.place.line, second.subject, second.place.line) == ("/x/*", 3, "*", 7)


def test_without_a_table_nothing_is_allowed(tmp_path: Path) -> None:
    """Without kg.toml, or without entries in it, no finding is allowed."""
    assert allowances(table("lint", tmp_path), ()) == []
    (tmp_path / "kg.toml").write_text("[lint]\n", encoding="utf-8")
    assert allowances(table("lint", tmp_path), ()) == []


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[[lint.allow]]\ncode = "KG420"\n', "the entry for KG420 has no reason"),
        ('[[lint.allow]]\nreason = "so"\n', "this entry has no code"),
        ('[[lint.allow]]\ncode = "KG499"\nreason = "so"\n', "`KG499` is not a code of a finding"),
        (f'{HEAD}topic = "/x"\n', "`topic` is not a key of [[lint.allow]]"),
        (f"{HEAD}subject = 3\n", "`subject` in [[lint.allow]] must be a string, not 3"),
        ('[[lint.allow]]\ncode = "KG420"\nreason = " "\n', "`reason` in [[lint.allow]] must be a string, not ' '"),
        ("lint.allow = 3\n", "`allow` of [lint] must be a list of tables"),
    ],
)
def test_what_allows_nothing_sensible_is_refused(tmp_path: Path, text: str, words: str) -> None:
    """An entry needs a known code and a reason, and no unknown key."""
    (tmp_path / "kg.toml").write_text(text, encoding="utf-8")
    with pytest.raises(UsageError) as caught:
        allowances(table("lint", tmp_path), ())
    assert (caught.value.code, caught.value.message) == ("KG421", words)


def test_all_that_is_wrong_is_told_at_once_with_its_lines(tmp_path: Path) -> None:
    """The place is that of the first wrong key; the others are listed with their lines."""
    text = f'{HEAD}topic = "/x"\n\n{HEAD}\n{HEAD}file = ""\n[[lint.allow]]\ncode = "KG499"\n'
    (tmp_path / "kg.toml").write_text(text, encoding="utf-8")
    with pytest.raises(UsageError) as caught:
        allowances(table("lint", tmp_path), ())
    assert caught.value.place == Place(str(tmp_path / "kg.toml"), 4)
    assert caught.value.message == (
        "`topic` is not a key of [[lint.allow]]; line 13: `file` in [[lint.allow]] must be a string, not ''; "
        "line 15: `KG499` is not a code of a finding; line 14: the entry for KG499 has no reason"
    )


def test_what_an_entry_lacks_is_not_looked_for_in_the_next(tmp_path: Path) -> None:
    """An entry without a code is reported at its own line, although the next entry has one."""
    (tmp_path / "kg.toml").write_text(f'[[lint.allow]]\nreason = "so"\n\n{HEAD}', encoding="utf-8")
    with pytest.raises(UsageError) as caught:
        allowances(table("lint", tmp_path), ())
    assert caught.value.place == Place(str(tmp_path / "kg.toml"), 1)


def test_codes_of_rules_of_ones_own_can_be_allowed(tmp_path: Path) -> None:
    """A code of any finding is valid, including one of a user rule."""
    (tmp_path / "kg.toml").write_text('[[lint.allow]]\ncode = "X1"\nreason = "so"\n', encoding="utf-8")
    assert [one.code for one in allowances(table("lint", tmp_path), {"X1"})] == ["X1"]


COMMENTED = [
    ("<node/> <!-- kg: allow KG407 read elsewhere -->", True),
    ("<!-- kg: allow KG407 read elsewhere -->\n<node/>", True),
    ("x = 3  # kg: allow KG407: read elsewhere", True),
    ("// kg: allow KG407 read elsewhere\nx();", True),
    ("# kg: allow KG407, read elsewhere\n  # kg: allow KG401 too\nx: 1", False),
    ("<node/> <!-- kg: allow KG401 read elsewhere -->", False),
    ("<node/> <!-- kg: allow KG407 -->", False),
    ("<arg/> <!-- kg: allow KG407 read elsewhere -->\n<node/>", False),
    ("<!-- kg: allow KG407 read elsewhere -->\n\n<node/>", False),
    ("kg: allow KG407 read elsewhere", False),
]


@pytest.mark.parametrize(("text", "allows"), COMMENTED)
def test_comments_allow_at_their_line(tmp_path: Path, text: str, allows: bool) -> None:  # noqa: FBT001 - a case
    """A comment is on the line, or alone on the line above, with the code and a reason."""
    (tmp_path / "a.launch").write_text(text, encoding="utf-8")
    place = Evidence("a.launch", len(text.splitlines()), "local/x")
    assert Comments({"local/x": str(tmp_path)}).allow(finding(place=place)) is allows


def test_a_comment_without_reason_is_told(tmp_path: Path) -> None:
    """It allows nothing, and is reported with its place."""
    (tmp_path / "a.launch").write_text("<node/> <!-- kg: allow KG407 -->", encoding="utf-8")
    comments = Comments({"local/x": str(tmp_path)})
    assert not comments.allow(finding(place=Evidence("a.launch", 1, "local/x")))
    assert [(place.line, code) for place, code in comments.without_reason.items()] == [(1, "KG407")]


NOWHERE = [
    None,
    Evidence("a.launch", None, "local/x"),
    Evidence("a.launch", 9, "local/x"),
    Evidence("gone.launch", 1, "local/x"),
    Evidence("a.launch", 1, "other"),
]


@pytest.mark.parametrize("place", NOWHERE)
def test_where_no_line_is_to_be_had_nothing_is_allowed(tmp_path: Path, place: Evidence | None) -> None:
    """Findings without place, missing files, lines past the end, sources in another folder."""
    (tmp_path / "a.launch").write_text("<!-- kg: allow KG407 so -->", encoding="utf-8")
    assert not Comments({"local/x": str(tmp_path)}).allow(finding(place=place))


NAMES = st.sampled_from(["/a", "/a/b", "/camera/image", "*", "/*", "/camera/*", "[a", "/?"])
FINDINGS = st.builds(
    lambda code, subject, system: finding(code=code, subjects=(subject,), system=system),
    st.sampled_from(["KG401", "KG407"]),
    NAMES,
    st.sampled_from(["p/a.launch", "p/b.launch"]),
)
ENTRIES = st.builds(
    lambda subject, system: entry(subject=subject, system=system), NAMES, st.sampled_from(["*", "p/a*"])
)


@settings(deadline=None)
@given(findings=st.lists(FINDINGS, max_size=6), entries=st.lists(ENTRIES, max_size=3))
def test_the_allow_list_hides_nothing_that_it_does_not_name(findings: list[Finding], entries: list[Allowance]) -> None:
    """Every hidden finding is named by an entry, and every other one is reported."""
    comments = Comments({})
    judge = allowed_by(entries, comments)
    found = report(findings, Choice(), included=(), entries=entries, comments=comments)
    assert all(not any(one.names(kept) for one in entries) for kept in found.raw)
    assert sorted(map(repr, found.raw)) == sorted(repr(one) for one in findings if judge(one) is False)
    assert all(any(one.names(hidden) for one in entries) for hidden in found.allowed)
