from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from extract.workspaces import manifest, written

from kg.corpus.reading import Reader
from kg.extract.package import extract_package
from kg.facts import Qos, Role

if TYPE_CHECKING:
    from pathlib import Path

FIELDS = (
    "rmw_qos_profile_t p = rmw_qos_profile_sensor_data; p.depth = 1; p.deadline.sec = 2;"
    " p.history = RMW_QOS_POLICY_HISTORY_KEEP_ALL; p.reliability = RMW_QOS_POLICY_RELIABILITY_RELIABLE;"
)
LAST = Qos("reliable", "volatile", "keep_last", 1)
USUAL = Qos("reliable", "volatile", "keep_last", 10)


def source(before: str, expression: str) -> str:
    """Return a node whose only publisher has this quality of service."""
    return (
        "#include <rclcpp/rclcpp.hpp>\nstatic const rclcpp::QoS shared_qos = rclcpp::QoS(4);\n"
        "class Bounded : public rclcpp::QoS {\n public:\n"
        "  explicit Bounded(int depth) : rclcpp::QoS(rclcpp::KeepLast(depth)) { best_effort(); }\n};\n"
        "class A : public rclcpp::Node {\n public:\n"
        f'  A() : Node("a") {{\n    {before}\n'
        f'    p_ = create_publisher<std_msgs::msg::String>("t", {expression});\n  }}\n'
        "  rclcpp::QoS member_{rclcpp::KeepLast(6)};\n  const int depth_ = 12;\n  int argc_ = outside();\n};\n"
        "int main() { std::make_shared<A>(); }\n"
    )


def qos_of(root: Path, before: str, expression: str) -> Qos | None:
    """Return the extracted quality of service."""
    cmake = "cmake_minimum_required(VERSION 3.8)\nproject(demo)\nadd_executable(a a.cpp)\n"
    files: dict[str, str | bytes] = {
        "demo/package.xml": manifest("demo"),
        "demo/CMakeLists.txt": cmake,
        "demo/a.cpp": source(before, expression),
    }
    workspace = written(root, files)
    found = workspace.package("demo")
    assert found is not None
    (node,) = extract_package(Reader(workspace, *workspace.folder(found))).nodes
    (end,) = [i for i in node.interfaces if i.role is Role.PUBLISHES and not i.implicit]
    return end.qos


