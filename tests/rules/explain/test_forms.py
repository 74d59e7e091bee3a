"""Explanations as text, JSON, Mermaid and pictures."""

from __future__ import annotations

import json
from xml.etree import ElementTree as ET

from rules.explain.worlds import World, fact, rule, without

from kg.rules.explain.text import mermaid, picture, proof_lines, proof_object, why_not_lines, why_not_object
from kg.rules.explain.why import why
from kg.rules.explain.why_not import why_not

RULES = (
    rule("family/parent", "?x ancestor ?y", "?x parent ?y"),
    rule("family/linear", "?x ancestor ?z", "?x ancestor ?y", "?y parent ?z", without("?z parent ?x")),
)
DATA = """
    :a rdfs:label "Ann" ; :parent :b ; :path "a.cpp" ; :line 3 .
    :b rdfs:label "Bo" ; :parent :c .
    :c rdfs:label "<Cy>" .
"""
WORLD = World(DATA, RULES)
PROOF = why(WORLD.view, RULES, fact("a ancestor c"))

TEXT = """\
Ann <https://example.org/ancestor> <Cy>
│ by rule family/linear  rules/family/linear.rq:7
│ with ?x = Ann, ?y = Bo, ?z = <Cy>
├─ Ann <https://example.org/ancestor> Bo
│  │ by rule family/parent  rules/family/parent.rq:7
│  │ with ?x = Ann, ?y = Bo
│  └─ Ann <https://example.org/parent> Bo  a.cpp:3
├─ Bo <https://example.org/parent> <Cy>
└─ FILTER NOT EXISTS { ?z <https://example.org/parent> ?x . }
"""


def test_text() -> None:
    """The tree has rule and line, bindings, and the line of code of each asserted fact."""
    assert "".join(f"{line}\n" for line in proof_lines(PROOF, WORLD.view)) == TEXT


def test_json() -> None:
    """Each fact appears once; premises refer to it by number."""
    found = proof_object(PROOF, WORLD.view)
    assert json.loads(json.dumps(found)) == found
    facts = found["facts"]
    assert isinstance(facts, list)
    assert facts[0]["premises"] == [1, 3]
    assert [(each["file"], each["line"]) for each in facts if "file" in each] == [("a.cpp", 3), (None, None)]


def test_mermaid() -> None:
    """Facts are boxes and rules the labels of arrows; HTML characters are escaped."""
    text = mermaid([PROOF], WORLD.view)
    assert 'p0f1 -->|"family/linear"| p0f0' in text
    assert "&lt;Cy&gt;" in text


def test_picture() -> None:
    """The picture is well-formed, has every line of the text, and is deterministic."""
    svg = picture([PROOF], WORLD.view)
    words = " ".join(ET.fromstring(svg).itertext())  # noqa: S314 - our own
    assert all(part in words for part in ("by rule family/linear", "a.cpp:3", "FILTER NOT EXISTS"))
    assert svg == picture([PROOF], WORLD.view)


def test_why_not_as_text_and_json() -> None:
    """Missing facts are reported with the nearest match, in both forms."""
    answer = why_not(WORLD.view, RULES, fact("c ancestor a"))
    lines = [str(line) for line in why_not_lines(answer, WORLD.view)]
    assert lines[0] == "<Cy> <https://example.org/ancestor> Ann: not derived"
    assert any("fails: no <Cy> <https://example.org/parent> Ann" in line for line in lines)
    found = why_not_object(answer, WORLD.view)
    assert json.loads(json.dumps(found)) == found
