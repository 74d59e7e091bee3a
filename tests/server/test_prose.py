"""Texts of rules as HTML."""

from __future__ import annotations

import re
from html import unescape

from hypothesis import given
from hypothesis import strategies as st
from markupsafe import escape

from kg.resources import folder
from kg.server.addresses import url
from kg.server.prose import breakable, prose, source
from kg.server.rendering import environment

_MARKUP = re.compile(r'</?(?:p|ul|li|code)>|<pre tabindex="0">|</pre>')
_SPAN = re.compile(r'<span (?:id="L\d+"|class="tok-\w+")>|</span>')


def test_paragraphs_lists_and_code() -> None:
    """Lines join to paragraphs, items to lists; indented text is preserved; backticks are code."""
    found = prose("One `rnkg:feeds`\ntwo.\n\n- first\n  goes on\n- second\n\n    kg rules\n")
    assert found == (
        "<p>One <code>rnkg:feeds</code> two.</p>\n<ul><li>first goes on</li><li>second</li></ul>\n"
        '<pre tabindex="0">kg rules</pre>'
    )


def test_tokens_of_a_rule() -> None:
    """Lines are numbered; keywords, variables, names and comments are marked; `#` in an IRI starts no comment."""
    found = source("# Title\nPREFIX x: <http://x.example/ns#>\nCONSTRUCT { ?a x:b 1 }")
    assert '<span id="L1"><span class="tok-comment"># Title</span>' in found
    assert '<span class="tok-iri">&lt;http://x.example/ns#&gt;</span>' in found
    assert '<span class="tok-variable">?a</span>' in found
    assert '<span id="L3"><span class="tok-keyword">CONSTRUCT</span>' in found


def test_every_shipped_rule_stays_as_it_is() -> None:
    """The displayed text equals the text of the file, line for line."""
    for path in sorted(folder("rules").rglob("*.rq")):
        text = path.read_text("utf-8").rstrip("\n")
        assert unescape(_SPAN.sub("", source(text))) == text + "\n", path


@given(st.text())
def test_no_text_becomes_markup(text: str) -> None:
    """For any text, the output contains only our own elements."""
    assert "<" not in _MARKUP.sub("", prose(text))
    assert "<" not in _SPAN.sub("", source(text))
    assert breakable(text).replace("<wbr>", "") == escape(text)


def test_names_break_between_their_parts() -> None:
    """Lines may break after `/` and `_`, and between joined words; the text is unchanged."""
    assert breakable("sensor_msgs/PointCloud2") == "sensor_<wbr>msgs/<wbr>Point<wbr>Cloud2"
    assert breakable("src/a__b.cpp") == "src/<wbr>a__<wbr>b.cpp"


def test_code_breaks_between_its_tokens() -> None:
    """Lines of code may break after `::`, brackets and commas."""
    assert breakable("std::pair<a,b>(c)") == "std::<wbr>pair&lt;<wbr>a,<wbr>b&gt;(<wbr>c)"


def test_addresses() -> None:
    """Parameters are quoted, empty ones omitted; only web and editor addresses become links."""
    assert url("/search", q="a b&c", package="", limit=None) == "/search?q=a+b%26c"
    href = environment().filters["href"]
    assert href("https://a.example/") == "https://a.example/"
    assert [href(one) for one in ("javascript:alert(1)", "JAVASCRIPT:x", "data:text/html,x", "//a", "", None)] == [
        ""
    ] * 6
