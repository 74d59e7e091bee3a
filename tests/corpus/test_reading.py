from __future__ import annotations

import os
from pathlib import Path

import pytest
from extract.workspaces import codes, reader_of
from hypothesis import given
from hypothesis import strategies as st

from kg.corpus.files import FilePath, PackageFolder, Source
from kg.corpus.reading import Reader, digest
from kg.corpus.scanning import scan
from kg.corpus.workspace import Workspace
from kg.facts import Repository


def test_reading_is_on_record(tmp_path: Path) -> None:
    """Every file read is in the inputs with its digest, once."""
    reader = reader_of(tmp_path, {"a.cpp": "int a;\n", "b.cpp": "int b;\n"})
    assert reader.read("demo/a.cpp") == b"int a;\n"
    assert reader.read(FilePath(reader.repository, "demo/a.cpp")) == b"int a;\n"
    assert reader.inputs == ((f"{reader.repository}:demo/a.cpp", digest(b"int a;\n")),)
    assert reader.problems == ()


@pytest.mark.parametrize(
    ("content", "text", "problem"),
    [
        ("// käse\n".encode(), "// käse\n", None),
        (b"\xef\xbb\xbfint a;", "int a;", None),
        ("a\n// käse\n".encode("latin-1"), "a\n// käse\n", ("KG113", 2)),
        ("int a;".encode("utf-16"), "int a;", ("KG113", None)),
        (b"\x7fELF\0\0\1", None, ("KG112", None)),
        (b"x" * 2000, None, ("KG111", None)),
    ],
)
def test_content(tmp_path: Path, content: bytes, text: str | None, problem: tuple[str, int | None] | None) -> None:
    """Text is returned as UTF-8 without a mark; binary and too large files are not returned."""
    reader = reader_of(tmp_path, {"a.cpp": content})
    reader.limit_bytes = 1000
    read = reader.read("demo/a.cpp")
    assert (None if read is None else read.decode()) == text
    assert codes(reader.problems) == ([problem] if problem else [])


def test_problems_of_other_sources(tmp_path: Path) -> None:
    """A file of another source is read, and its problems are those of its own package."""
    for name in ("one", "two"):
        (tmp_path / name / "demo").mkdir(parents=True)
        (tmp_path / name / "demo" / "a.cpp").write_bytes("// käse".encode("latin-1"))
        (tmp_path / name / "demo" / "b.cpp").write_bytes(b"\x7fELF\0\0\1")
    sources = [scan(tmp_path / name, Repository(f"local/{name}", str(tmp_path / name))) for name in ("one", "two")]
    reader = Reader(Workspace(sources), sources[0], PackageFolder("demo", "demo", None, ()))
    reader.limit_bytes = 8
    for path in ("demo/a.cpp", "demo/b.cpp", "demo/gone.cpp"):
        reader.read(FilePath("local/two", path))
    assert reader.problems == ()
    assert reader.read(FilePath("local/two", "demo/a.cpp")) == "// käse".encode()


def test_missing_file(tmp_path: Path) -> None:
    """A missing file is a problem, not an exception."""
    reader = reader_of(tmp_path, {"a.cpp": "x"})
    (tmp_path / "demo" / "a.cpp").unlink()
    assert reader.read("demo/a.cpp") is None
    assert codes(reader.problems) == [("KG110", None)]


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads every file")
def test_unreadable_file(tmp_path: Path) -> None:
    """A file without read permission is a problem."""
    reader = reader_of(tmp_path, {"a.cpp": "x"})
    (tmp_path / "demo" / "a.cpp").chmod(0)
    assert reader.read("demo/a.cpp") is None
    assert codes(reader.problems) == [("KG110", None)]


def test_paths_out_of_the_source(tmp_path: Path) -> None:
    """Neither `..` nor a link nor an absolute path leads to a file outside the source."""
    (tmp_path / "secret").write_text("secret")
    root = tmp_path / "root"
    reader = reader_of(root, {"a.cpp": "x"})
    (root / "demo" / "link").symlink_to(tmp_path / "secret")
    for path in ("../secret", "demo/../../secret", "demo/link", str(tmp_path / "secret")):
        assert reader.read(path) is None
    assert {problem.code for problem in reader.problems} == {"KG110"}
    assert {mark for _, mark in reader.inputs} == {"KG110 the file is not inside of its source"}


def test_pipe_does_not_block(tmp_path: Path) -> None:
    """A pipe in place of a file is rejected at once."""
    reader = reader_of(tmp_path, {"a.cpp": "x"})
    (tmp_path / "demo" / "a.cpp").unlink()
    os.mkfifo(tmp_path / "demo" / "a.cpp")
    assert reader.read("demo/a.cpp") is None
    assert codes(reader.problems) == [("KG110", None)]


def test_unknown_source(tmp_path: Path) -> None:
    """A file of a source outside the build is a problem."""
    reader = reader_of(tmp_path, {})
    assert reader.read(FilePath("local/else", "x.cpp")) is None
    assert codes(reader.problems) == [("KG110", None)]


def test_problem_codes_are_checked(tmp_path: Path) -> None:
    """A problem must have a code of the catalogue; a repeated one is stored once."""
    reader = reader_of(tmp_path, {})
    reader.problem("KG115", "m", "a.cpp", 3)
    reader.problem("KG115", "m", "a.cpp", 3)
    assert codes(reader.problems) == [("KG115", 3)]
    with pytest.raises(LookupError):
        reader.problem("KG999", "m", "a.cpp")


@given(st.binary(max_size=300))
def test_any_bytes_come_out_as_utf8(data: bytes) -> None:
    """For any file, the returned content is UTF-8 or absent."""
    repository = Repository("local/x", "/")
    source = Source(repository, Path("/"), ())
    reader = Reader(Workspace([source]), source, PackageFolder("x", ".", None, ()))
    text = reader._normalise(FilePath("local/x", "a"), data)
    if text is None:
        assert b"\0" in data
    else:
        text.decode()
        assert bool(reader.problems) is (data.removeprefix(b"\xef\xbb\xbf") != text)
