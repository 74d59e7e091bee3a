"""Tests of recording look-ups and making them again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.corpus.workspace import FilePath, Workspace, scan_tree
from kg.pipeline.recording import RecordingWorkspace, answer

if TYPE_CHECKING:
    from pipeline.conftest import Bench


def test_recorded_answers_are_given_again(bench: Bench) -> None:
    """Each look-up is recorded with an answer that a plain workspace of the same files gives, found or not."""
    recording = RecordingWorkspace(scan_tree(bench.source))
    near = FilePath("local/src", "one/src/node.cpp")
    assert recording.include("shared/topics.hpp", near=near)
    assert recording.include("no/such.hpp", near=near) is None
    assert recording.module("no.such", near=near) is None
    assert recording.definition("one", "None", "msg") is None
    assert recording.package("two")
    assert recording.package("none") is None
    assert recording.entry(near)
    assert recording.documents("local/src", "one") == ()
    assert len(recording.lookups) == 8
    plain = Workspace(scan_tree(bench.source))
    assert {lookup: answer(plain, lookup) for lookup in recording.lookups} == recording.lookups


def test_only_the_answers_that_differ_differ(bench: Bench) -> None:
    """When a file appears, the look-ups that now find it have another answer."""
    recording = RecordingWorkspace(scan_tree(bench.source))
    near = FilePath("local/src", "one/src/node.cpp")
    recording.include("shared/topics.hpp", near=near)
    recording.include("new/file.hpp", near=near)
    (bench.source / "two" / "include" / "new").mkdir(parents=True)
    (bench.source / "two" / "include" / "new" / "file.hpp").touch()
    changed = Workspace(scan_tree(bench.source))
    differ = [lookup[1] for lookup, before in recording.lookups.items() if answer(changed, lookup) != before]
    assert differ == ["new/file.hpp"]


def test_a_page_that_appears_differs(bench: Bench) -> None:
    """When a README appears around a package, the look-up of its pages has another answer."""
    recording = RecordingWorkspace(scan_tree(bench.source))
    recording.documents("local/src", "one")
    (bench.source / "README.md").write_text("# All\n")
    changed = Workspace(scan_tree(bench.source))
    (lookup,) = recording.lookups
    assert answer(changed, lookup) == "local/src:README.md"


def test_each_package_has_its_own_record(bench: Bench) -> None:
    """Forgetting begins anew."""
    recording = RecordingWorkspace(scan_tree(bench.source))
    recording.package("one")
    recording.forget()
    assert recording.lookups == {}
