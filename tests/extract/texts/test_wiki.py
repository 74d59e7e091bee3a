"""The wiki's documentation of nodes: nodes, their interfaces, and the lines of these."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.texts.pages import WikiEntry, WikiNode, is_wiki, moin_markdown, wiki_nodes

HEAD = "{{{\n#!clearsilver CS/NodeAPI\n"

TWO_NODES = (
    HEAD
    + """node.0 {
  name = driver
  desc = Drives the motors.
  sub {
    0.name = cmd_vel
    0.type = geometry_msgs/Twist
    0.desc = Where to go.
  }
  srv {
    0{
      name = reset
      type = std_srvs/Empty
    }
  }
  param {
    group.0 {
      name = Motors
      0.name = ~rate
      0.type = double
      0.default = 10.0
    }
  }
}
node.1.name = reader
node.1.pub.0.name = odom
}}}
"""
)


def test_nodes_of_a_block() -> None:
    """A block of several nodes gives each with its own entries, and the line of each name."""
    first, second = wiki_nodes(TWO_NODES)
    assert first == WikiNode(
        "driver",
        "Drives the motors.",
        4,
        (
            WikiEntry("subscribes", "cmd_vel", "geometry_msgs/Twist", "Where to go.", 7),
            WikiEntry("services", "reset", "std_srvs/Empty", None, 13),
            WikiEntry("parameters", "~rate", "double", None, 20, "10.0"),
        ),
    )
    assert second == WikiNode("reader", None, 26, (WikiEntry("publishes", "odom", None, None, 27),))


def test_a_block_of_one_node() -> None:
    """A block without `node.0` is about one node; values may be on the lines of their braces."""
    (found,) = wiki_nodes(HEAD + "name = joy\npub { 0.name = joy }\nact { 0.name = go }\n}}}\n")
    assert (found.name, [(one.kind, one.name) for one in found.entries]) == (
        "joy",
        [("publishes", "joy"), ("action_servers", "go")],
    )


def test_long_values_and_transforms() -> None:
    """A value may span lines to its end mark; transforms are named by their two frames."""
    (found,) = wiki_nodes(HEAD + "desc << END\nTwo\nlines.\nEND\nprov_tf{\n0.from = odom\n0.to = base\n}\n}}}\n")
    assert found.description == "Two lines."
    assert found.entries == (WikiEntry("provided_transforms", "odom -> base", None, None, 8),)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "no block",
        HEAD,
        HEAD + "}}}}\n}",
        HEAD + "name =\n",
        HEAD + "x << END\n",
        HEAD + "a {" * 200,
        HEAD + "{\n}\n=",
    ],
)
def test_malformed_blocks_give_nothing(text: str) -> None:
    """A block that is empty, unclosed or malformed gives no node."""
    assert wiki_nodes(text) == ()


@given(st.lists(st.sampled_from(["node.0 {", "}", "name = a", "pub {", "0.name = x", "0 {", "desc << E", "E", "{"])))
def test_any_block_is_read(lines: list[str]) -> None:
    """A block with its lines in any order is read, and each entry has a line of the text."""
    text = HEAD + "\n".join(lines)
    for node in wiki_nodes(text):
        assert all(2 < entry.line <= len(lines) + 2 for entry in node.entries)


def test_pages_become_markdown() -> None:
    """Headings, links, macros and code of MoinMoin become Markdown on the same lines."""
    page = "<<TOC(4)>>\n== Nodes ==\n{{{\ncode\n}}}\nSee [[http://x|the page]], {{{a}}} and ''b'' <<MsgLink(p/M)>>."
    assert moin_markdown(page).split("\n") == ["", "## Nodes", "```", "", "```", "See the page, `a` and *b* p/M."]


def test_what_a_wiki_page_is() -> None:
    """A page belongs to the wiki if it has its macros or blocks."""
    assert is_wiki("<<PackageHeader(x)>>")
    assert is_wiki("{{{\n#!clearsilver CS/NodeAPI\n}}}")
    assert not is_wiki("# A page of Markdown")
