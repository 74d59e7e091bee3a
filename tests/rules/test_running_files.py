from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import NamedNode

from kg.errors import GraphError, Place, SourceError, UsageError
from kg.rules.files import Documentation, RuleFile, RuleSet
from kg.rules.form import Atom, Rule, Variable
from kg.rules.recording import Names
from kg.rules.running import Runner, run_files
from kg.store.embedded import EmbeddedStore

NAMES = Names.of("http://example.org/", "http://example.org/ns#")
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
    """Plain lines are split at the ends of their terms; all others are parsed."""
    source, output = tmp_path / "in.nt", tmp_path / "out.nt"
    source.write_text(text)
    report = run_files([source], output, copies())
    assert output.read_text() == expected
    assert report.inferred == report.added == expected.count("\n")


def test_files_that_are_not_valid_are_refused_with_the_line(tmp_path: Path) -> None:
    """KG601 has the line; nothing is written."""
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
    """Turtle and TriG are parsed as such, with relative names based on the file; an unknown suffix is rejected."""
    text = "@prefix u: <urn:> . u:a u:p u:b , <#here> ."
    for name in ("in.ttl", "in.trig"):
        (tmp_path / name).write_text(text)
        assert run_files([tmp_path / name], None, copies()).inferred == 2
    (tmp_path / "in.csv").write_text(text)
    with pytest.raises(UsageError, match="names no format"):
        run_files([tmp_path / "in.csv"], None, copies())


numbers = st.sampled_from(["1", "01", "+1", "1.0", "1e0", "true", "P1D", "PT24H", "2020-01-01T00:00:00+00:00", "x"])
kinds = st.sampled_from(["integer", "byte", "decimal", "double", "boolean", "dateTime", "duration", "string"])
values = st.one_of(
    st.builds(lambda text, kind: f'"{text}"^^<http://www.w3.org/2001/XMLSchema#{kind}>', numbers, kinds),
    st.sampled_from(
        ['"a"@EN', '"a"@en', '"a"@en-GB', '"a"@en-gb', '"\x7f"', '"\u0001"', '<<( <urn:a> <urn:p> "01" )>>']
    ),
)
SAME = Rule(
    "test/same",
    (Atom(X, NamedNode("urn:same"), Y),),
    (Atom(X, NamedNode("urn:p"), Variable("v")), Atom(Y, NamedNode("urn:p"), Variable("v"))),
    Place("a.rq", 1),
)


@settings(max_examples=20, deadline=None)
@given(st.lists(values, min_size=1, max_size=6))
def test_a_rule_joins_the_same_values_over_files_and_in_a_store(objects: list[str]) -> None:
    """In files of any format, in a store, and after a patch, rules use the same terms as queries."""
    lines = [f"<urn:{number}> <urn:p> {one} .\n" for number, one in enumerate(objects)]
    rules = RuleSet((RuleFile("test/same", Path("a.rq"), "", Documentation(), (SAME,)),))
    with tempfile.TemporaryDirectory() as name:
        folder, output = Path(name), Path(name) / "out.nt"
        results = []
        for ending in (".nt", ".ttl"):
            (folder / f"in{ending}").write_text("".join(lines), encoding="utf-8")
            run_files([folder / f"in{ending}"], output, rules)
            results.append(set(output.read_text().splitlines()))
        store, graph = EmbeddedStore.create(folder / ".kg"), NamedNode("urn:g")
        for part in (lines[: len(lines) // 2], lines[len(lines) // 2 :]):
            with store.write("test") as transaction:
                transaction.append(graph, "".join(part).encode())
            Runner(NAMES, store.layout.cache).run(store, rules)
        with store.read() as snapshot:
            results.append(set(snapshot.content(NAMES.inferred).decode().splitlines()))
            query = "SELECT ?x ?y { GRAPH <urn:g> { ?x <urn:p> ?v . ?y <urn:p> ?v } }"
            rows: Any = snapshot.query(query)
            results.append({f"{row[0]} <urn:same> {row[1]} ." for row in rows})
        assert all(one == results[0] for one in results)


def test_files_share_no_blank_node(tmp_path: Path) -> None:
    """A single file keeps its labels; a label in several files is a node in each."""
    files = [tmp_path / "a.nt", tmp_path / "b.ttl"]
    for file in files:
        file.write_text("_:x <urn:p> <urn:b> .\n")
    assert run_files(files[:1], tmp_path / "out.nt", copies()).inferred == 1
    assert (tmp_path / "out.nt").read_text() == "_:x <urn:copy> <urn:b> .\n"
    assert run_files(files, None, copies()).inferred == 2
