"""The language server in a session of an editor: rules."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from editors.client import editing

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from editors.client import Editor

pytest.importorskip("pygls", reason="the extra `lsp` is not installed")

RULE = """\
# Busy nodes
CONSTRUCT { ?node my:busy true }
WHERE { ?node rnkg:publishes ?topic ; rnkg:subscribs ?topic . ?nod a foaf:Agent }
"""
DECLARED = RULE.replace("CONSTRUCT", "PREFIX my: <https://example.org/my#>\nCONSTRUCT")
KNOWN = DECLARED.replace("a foaf:Agent", "my:on 1")
SMALL = "CONSTRUCT { ?a a ?b } WHERE { ?a a ?b FILTER(REGEX(?b, '')) }"
SHACL = "@prefix sh: <http://www.w3.org/ns/shacl#> .\n"
SHAPES = """\
# Idle nodes
@prefix sh: <http://www.w3.org/ns/shacl#> .
@prefix my: <https://example.org/my#> .

my:Idle a sh:NodeShape ; sh:targetClass my:Node ; sh:rule [
    a sh:SPARQLRule ;
    sh:prefixes [ sh:declare [ sh:prefix "mine" ; sh:namespace "https://example.org/my#" ] ] ;
    sh:construct "CONSTRUCT { $this mine:idle ?value } WHERE { $this mine:busy ?value }" ;
  ] .
"""
EXAMPLES = """\
# Busy nodes

## One

```turtle expect
@prefix m: <https://example.org/my#> .
:a m:busy true .
```
"""
SHARED = """\
# Shared
PREFIX my: <https://example.org/my#>
RULE { ?a my:works 1 } WHERE { ?a my:on 1 }
"""
SET = """\
# Two rules
PREFIX my: <https://example.org/my#>
IMPORTS <shared.srl>
RULE { ?a my:busy ?b } WHERE { ?a my:works ?b }
RULE { ?a my:free ?b } WHERE { ?a my:busy ?b FILTER(?b) }
"""


@pytest.fixture(name="folder", scope="module")
def make_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a workspace with rules of the three notations, a page of examples and an allowed finding."""
    folder = tmp_path_factory.mktemp("rules")
    mine = folder / "rules" / "mine"
    mine.mkdir(parents=True)
    (mine / "busy.rq").write_text(DECLARED)
    (mine / "busy.md").write_text(
        "# Busy\n\n## One\n\n```turtle expect\n@prefix m: <https://example.org/my#> .\n:a m:busy true .\n```\n"
    )
    (mine / "idle.ttl").write_text(SHAPES)
    (mine / "sets.srl").write_text(SET)
    (mine / "shared.srl").write_text(SHARED)
    (folder / "kg.toml").write_text('[[lint.allow]]\ncode = "KG401"\nrule = "mine/busy"\nreason = "known"\n')
    return folder


@pytest.fixture(name="editor", scope="module")
def make_editor(folder: Path) -> Iterator[Editor]:
    """Return an editor with the workspace open."""
    with editing(folder) as editor:
        yield editor


@pytest.fixture(autouse=True)
def close_documents(editor: Editor) -> Iterator[None]:
    """Close what a test opened: its text would be that of the file for other tests."""
    yield
    editor.close()


def test_a_session(editor: Editor, folder: Path) -> None:
    """Opening reports errors; editing fixes them; completion, hover and definition respond."""
    file = folder / "rules/mine/busy.rq"
    editor.open(file, DECLARED.replace(". ?nod a foaf:Agent ", ""))
    found = {each["code"]: each for each in editor.diagnostics(file, until=bool)}
    assert found["KG211"]["range"]["start"] == {"line": 3, "character": 38}
    assert "rnkg:subscribes" in found["KG211"]["message"]
    editor.edit(file, editor.texts[file.as_uri()].replace("subscribs", "subscribes"))
    assert "rnkg:subscribs" not in json.dumps(editor.diagnostics(file))
    items = editor.at("completion", file, "publishes ?topic")
    labels = [each["label"] for each in (items if isinstance(items, list) else items["items"])]
    assert "rnkg:publishes" in labels
    assert "publishes" in editor.at("hover", file, "publishes ?topic")["contents"]["value"]
    assert editor.at("definition", file, "publishes ?topic")["uri"].endswith("ontology/rnkg.ttl")


