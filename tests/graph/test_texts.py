from __future__ import annotations

from graph.samples import ROVER, rows, sample, true
from hypothesis import given
from hypothesis import strategies as st

from kg.graph.texts import terms

NODE = f"<node/{ROVER}/rover_base/driver>"
PACKAGE = f"<package/{ROVER}/rover_base>"


def test_a_description_belongs_to_its_node_with_words_phrases_and_place() -> None:
    """Text, kind, words and phrases of a comment belong to the described node, with file and line."""
    assert true(
        sample(),
        f"""{NODE} rnkg:hasDescription ?text .
        ?text a rnkg:Description ; rnkg:descriptionKind "comment" ;
          rnkg:text "Drives the wheels of the rover by its motor controllers." ;
          rnkg:descriptionWord "drive", "wheel" ; rnkg:hasPhrase <phrase/motor%20controller> ;
          rnkg:path "rover_base/src/main.cpp" ; rnkg:line 10 .""",
    )


def test_a_description_without_a_node_belongs_to_the_package() -> None:
    """A paragraph of a README about no specific node is about the package, below its heading."""
    assert true(
        sample(),
        f"""{PACKAGE} rnkg:hasDescription ?text .
        ?text rnkg:heading "Rover" ; rnkg:path "README.md" ; rnkg:line 3 .""",
    )


def test_a_phrase_has_each_run_of_its_words() -> None:
    """Rules compare labels of devices with parts of phrases, so the parts are stored."""
    query = 'SELECT ?term { ?phrase a rnkg:Phrase ; rnkg:text "motor controller" ; rnkg:term ?term }'
    assert {row[0] for row in rows(sample(), query)} == {"motor", "controller", "motor controller"}


@given(st.lists(st.sampled_from("abc"), max_size=7))
def test_terms_are_the_runs_of_one_to_four_words(words: list[str]) -> None:
    """Each term is a part of the phrase, all parts are included, and none is repeated."""
    found = list(terms(" ".join(words)))
    runs = {" ".join(words[i:j]) for i in range(len(words)) for j in range(i + 1, min(i + 4, len(words)) + 1)}
    assert set(found) == runs
    assert len(found) == len(runs)
