from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from rules.authoring.worlds import write_rules

from kg.rules.authoring.library import Library
from kg.rules.authoring.starting import start
from kg.rules.authoring.testing import Result, parted, result_object, run_examples

if TYPE_CHECKING:
    from pathlib import Path

KNOWS = "CONSTRUCT { ?x :knows ?y } WHERE { ?x :met ?y }"


def result(folder: Path, examples: str, rule: str = KNOWS, **others: str) -> Result:
    """Return the result of one example of a rule."""
    write_rules(folder, knows=rule, **others)
    (folder / "f" / "knows.md").write_text(f"## One\n\n{examples}")
    library = Library([folder])
    (found,) = run_examples([library.entries["f/knows"]], library)
    return found


def blocks(**texts: str) -> str:
    """Return blocks of an example: `given`, `expect`, `exactly`, `expect_not`, `why`."""
    kinds = {"given": "turtle given", "expect": "turtle expect", "exactly": "turtle expect exactly"}
    kinds |= {"expect_not": "turtle expect-not", "why": "text why"}
    return "\n".join(f"```{kinds[kind]}\n{text}\n```\n" for kind, text in texts.items())


@pytest.mark.parametrize("notation", ["rq", "ttl", "srl"])
def test_a_new_rule_passes_its_examples(tmp_path: Path, notation: str) -> None:
    """The output of `kg rules new` runs unchanged, in any notation."""
    start("wiring/listens-to", tmp_path, notation)
    library = Library([tmp_path])
    results = list(run_examples(library.in_force, library))
    assert [one.passed for one in results] == [True, True]


def test_missing_and_unexpected_triples_are_told(tmp_path: Path) -> None:
    """A failure has the missing and the unexpected triples, as spelt in the example."""
    found = result(
        tmp_path, blocks(given=":a :met :b , :c .", expect=":a :knows :b , :d .", expect_not=":a :knows :c .")
    )
    assert not found.passed
    assert found.missing == ("ex:a ex:knows ex:d",)
    assert found.unexpected == ("ex:a ex:knows ex:c",)
    assert str(found.place) == f"{tmp_path}/f/knows.md:1"


def test_exactly_means_nothing_else(tmp_path: Path) -> None:
    """Triples missing from an exact block are unexpected; an empty one lists nothing."""
    assert result(tmp_path, blocks(given=":a :met :b .", exactly=":a :knows :b .")).passed
    assert result(tmp_path, blocks(given=":a :met :b , :c .", exactly=":a :knows :b .")).unexpected
    assert result(tmp_path, blocks(given=":a :met :b .", exactly="")).unexpected == ("ex:a ex:knows ex:b",)


def test_a_blank_node_stands_for_any_term_that_fits_all(tmp_path: Path) -> None:
    """One reading of the blank nodes must make the whole block true."""
    given = ":a :met :b . :c :met :d ."
    assert result(tmp_path, blocks(given=given, expect="_:x :knows [] .")).passed
    assert result(tmp_path, blocks(given=given, exactly="_:x :knows :b . _:y :knows :d .")).passed
    alone = result(tmp_path, blocks(given=given, expect="_:x :knows :b , :d ."))
    assert alone.missing == ("_:x ex:knows ex:b", "_:x ex:knows ex:d")
    assert result(tmp_path, blocks(given=given, expect="_:x :knows :e .")).missing == ("_:x ex:knows ex:e",)


def test_blank_nodes_made_by_a_rule_are_found(tmp_path: Path) -> None:
    """A rule that creates nodes is tested with blank nodes, too."""
    rule = "CONSTRUCT { [] :of ?x ; :with ?y } WHERE { ?x :met ?y }"
    given = ":a :met :b , :c ."
    assert result(tmp_path, blocks(given=given, exactly="_:m :of :a ; :with :b . _:n :of :a ; :with :c ."), rule).passed
    assert not result(tmp_path, blocks(given=given, expect="_:m :of :a ; :with :b , :c ."), rule).passed


def test_lines_of_proofs(tmp_path: Path) -> None:
    """Each line under `why` is part of a line of a proof; a failure shows the actual proof."""
    given, expect = ":a :met :b .", ":a :knows :b ."
    assert result(tmp_path, blocks(given=given, expect=expect, why=":a :met :b\nf/knows")).passed
    found = result(tmp_path, blocks(given=given, expect=expect, why="ex:a ex:saw ex:b"))
    assert [line.text for line in found.why_missing] == ["ex:a ex:saw ex:b"]
    assert found.proof == ("ex:a ex:knows ex:b  by rule f/knows with ?x = ex:a, ?y = ex:b", "  ex:a ex:met ex:b")


def test_only_the_rules_named_run(tmp_path: Path) -> None:
    """Other rules run only if the example names them, in full or by the last part of the name."""
    other = {"met": "CONSTRUCT { ?y :met ?x } WHERE { ?x :met ?y }"}
    page = "```turtle given{}\n:a :met :b .\n```\n```turtle expect\n:b :knows :a .\n```\n"
    assert not result(tmp_path, page.format(""), **other).passed
    assert result(tmp_path, page.format(" with=f/met"), **other).passed
    assert result(tmp_path, page.format(" with=met"), **other).passed
    wrong = result(tmp_path, page.format(" with=f/mett"), **other)
    assert wrong.error is not None
    assert (wrong.error.code, str(wrong.error.place)) == ("KG221", f"{tmp_path}/f/knows.md:3")
    assert wrong.error.hint == "Did you mean `f/met`, `met` or `f`?"


def test_a_rule_that_cannot_be_read_fails(tmp_path: Path) -> None:
    """Its error is in the result, and in JSON."""
    found = result(tmp_path, blocks(given=":a :met :b .", exactly=""), "CONSTRUCT { ?x :knows } WHERE { }")
    assert not found.passed
    assert result_object(found)["error"]["code"] == "KG201"
    assert found.error is not None


def test_a_rule_that_would_not_end_is_refused(tmp_path: Path) -> None:
    """KG204, as for a run without limits."""
    rule = "CONSTRUCT { [] :met ?x } WHERE { ?x :met ?y }"
    found = result(tmp_path, blocks(given=":a :met :b .", expect=":a :met :c ."), rule)
    assert found.error is not None
    assert found.error.code == "KG204"


def test_rules_without_examples_are_told_apart(tmp_path: Path) -> None:
    """They are not failures; the runner names them."""
    write_rules(tmp_path, knows=KNOWS, other=KNOWS)
    (tmp_path / "f" / "knows.md").write_text("## One\n")
    library = Library([tmp_path])
    with_examples, without = parted(library.entries.values())
    assert ([one.name for one in with_examples], [one.name for one in without]) == (["f/knows"], ["f/other"])
    (found,) = run_examples(with_examples, library)
    assert found.error is not None
    assert found.error.code == "KG221"


def test_a_rule_that_cannot_be_read_fails_without_examples(tmp_path: Path) -> None:
    """A rule with a syntax error never passes; a valid one without examples gives no result."""
    write_rules(tmp_path, knows=KNOWS, broken="CONSTRUCT { ?x nobody:knows ?y } WHERE { ?x :met ?y }")
    library = Library([tmp_path])
    (found,) = run_examples(library.in_force, library)
    assert (found.rule, found.title, found.passed) == ("f/broken", "", False)
    assert found.error is not None
    assert (found.error.code, found.place.path) == ("KG201", f"{tmp_path}/f/broken.rq")