def fixed(editor: Editor, file: Path, text: str, title: str) -> str:
    """Return the text after applying the quick fix with a title."""
    editor.open(file, text)
    found = [
        fixes[title] for each in editor.diagnostics(file, until=bool) if title in (fixes := editor.fixes(file, each))
    ]
    assert len(found) == 1, title
    return editor.applied(found[0])[0][file]


@pytest.mark.parametrize(
    ("name", "text", "title", "wrong", "right"),
    [
        ("busy.rq", RULE, "Declare `foaf:`", "nodes\n", "nodes\nPREFIX foaf: <http://xmlns.com/foaf/0.1/>\n"),
        ("busy.rq", KNOWN, "Replace `rnkg:subscribs` by `rnkg:subscribes`", "subscribs", "subscribes"),
        ("busy.rq", KNOWN, "Replace `?nod` by `?node`", "?nod my", "?node my"),
        ("busy.rq", KNOWN, "Replace `?nod` by `[]`", "?nod my", "[] my"),
        ("busy.rq", SMALL.replace("WHERE", "WERE"), "Replace `WERE` by `WHERE`", "WERE", "WHERE"),
        ("busy.rq", f"# T\n#\n# severity: eror\n{SMALL}", "Replace `eror` by `error`", "eror", "error"),
        ("busy.rq", SMALL.replace("REGEX", "REGX"), "Replace `REGX` by `REGEX`", "REGX", "REGEX"),
        ("sets.srl", SET.replace("RULE {", "CONSTRUCT {", 1), "Replace `CONSTRUCT` by `RULE`", "CONSTRUCT", "RULE"),
        ("sets.srl", SET.replace("FILTER(?b)", "FILTER(?bb)"), "Replace `?bb` by `?b`", "?bb", "?b"),
        ("idle.ttl", SHAPES.replace("tClass", "tCls"), "Replace `sh:targetCls` by `sh:targetClass`", "Cls ", "Class "),
        ("idle.ttl", SHAPES.replace("this mine:i", "this min:i"), "Replace `min:idle` by `mine:idle`", "min:", "mine:"),
        ("idle.ttl", SHAPES.replace(SHACL, ""), "Declare `sh:`", "my#> .\n", f"my#> .\n{SHACL}"),
    ],
)  # fmt: skip
def test_quick_fixes(  # noqa: PLR0913, PLR0917 - the columns of a table
    editor: Editor, folder: Path, name: str, text: str, title: str, wrong: str, right: str
) -> None:
    """Each hint with a replacement has a quick fix that applies it."""
    assert fixed(editor, folder / "rules/mine" / name, text, title) == text.replace(wrong, right, 1)


def test_a_fix_counts_as_the_editor_does(editor: Editor, folder: Path) -> None:
    """After a character of two UTF-16 units, ranges count both."""
    file = folder / "rules/mine/busy.rq"
    editor.open(file, "CONSTRUCT { ?a a ?b } WHERE { ?a a '\U0001f916', ?b FILTER(REGX(?b, '')) }")
    (found,) = editor.diagnostics(file, until=bool)
    start = found["range"]["start"]["character"]
    assert editor.texts[file.as_uri()].encode("utf-16-le")[2 * start :].decode("utf-16-le").startswith("REGX")


def spots(locations: list[dict[str, Any]]) -> list[str]:
    """Return locations as `file:line`, sorted."""
    return sorted(f"{each['uri'].rpartition('/')[2]}:{each['range']['start']['line'] + 1}" for each in locations)


