from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lint.robot import finding

from kg.errors import UsageError
from kg.lint.baseline import compared, read, written
from kg.lint.finding import Evidence

if TYPE_CHECKING:
    from kg.lint.baseline import Entry
    from kg.lint.finding import Finding


def kept(findings: list[Finding]) -> Counter[Entry]:
    """Return the baseline of findings, written and read."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "baseline.json"
        file.write_text(written(findings), encoding="utf-8")
        return read(file)


def test_lines_may_move() -> None:
    """A finding remains known when the line, the message, the severity or the evidence changes."""
    moved = replace(
        finding(), place=Evidence("bringup/launch/base.launch", 30, "local/rover"), message="other", severity="error"
    )
    new, old, gone = compared([moved], kept([finding()]))
    assert (new, old, gone) == ([], [moved], [])


@pytest.mark.parametrize(
    "other", [{"code": "KG406"}, {"rule": "mine/x"}, {"system": "x/y.launch"}, {"subjects": ("/a", "/b")}]
)
def test_what_is_not_in_the_baseline_is_new(other: dict[str, str]) -> None:
    """Another code, rule, system or subject is another finding; the missing one is reported."""
    new, old, gone = compared([finding(**other)], kept([finding()]))
    assert (len(new), len(old), [one.code for one in gone]) == (1, 0, ["KG407"])


def test_one_more_of_a_kind_is_new() -> None:
    """If two equal findings are known, a third one is reported."""
    new, old, gone = compared([finding()] * 3, kept([finding()] * 2))
    assert (len(new), len(old), gone) == (1, 2, [])


@pytest.mark.parametrize("count", [{}, {"count": 0}, {"count": -2}, {"count": "many"}])
def test_an_entry_without_a_number_is_one_finding(tmp_path: Path, count: dict[str, object]) -> None:
    """A missing or invalid number counts as one, because a baseline entry occurred at least once."""
    entry = {"fingerprint": finding().fingerprint, **count}
    file = tmp_path / "baseline.json"
    file.write_text(json.dumps({"version": 1, "findings": [entry]}), encoding="utf-8")
    new, old, gone = compared([finding()] * 2, read(file))
    assert (len(new), len(old), gone) == (1, 1, [])


def test_the_same_findings_give_the_same_file() -> None:
    """The order of findings does not matter, so a baseline under version control changes only with its content."""
    several = [finding(subjects=(name,)) for name in ("/b", "/a", "/c")]
    assert written(several) == written(several[::-1])
    assert [entry["subjects"] for entry in json.loads(written(several))["findings"]] == [["/a"], ["/b"], ["/c"]]


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", "3", '{"version": 2}', '{"version": 1, "findings": [3]}', '{"version": 1, "findings": [{}]}',
     '{"version": 1, "findings": 3}', "[" * 100_000],
)  # fmt: skip
def test_what_is_no_baseline_is_refused(tmp_path: Path, text: str) -> None:
    """It is an error with the file's name, not an empty baseline."""
    file = tmp_path / "baseline.json"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(UsageError) as caught:
        read(file)
    assert (caught.value.code, caught.value.place and caught.value.place.path) == ("KG420", str(file))


def test_a_baseline_that_is_missing(tmp_path: Path) -> None:
    """A missing baseline is reported as such."""
    with pytest.raises(UsageError, match="KG420: the baseline cannot be read: No such file"):
        read(tmp_path / "none.json")


FINDINGS = st.builds(
    lambda code, system, subjects: finding(code=code, system=system, subjects=tuple(subjects)),
    st.sampled_from(["KG401", "KG407"]),
    st.sampled_from(["p/a.launch", "p/b.launch"]),
    st.lists(st.sampled_from(["/a", "/b", "/ä"]), max_size=2),
)


@settings(deadline=None)
@given(before=st.lists(FINDINGS, max_size=5), now=st.lists(FINDINGS, max_size=5))
def test_a_baseline_hides_nothing_that_it_does_not_name(before: list[Finding], now: list[Finding]) -> None:
    """A finding is hidden at most as often as before; all others are reported."""
    new, old, _ = compared(now, kept(before))
    known = Counter(one.fingerprint for one in before)
    hidden = Counter(one.fingerprint for one in old)
    assert hidden == known & Counter(one.fingerprint for one in now)
    assert sorted(map(repr, new + old)) == sorted(map(repr, now))
