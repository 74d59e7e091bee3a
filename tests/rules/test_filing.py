from __future__ import annotations

from pathlib import Path

import pytest
from pyoxigraph import NamedNode

from kg.errors import GraphError, Place, SourceError, UsageError
from kg.rules.files import Documentation, RuleFile, RuleSet
from kg.rules.form import Atom, Rule, Variable
from kg.rules.running import run_files

X, P, Y = (Variable(name) for name in "xpy")


def copies() -> RuleSet:
    """Return one rule that copies `urn:p` to `urn:copy`."""
    rule = Rule("test/copy", (Atom(X, NamedNode("urn:copy"), Y),), (Atom(X, NamedNode("urn:p"), Y),), Place("a.rq", 1))
    return RuleSet((RuleFile("test/copy", Path("a.rq"), "", Documentation(), (rule,)),))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ""),
        ("<urn:a> <urn:p> <urn:b> .\n<urn:a> <urn:q> <urn:b> .\n", "<urn:a> <urn:copy> <urn:b> .\n"),
        ('<urn:a> <urn:p> "x> <y .\\n" .\n', '<urn:a> <urn:copy> "x> <y .\\n" .\n'),
        ('<urn:a> <urn:p> "a\\"b"@en .\n', '<urn:a> <urn:copy> "a\\"b"@en .\n'),
        ("# note\n<urn:a>\t<urn:p>  <urn:b>.", "<urn:a> <urn:copy> <urn:b> .\n"),
        ('_:x <urn:p> "\\u0041" .\n', '_:x <urn:copy> "A" .\n'),
        ('<urn:a> <urn:p> <<( <urn:a> <urn:p> "1" )>> .\n', '<urn:a> <urn:copy> <<( <urn:a> <urn:p> "1" )>> .\n'),
    ],
)
def test_files_give_what_follows_from_them(tmp_path: Path, text: str, expected: str) -> None:
    """Plain lines are cut where their terms meet; whatever is less plain is parsed."""
    source, output = tmp_path / "in.nt", tmp_path / "out.nt"
    source.write_text(text)
    report = run_files([source], output, copies())
    assert output.read_text() == expected
    assert report.inferred == report.added == expected.count("\n")


def test_files_that_are_not_valid_are_refused_with_the_line(tmp_path: Path) -> None:
    """KG601 names the line; nothing is written."""
    source, output = tmp_path / "in.nt", tmp_path / "out.nt"
    source.write_text("<urn:a> <urn:p> <urn:b> .\n<urn:a> <urn:p> <urn b> .\n")
    with pytest.raises(GraphError) as caught:
        run_files([source], output, copies())
    assert caught.value.code == "KG601"
    assert caught.value.place is not None
    assert caught.value.place.line == 2
    assert not output.exists()


def test_files_that_cannot_be_opened_are_named(tmp_path: Path) -> None:
    """KG101 names the file."""
    with pytest.raises(SourceError) as caught:
        run_files([tmp_path / "missing.nt"], None, copies())
    assert caught.value.code == "KG101"


def test_the_ending_names_the_format(tmp_path: Path) -> None:
    """Turtle and TriG are read as such, relative names against the file; an unknown ending is refused."""
    text = "@prefix u: <urn:> . u:a u:p u:b , <#here> ."
    for name in ("in.ttl", "in.trig"):
        (tmp_path / name).write_text(text)
        assert run_files([tmp_path / name], None, copies()).inferred == 2
    (tmp_path / "in.csv").write_text(text)
    with pytest.raises(UsageError, match="names no format"):
        run_files([tmp_path / "in.csv"], None, copies())