@pytest.mark.parametrize(
    ("name", "needle", "expected"),
    [
        ("busy.rq", "?topic ;", ["busy.rq:4", "busy.rq:4"]),
        ("sets.srl", "?b } WHERE { ?a my:busy", ["sets.srl:5", "sets.srl:5", "sets.srl:5"]),
        ("idle.ttl", "?value }", ["idle.ttl:8", "idle.ttl:8"]),
        ("busy.rq", "busy true", ["busy.md:7", "busy.rq:3", "idle.ttl:8", "sets.srl:4", "sets.srl:5"]),
        ("idle.ttl", 'mine"', ["idle.ttl:7", "idle.ttl:8", "idle.ttl:8"]),
        ("idle.ttl", "my:Idle", ["idle.ttl:3", "idle.ttl:5", "idle.ttl:5"]),
        ("busy.rq", "Busy nodes", ["busy.rq:1", "kg.toml:3"]),
        ("sets.srl", "shared.srl", []),
    ],
)  # fmt: skip
def test_references(editor: Editor, folder: Path, name: str, needle: str, expected: list[str]) -> None:
    """A variable has the places of its rule, a prefix those of its file, a term and a rule those of all files."""
    file = folder / "rules/mine" / name
    editor.open(file)
    assert spots(editor.at("references", file, needle, context={"includeDeclaration": True})) == expected


@pytest.mark.parametrize(
    ("needle", "new", "changes"),
    [
        ("?topic ;", "?channel", {"busy.rq": ("?topic", "?channel")}),
        ("my:busy", "own:", {"busy.rq": ("my:", "own:")}),
        ("mine:idle", "own", {"idle.ttl": ("mine", "own")}),
        ("busy true", "occupied", {
            "busy.rq": ("my:busy", "my:occupied"),
            "busy.md": ("m:busy", "m:occupied"),
            "sets.srl": ("my:busy", "my:occupied"),
            "idle.ttl": ("mine:busy", "mine:occupied"),
        }),
    ],
)  # fmt: skip
def test_renaming(editor: Editor, folder: Path, needle: str, new: str, changes: dict[str, tuple[str, str]]) -> None:
    """Renaming changes exactly the references to the same symbol."""
    file = folder / "rules/mine" / next(iter(changes))
    editor.open(file)
    texts, moved = editor.applied(editor.at("rename", file, needle, newName=new))
    before = {each.name: each.read_text() for each in texts}
    assert {each.name: text for each, text in texts.items()} == {
        each: before[each].replace(*change) for each, change in changes.items()
    }
    assert not moved


def test_renaming_a_rule_moves_its_files(editor: Editor, folder: Path) -> None:
    """A rule's file and its examples get the new name, and so does kg.toml."""
    mine, file = folder / "rules/mine", folder / "rules/mine/busy.rq"
    editor.open(file)
    assert editor.at("prepareRename", file, "Busy nodes")["placeholder"] == "mine/busy"
    texts, moved = editor.applied(editor.at("rename", file, "Busy nodes", newName="work/occupied"))
    target = folder / "rules/work/occupied.rq"
    assert moved == {file: target, mine / "busy.md": target.with_suffix(".md")}
    assert 'rule = "work/occupied"' in texts[folder / "kg.toml"]


def test_renaming_an_imported_rule_set(editor: Editor, folder: Path) -> None:
    """The importing rule set refers to the new file."""
    file = folder / "rules/mine/shared.srl"
    editor.open(file)
    texts, _ = editor.applied(editor.at("rename", file, "Shared", newName="common/shared"))
    assert "IMPORTS <../common/shared.srl>" in texts[folder / "rules/mine/sets.srl"]


@pytest.mark.parametrize(
    ("name", "needle", "new", "why"),
    [
        ("busy.rq", "?topic ;", "node", "there is a variable `node` already"),
        ("busy.rq", "?topic ;", "a b", "`a b` is not the name of a variable"),
        ("busy.rq", "rnkg:publishes", "r", "does not declare the prefix `rnkg:`"),
        ("busy.rq", "publishes", "sends", "which is not part of your rules"),
        ("busy.rq", "busy true", "works", "there is a term"),
        ("idle.ttl", "this mine:idle", "it", "SHACL gives $this its value"),
        ("busy.rq", "Busy nodes", "busy", "Write FAMILY/NAME"),
        ("busy.rq", "Busy nodes", "mine/idle", "there is a rule `mine/idle` already"),
    ],
)  # fmt: skip
def test_renaming_is_refused(  # noqa: PLR0913, PLR0917 - the columns of a table
    editor: Editor, folder: Path, name: str, needle: str, new: str, why: str
) -> None:
    """A taken or malformed name, and names of others, are rejected with the reason."""
    file = folder / "rules/mine" / name
    editor.open(file)
    response = editor.request("textDocument/rename", **editor.place(file, needle), newName=new)
    assert why in response["error"]["message"]
