"""List parameters that are empty by default: interfaces created for each element belong to the node."""

from __future__ import annotations

import pytest
from extract.cpp.packages import interfaces_of

PUBLISH = "create_publisher<std_msgs::msg::String>(NAME, 1);"
DECLARED = [
    'std::vector<std::string> all = declare_parameter("names", std::vector<std::string>{});',
    'auto all = declare_parameter<std::vector<std::string>>("names", {});',
    'declare_parameter("names", std::vector<std::string>()); auto all = get_parameter("names").as_string_array();',
    'std::vector<std::string> all; declare_parameter("names", all); get_parameter("names", all);',
]
LOOPS = [
    f"for (const auto& one : all) {{ {PUBLISH} }}",
    f"for (size_t k = 0; k < all.size(); ++k) {{ auto one = all[k]; {PUBLISH} }}",
    f"for (unsigned k = 0; k != all.size(); k++) {{ auto one = all.at(k); {PUBLISH} }}",
    f"for (auto it = all.begin(); it != all.end(); ++it) {{ auto one = *it; {PUBLISH} }}",
    f"std::for_each(all.begin(), all.end(), [this](const std::string& one) {{ {PUBLISH} }});",
    f"if (all.empty()) return; for (auto one : all) {{ {PUBLISH} }}",
    f"if (!all.empty()) {{ for (auto one : all) {{ {PUBLISH} }} }}",
]


def ends(statements: str) -> list[tuple[str | None, str | None]]:
    """Return name and parameter of the interfaces created by a node with these statements."""
    source = (
        f'#include <rclcpp/rclcpp.hpp>\nclass Demo : public rclcpp::Node {{ public: Demo() : rclcpp::Node("demo") {{\n'
        f"{statements} }} }};\nint main(int argc, char** argv) {{ rclcpp::spin(std::make_shared<Demo>()); }}\n"
    )
    return [(one.name, one.parameter) for one in interfaces_of(source)]


@pytest.mark.parametrize("declared", DECLARED)
@pytest.mark.parametrize("loop", LOOPS)
def test_each_element_of_an_empty_list_names_an_interface(declared: str, loop: str) -> None:
    """A loop over a list set by a launch file runs, whatever the default."""
    assert ends(declared + loop.replace("NAME", "one")) == [(None, "names[]")]


def test_a_name_with_an_element_is_partly_known() -> None:
    """The rest of a name around the element is known."""
    assert ends(DECLARED[0] + LOOPS[0].replace("NAME", 'one + "/raw"')) == [("{names}/raw", "names[]")]


def test_what_the_loop_changes_may_also_stay_as_it_is() -> None:
    """The list may be empty: variables set in the loop may keep their values."""
    local = DECLARED[0] + 'std::string topic = "none"; for (const auto& one : all) { topic = "some"; }'
    assert {name for name, _ in ends(local + PUBLISH.replace("NAME", "topic"))} == {"none", "some"}


def test_lists_that_are_no_parameters_are_empty() -> None:
    """A loop over an empty list in the code does not run."""
    local = 'std::vector<std::string> all; create_publisher<std_msgs::msg::String>("other", 1);'
    assert ends(local + LOOPS[0].replace("NAME", "one")) == [("other", None)]
