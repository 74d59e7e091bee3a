from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pyoxigraph import NamedNode, Triple

from kg.errors import RuleError
from kg.resources import folder
from kg.rules.authoring.examples import parse_examples, read_examples

if TYPE_CHECKING:
    from pathlib import Path

PAGE = """\
# Nodes

Prose.

## One

```turtle given with=family/other,family/third
@prefix z: <urn:z:> .
:a rnkg:publishes z:b .
```

```turtle given
ex:c ex:d "e" .
```

```turtle expect
:a z:f :g .
```

```text why
family/other

ex:a   z:f
```

```turtle expect-not
:a z:f :h .
```

## Background

No example.

## Two

```turtle expect exactly
```
"""


def triple(*names: str) -> Triple:
    """Return a triple of names."""
    return Triple(*map(NamedNode, names))


def refusal(text: str) -> RuleError:
    """Return the error raised for a page."""
    with pytest.raises(RuleError) as caught:
        parse_examples(text, "page.md")
    return caught.value


def test_an_example_has_its_blocks() -> None:
    """Given data is merged from all blocks; expectations keep their kind; prefixes apply from their line on."""
    one, two = parse_examples(PAGE, "page.md")
    assert (one.title, str(one.place)) == ("One", "page.md:5")
    assert one.given[0] == triple("https://example.org/a", "https://w3id.org/rnkg/ns#publishes", "urn:z:b")
    assert len(one.given) == 2
    assert [(name, str(place)) for name, place in one.others] == [
        ("family/other", "page.md:7"),
        ("family/third", "page.md:7"),
    ]
    assert [(each.kind, str(each.place)) for each in one.expectations] == [
        ("expect", "page.md:16"),
        ("not", "page.md:26"),
    ]
    assert one.expected == (triple("https://example.org/a", "urn:z:f", "https://example.org/g"),)
    assert [(line.text, str(line.place)) for line in one.why] == [
        ("family/other", "page.md:21"),
        ("ex:a z:f", "page.md:23"),
    ]
    assert (two.title, two.given, two.expectations[0].kind) == ("Two", (), "exactly")


def test_blocks_for_readers_are_left_alone() -> None:
    """A block that is neither Turtle nor text, or has only a language, is not part of an example."""
    page = "```turtle\nnot Turtle\n```\n```sparql given\n```\n## A\n```text\nx\n```\n```turtle expect exactly\n```\n"
    assert [one.title for one in parse_examples(page, "page.md")] == ["A"]


@pytest.mark.parametrize(
    ("page", "place", "message", "hint"),
    [
        ("## A\n```turtle given\n:a :b .\n```\n", "page.md:3:7", "not Turtle", "Correct"),
        ("## A\n```turtle given\n\n:a zz:b :c .\n```\n", "page.md:4:4", "zz:", "Correct"),
        ("## A\n```turtle gvien\n```\n", "page.md:2", "`turtle gvien`", "Did you mean `given`?"),
        ("## A\n```turtle given\n:a :b :c .\n```\n", "page.md:1", "expects nothing", "turtle expect"),
        ("## A\n```turtle given\n:a :b :c .\n", "page.md:2", "not closed", "backticks"),
        ("```turtle expect\n:a :b :c .\n```", "page.md:1", "not below the heading of an example", "## TITLE"),
        ("## A\n```turtle expect\n```\n", "page.md:2", "no triples", "expect exactly"),
        ("## A\n```turtle expect perhaps\n:a :b :c .\n```\n", "page.md:2", "`perhaps`", "expect exactly"),
        ("## A\n```turtle given wiht=a/b\n:a :b :c .\n```\n", "page.md:2", "`wiht=a/b`", "with="),
        (
            "## A\n```turtle given\n:a :b :c .\n```\n```turtle expect\n:a :b :c .\n```\n",
            "page.md:5",
            "`ex:a ex:b ex:c` is given and expected",
            "one of the two",
        ),
    ],
)
def test_what_is_no_example_is_refused_at_its_line(page: str, place: str, message: str, hint: str) -> None:
    """KG221 has the line of the block, or the place in it, and instructions."""
    error = refusal(page)
    assert (error.code, str(error.place)) == ("KG221", place)
    assert message in error.message
    assert hint in (error.hint or "")


def test_a_page_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    """A binary file named as Markdown is KG221 with the file."""
    path = tmp_path / "x.md"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(RuleError, match="KG221") as caught:
        read_examples(path)
    assert str(caught.value.place) == str(path)


@pytest.mark.parametrize(
    "page", sorted(folder("rules").rglob("*.md")), ids=lambda page: f"{page.parent.name}/{page.stem}"
)
def test_our_own_pages_are_examples(page: Path) -> None:
    """Every page next to a rule has at least one example."""
    assert read_examples(page)
