"""Tests of recording and repeating look-ups."""

from __future__ import annotations

import shutil
from inspect import isfunction
from typing import TYPE_CHECKING

from kg.corpus.workspace import FilePath, Workspace, scan_tree
from kg.facts import FileKind
from kg.pipeline.recording import RecordingWorkspace, answer

if TYPE_CHECKING:
    from pipeline.conftest import Bench


def test_every_look_up_is_recorded() -> None:
    """Every public method of a workspace is recorded, except where a source is: builds do not depend on that."""
    public = {name for name, value in vars(Workspace).items() if isfunction(value) and not name.startswith("_")}
    public.remove("root")
    assert public <= vars(RecordingWorkspace).keys()


def test_recorded_answers_are_given_again(bench: Bench) -> None:
    """Each look-up is recorded once, with the result in a plain workspace of the same files, found or not."""
    recording = RecordingWorkspace(scan_tree(bench.source))
    near = FilePath("local/src", "one/src/node.cpp")
    place = recording.package("two")
    assert place
    assert recording.package("none") is None
    assert recording.include("shared/topics.hpp", near=near)
    assert recording.include("no/such.hpp", near=near) is None
    assert recording.module("no.such", near=near) is None
    assert recording.definition("one", "None", "msg") is None
    assert recording.entry(near)
    assert recording.owner(near) == recording.package("one")
    assert recording.documents("local/src", "one") == ()
    assert [entry.path for entry in recording.files(place, FileKind.CPP)] == ["two/src/node.cpp"]
    assert recording.files(place, FileKind.LAUNCH) == ()
    assert recording.folder(place)[1].name == "two"
    assert recording.links("local/src") == ()
    assert recording.is_package("local/src", "Two")
    assert not recording.is_alone(place)
    assert recording.source("local/src")
    assert recording.is_file(near)
    assert len(recording.lookups) == 18
    assert not recording.is_file(FilePath("local/src", "one/none.bin"))
    assert recording.installed_package("none") is None
    assert len(recording.outside) == 2
    plain = Workspace(scan_tree(bench.source))
    recorded = recording.lookups | recording.outside
    assert {lookup: answer(plain, lookup) for lookup in recorded} == recorded


def test_look_ups_in_a_package_that_is_gone_differ(bench: Bench) -> None:
    """If a package is gone, the look-ups of its files have other results."""
    recording = RecordingWorkspace(scan_tree(bench.source))
    place = recording.package("two")
    assert place
    recording.forget()
    recording.files(place, FileKind.LAUNCH)
    recording.folder(place)
    recording.is_alone(place)
    shutil.rmtree(bench.source / "two")
    changed = Workspace(scan_tree(bench.source))
    assert all(answer(changed, lookup) != before for lookup, before in recording.lookups.items())


def test_only_the_answers_that_differ_differ(bench: Bench) -> None:
    """If a file appears, the look-ups that find it have other results."""
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
    """If a README appears around a package, the look-up of its pages has another result."""
    recording = RecordingWorkspace(scan_tree(bench.source))
    recording.documents("local/src", "one")
    (bench.source / "README.md").write_text("# All\n")
    changed = Workspace(scan_tree(bench.source))
    (lookup,) = recording.lookups
    assert "README.md" in answer(changed, lookup)


def test_each_package_has_its_own_record(bench: Bench) -> None:
    """`forget` starts a new record."""
    recording = RecordingWorkspace(scan_tree(bench.source))
    recording.package("one")
    recording.forget()
    assert recording.lookups == {}
