"""Tests of `kg corpus` and `kg build --corpus`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest
from corpus.repositories import MANIFESTS, repository

if TYPE_CHECKING:
    from cli.program import Program

CASE: Final = Path(__file__).parents[1] / "corpus" / "cases" / "selections" / "small"
MANIFEST: Final = MANIFESTS["1"].replace("<name>p</name>", "<name>p</name><version>1.0.0</version>")


def test_select(kg: Program) -> None:
    """The removals of each criterion and the counts are data; the list has one address a line, and fetch reads it."""
    table, criteria = str(CASE / "projects.csv"), str(CASE / "criteria.toml")
    done = kg("corpus", "select", table, "--criteria", criteria, "--output", "robots.txt")
    assert (done.code, done.err) == (0, "")
    lines = [line.split("\t") for line in done.out.splitlines()]
    assert lines[:4] == [
        ["criterion", "removes", "left", "which are"],
        ["all", "", "5", ""],
        ["students", "1", "4", ""],
        ["size", "1", "3", "too large"],
    ]
    assert ["commits", "ours", "100", "300", "200", "200.00", "141.42", "0.71"] in lines
    assert ["commits", "RNKG", "100", "7611", "248", "533.99", "855.36", "1.60"] in lines
    assert (kg.folder / "robots.txt").read_text().splitlines() == [
        "# 3 projects of projects.csv, by criteria.toml",
        *(f"https://example.org/a/{name}" for name in ("kept", "driver", "unknown")),
    ]


def test_select_as_json(kg: Program) -> None:
    """One object contains the steps with the projects they remove, the counts of both, and the addresses."""
    done = kg("corpus", "select", str(CASE / "projects.csv"), "--criteria", str(CASE / "criteria.toml"), "--json")
    found = json.loads(done.out)
    assert (found["projects"], found["selected"], found["selected_paper"]) == (5, 3, 503)
    assert found["steps"][0] | {"says": ""} == {
        "criterion": "students",
        "says": "",
        "removed": 1,
        "left": 4,
        "projects": ["a/student"],
    }
    assert found["figures"]["commits"]["paper"]["max"] == 7611


def test_select_by_default(kg: Program) -> None:
    """Without criteria those of kg apply; a table without their columns is an error with the place and a hint."""
    done = kg("corpus", "select", str(CASE / "projects.csv"))
    assert done.code == 3
    assert "error[KG131]: projects.csv has no column `Contributors`" in done.err
    assert "criteria.toml" in done.err


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (("fetch",), 2, "no folder or lock file given"),
        (("fetch", "list", "--into", "x", "--ros", "3"), 2, "`--ros 3` is not a version of ROS"),
        (("fetch", "list", "--into", "x", "--jobs", "0"), 2, "not a whole number from 1 to 64"),
        (("fetch", "list", "--into", "x", "--max-size", "big"), 2, "not a size"),
        (("fetch", "nothing", "--into", "x"), 3, "KG101"),
        (("fetch", "--lock", "nothing"), 3, "KG101"),
        (("select", "nothing.csv"), 3, "KG101"),
        (("select", "list", "--output", "no/list", "--criteria", "list"), 2, "KG130"),
    ],
)
def test_wrong_arguments(kg: Program, arguments: tuple[str, ...], code: int, says: str) -> None:
    """A wrong argument is reported, and the exit code gives the kind of error."""
    (kg.folder / "list").write_text("https://127.0.0.1:1/a/b\n")
    done = kg("corpus", *arguments)
    assert done.code == code
    assert says in done.err
    assert "KG900" not in done.err


def test_fetch_and_build(kg: Program) -> None:
    """Fetched repositories are built; missing or changed ones are reported, and the exit code shows that."""
    sources = [repository(kg.folder / "srv" / name, {"main": {"package.xml": MANIFEST}}) for name in ("one", "two")]
    lines = [*(source.as_uri() for source in sources), (kg.folder / "srv" / "none").as_uri(), "--upload-pack=x"]
    (kg.folder / "robots.txt").write_text("\n".join(lines))
    done = kg("corpus", "fetch", "robots.txt", "--into", "robots", "--json")
    assert done.code == 1
    states = {entry["name"]: (entry["state"], entry["code"]) for entry in map(json.loads, done.out.splitlines())}
    assert states == {
        "local/one": ("fetched", None),
        "local/two": ("fetched", None),
        "local/none": ("gone", "KG133"),
        "--upload-pack=x": ("refused", "KG134"),
    }
    assert "2 repositories fetched" in done.err

    lock = kg.folder / "robots" / "corpus.lock.toml"
    (kg.folder / "robots" / "local" / "two" / "package.xml").write_text(MANIFEST + "\n")
    done = kg("build", "--corpus", str(lock), "--no-rules", "--json")
    assert done.code == 1
    assert [source["name"] for source in json.loads(done.out)["sources"]] == ["local/one", "local/two"]
    assert "local/none: KG136 gone" in done.err
    assert "local/two: KG137 files were changed" in done.err
    assert "kg corpus fetch --lock" in done.err


def test_build_by_workers_that_fetch(kg: Program) -> None:
    """With a cluster, no checkout is needed; what no worker could fetch is reported, and the exit code shows that."""
    pytest.importorskip("distributed", reason="the extra `cluster` is not installed")
    sources = [repository(kg.folder / "srv" / name, {"main": {"package.xml": MANIFEST}}) for name in ("one", "two")]
    (kg.folder / "robots.txt").write_text("\n".join(source.as_uri() for source in sources))
    kg("corpus", "fetch", "robots.txt", "--into", "robots")
    (kg.folder / "robots" / "local").rename(kg.folder / "checkouts")
    sources[1].rename(kg.folder / "srv" / "renamed")
    cluster = ("--cluster", "local:1", "--artifacts", "artifacts", "--no-rules")
    lock = str(kg.folder / "robots" / "corpus.lock.toml")
    done = kg("build", "--corpus", lock, *cluster, "--json", XDG_CACHE_HOME=str(kg.folder / "cache"))
    assert done.code == 1
    found = json.loads(done.out)
    assert [source["name"] for source in found["sources"]] == ["local/one"]
    assert [(entry["name"], entry["state"], entry["code"]) for entry in found["unfetched"]] == [
        ("local/two", "gone", "KG133")
    ]
    assert "fetches local/one" in done.err
    assert "local/two: KG133 gone: " in done.err
    assert "1 repository left out" in done.err
    assert "KG136" not in done.err


def test_build_of_nothing(kg: Program) -> None:
    """A lock file whose repositories are all missing is an error with instructions to fetch them."""
    (kg.folder / "lock").write_text('version = 1\n[[repository]]\nname = "h/a"\nurl = "https://h/a"\n')
    done = kg("build", "--corpus", "lock")
    assert done.code == 3
    assert "error[KG136]" in done.err
    assert "kg corpus fetch --lock lock" in done.err
