from __future__ import annotations

import re
from typing import TYPE_CHECKING

from extract.cpp.packages import interfaces_of
from repository import ROOT

from kg.extract.cpp import nodes
from kg.facts import Role
from kg.symbolic.descriptions import merged

if TYPE_CHECKING:
    import pytest


def test_the_example_of_the_manual_is_in_force(monkeypatch: pytest.MonkeyPatch) -> None:
    """A wrapper that is not in the build creates what its description says, as docs/calls.md shows it."""
    page = (ROOT / "docs" / "calls.md").read_text(encoding="utf-8")
    found = re.search(r"```toml\n(.*?)```", page, re.DOTALL)
    assert found is not None
    source = (
        "#include <acme/publishers.hpp>\nclass A : public rclcpp::Node { public:\n"
        '  A() : Node("a") { acme::make_publisher<std_msgs::msg::String>(this, "status", 10); }\n};\n'
        "int main() { rclcpp::spin(std::make_shared<A>()); }\n"
    )
    assert interfaces_of(source) == []
    described = merged([found[1]])
    monkeypatch.setattr(nodes, "shipped", lambda: described)
    (end,) = interfaces_of(source)
    assert (end.role, end.name, end.type) == (Role.PUBLISHES, "status", "std_msgs/String")
