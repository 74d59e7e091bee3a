from __future__ import annotations

import json

from kg.render.sarif import Remark, Spot, annotation, document


def test_a_remark_is_one_line_for_github() -> None:
    """Line ends, percent signs, and in places colons and commas are escaped, so no text starts another command."""
    remark = Remark("KG401", "note", "50%\n::error::x", Spot("a,b:c.launch", 3))
    assert annotation(remark) == "::notice file=a%2Cb%3Ac.launch,line=3,col=1,title=KG401::50%25%0A::error::x"


def test_codes_that_are_not_in_the_catalogue() -> None:
    """User rules may have codes of their own."""
    content = document([Remark("X1", "error", "bad", Spot("a.launch"))])
    (run,) = json.loads(json.dumps(content))["runs"]
    assert run["tool"]["driver"]["rules"] == [{"id": "X1", "shortDescription": {"text": "X1"}}]
    assert run["results"][0]["locations"][0]["physicalLocation"]["region"] == {"startLine": 1}


def test_a_remark_names_the_lines_that_have_to_do_with_it() -> None:
    """GitHub shows a remark at a single line, so the text lists the others."""
    related = (Spot("src/patrol.py", 38, words="subscribes /battery"), Spot("src/x.cpp"))
    remark = Remark("KG403", "error", "types clash", Spot("a.launch", 3), related)
    text = "types clash%0Asrc/patrol.py:38 subscribes /battery%0Asrc/x.cpp:1"
    assert annotation(remark) == f"::error file=a.launch,line=3,col=1,title=KG403::{text}"