@pytest.mark.parametrize(
    ("before", "expression", "wanted"),
    [
        ("", "7", Qos("reliable", "volatile", "keep_last", 7)),
        ("", "rclcpp::QoS(1)", Qos("reliable", "volatile", "keep_last", 1)),
        ("", "rclcpp::QoS{rclcpp::KeepLast(3)}", Qos("reliable", "volatile", "keep_last", 3)),
        ("", "rclcpp::QoS(rclcpp::KeepAll()).reliable()", Qos("reliable", "volatile", "keep_all", None)),
        ("", "rclcpp::QoS{1}.transient_local()", Qos("reliable", "transient_local", "keep_last", 1)),
        ("", "rclcpp::SensorDataQoS().keep_last(2)", Qos("best_effort", "volatile", "keep_last", 2)),
        ("", "rmw_qos_profile_sensor_data", Qos("best_effort", "volatile", "keep_last", 5)),
        ("", "rclcpp::ServicesQoS()", USUAL),
        (
            "",
            "rclcpp::QoS(rclcpp::QoSInitialization::from_rmw(rmw_qos_profile_default), rmw_qos_profile_sensor_data)",
            Qos("best_effort", "volatile", "keep_last", 10),
        ),
        (
            "",
            "rclcpp::QoS(rclcpp::QoSInitialization(RMW_QOS_POLICY_HISTORY_KEEP_LAST, 9))",
            Qos("reliable", "volatile", "keep_last", 9),
        ),
        ("", "rclcpp::SensorDataQoS(rclcpp::KeepLast(1))", Qos("best_effort", "volatile", "keep_last", 1)),
        ("", "rclcpp::ClockQoS().get_rmw_qos_profile()", Qos("best_effort", "volatile", "keep_last", 1)),
        ("", "Bounded(3)", Qos("best_effort", "volatile", "keep_last", 3)),
        ("Bounded q(3); q.transient_local();", "q", Qos("best_effort", "transient_local", "keep_last", 3)),
        ("rclcpp::QoS q(2); auto other = q; other.best_effort();", "q", Qos("reliable", "volatile", "keep_last", 2)),
        ("rclcpp::QoS q(2); if (argc_) q.best_effort(); else q.transient_local();", "q", None),
        (
            "",
            "rclcpp::QoS(5).durability(rclcpp::DurabilityPolicy::TransientLocal)",
            Qos("reliable", "transient_local", "keep_last", 5),
        ),
        (
            "",
            "rclcpp::QoS(5).reliability(RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT)",
            Qos("best_effort", "volatile", "keep_last", 5),
        ),
        (
            "rclcpp::QoS q(2); q.transient_local().best_effort();",
            "q",
            Qos("best_effort", "transient_local", "keep_last", 2),
        ),
        ("auto q = rclcpp::QoS(2); q.transient_local();", "q", Qos("reliable", "transient_local", "keep_last", 2)),
        ("const int depth = 8;", "depth", Qos("reliable", "volatile", "keep_last", 8)),
        ("", "rclcpp::QoS(depth_)", Qos("reliable", "volatile", "keep_last", 12)),
        ("", "member_", Qos("reliable", "volatile", "keep_last", 6)),
        ("", "shared_qos", Qos("reliable", "volatile", "keep_last", 4)),
        ("", "rclcpp::QoS(1).deadline(100ms)", replace(LAST, deadline=0.1)),
        ("", "rclcpp::QoS(1).deadline(2 * 500ms).lifespan(std::chrono::seconds(3))",
         replace(LAST, deadline=1.0, lifespan=3.0)),
        ("", "rclcpp::QoS(1).deadline(rclcpp::Duration::from_seconds(0.5))", replace(LAST, deadline=0.5)),
        ("", "rclcpp::QoS(1).deadline(rclcpp::Duration(1, 250000000))", replace(LAST, deadline=1.25)),
        ("", "rclcpp::QoS(1).deadline(rclcpp::Duration(std::chrono::milliseconds(20)))", replace(LAST, deadline=0.02)),
        ("", "rclcpp::QoS(1).deadline(rmw_time_t{2, 0})", replace(LAST, deadline=2.0)),
        ("", "rclcpp::QoS(1).deadline(std::chrono::duration<double, std::milli>(5))", replace(LAST, deadline=0.005)),
        ("", "rclcpp::QoS(1).deadline(1s / 4 + 50ms)", replace(LAST, deadline=0.3)),
        ("", "rclcpp::QoS(1).deadline(rclcpp::Duration::max())", LAST),
        ("rmw_time_t t{2, 0}; t.nsec = 500000000;", "rclcpp::QoS(1).deadline(t)", replace(LAST, deadline=2.5)),
        ("", "rclcpp::QoS(1).deadline(RMW_DURATION_INFINITE).lifespan(rclcpp::Duration(0, 0))", LAST),
        ("const std::chrono::milliseconds period{50}; auto later = 2s;",
         "rclcpp::QoS(1).deadline(period).lifespan(later)", replace(LAST, deadline=0.05, lifespan=2.0)),
        ("const auto frame = std::chrono::duration<double>(0.04);", "rclcpp::QoS(1).deadline(frame)",
         replace(LAST, deadline=0.04)),
        ("", "rclcpp::QoS(1).liveliness(rclcpp::LivelinessPolicy::ManualByTopic).liveliness_lease_duration(1s)",
         replace(LAST, liveliness="manual_by_topic", lease_duration=1.0)),
        ("", "rclcpp::QoS(1).liveliness(RMW_QOS_POLICY_LIVELINESS_AUTOMATIC)", replace(LAST, liveliness="automatic")),
        ("int kept = (int)RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT;",
         "rclcpp::QoS(1).reliability((rmw_qos_reliability_policy_t)kept)", replace(LAST, reliability="best_effort")),
        (FIELDS, "rclcpp::QoS(rclcpp::QoSInitialization::from_rmw(p), p)",
         Qos("reliable", "volatile", "keep_all", 1, deadline=2.0)),
        ("", "rclcpp::QoS(1).deadline(deadline_of(this))", None),
        ("", "make_qos()", None),
        ("", "rclcpp::QoS(1).unheard_of()", None),
        ("", "rclcpp::QoS(depth_of(this)).reliable()", None),
        ("rclcpp::QoS q(2); q.lifespan(lifespan_of(this));", "q.reliable()", None),
    ],
)  # fmt: skip
def test_profiles(tmp_path: Path, before: str, expression: str, wanted: Qos | None) -> None:
    """A profile has its base and the changes of its methods; unsupported ones are unknown."""
    assert qos_of(tmp_path, before, expression) == wanted
