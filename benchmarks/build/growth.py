"""How the processor time of extraction grows with the sources: growing parts of a checkout, and a generated package.

The exponent is the slope of the logarithms, by least squares: 1 is linear.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from statistics import linear_regression

from measuring import measure, python

__all__ = ["growth"]

_SHARES = (8, 4, 2, 1)
_CLASSES = (50, 100, 200, 400)
_MANIFEST = """<package format="3"><name>grown</name><version>1.0.0</version><description>Generated</description>
<maintainer email="nobody@example.org">Nobody</maintainer><license>MIT</license><depend>rclcpp</depend></package>
"""
_MAKEFILE = """cmake_minimum_required(VERSION 3.8)
project(grown)
file(GLOB SOURCES src/*.cpp)
add_executable(grown ${SOURCES})
install(TARGETS grown DESTINATION lib/${PROJECT_NAME})
"""
_COMMON = """#pragma once
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>
inline std::string topic_of(const std::string & part) { return "parts/" + part; }
"""
_HEADER = """#pragma once
#include "grown/common.hpp"
class Part{0} {{
 public:
  explicit Part{0}(rclcpp::Node & node);
 private:
  void received(const std_msgs::msg::String & message);
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr output_;
  rclcpp::Subscription<std_msgs::msg::String>::SharedPtr input_;
}};
"""
_SOURCE = """#include "grown/part{0}.hpp"
Part{0}::Part{0}(rclcpp::Node & node) {{
  const auto depth = node.declare_parameter<int>("part{0}.depth", {0});
  output_ = node.create_publisher<std_msgs::msg::String>(topic_of("output{0}"), depth);
  input_ = node.create_subscription<std_msgs::msg::String>(
    topic_of("input{0}"), depth, std::bind(&Part{0}::received, this, std::placeholders::_1));
}}
void Part{0}::received(const std_msgs::msg::String & message) {{
  for (std::size_t at = 0; at < message.data.size(); ++at) {{
    if (message.data[at] == 'x') {{ output_->publish(message); }}
  }}
}}
"""


def growth(checkout: Path, folder: Path, repeat: int) -> dict[str, object]:
    """Return the figures; the generated packages are written into `folder`."""
    parts = [_measured(checkout, repeat, every) for every in _SHARES]
    grown = [_measured(_generated(folder, classes), repeat, 1) for classes in _CLASSES]
    return {
        "checkout": checkout.name,
        **{
            f"1/{every} of the packages, CPU s": f"{cpu:.2f} ({size / 1e6:.1f} MB)"
            for every, (size, cpu) in zip(_SHARES, parts, strict=True)
        },
        "exponent, by bytes": _exponent(parts),
        **{f"{classes} classes, CPU s": round(cpu, 3) for classes, (_, cpu) in zip(_CLASSES, grown, strict=True)},
        "exponent, by classes": _exponent([(n, cpu) for n, (_, cpu) in zip(_CLASSES, grown, strict=True)]),
    }


def _measured(checkout: Path, repeat: int, every: int) -> tuple[int, float]:
    """Return the bytes of code of every n-th package of a checkout, and the processor seconds to extract them."""
    program = python(str(Path(__file__).with_name("stages.py")), str(checkout), "--whole", "--every", str(every))
    runs = [json.loads(measure(program).output) for _ in range(repeat)]
    return runs[0]["bytes"], min(run["seconds"]["rest"] for run in runs)


def _exponent(pairs: list[tuple[int, float]]) -> float:
    slope, _ = linear_regression([math.log(size) for size, _ in pairs], [math.log(cpu) for _, cpu in pairs])
    return round(slope, 2)


def _generated(folder: Path, classes: int) -> Path:
    """Write a package with one program that creates one object of each of a number of classes; return its folder."""
    root = folder / f"grown{classes}"
    (root / "src").mkdir(parents=True)
    (root / "include/grown").mkdir(parents=True)
    (root / "package.xml").write_text(_MANIFEST)
    (root / "CMakeLists.txt").write_text(_MAKEFILE)
    (root / "include/grown/common.hpp").write_text(_COMMON)
    for number in range(classes):
        (root / f"include/grown/part{number}.hpp").write_text(_HEADER.format(number))
        (root / f"src/part{number}.cpp").write_text(_SOURCE.format(number))
    includes = "".join(f'#include "grown/part{number}.hpp"\n' for number in range(classes))
    parts = "".join(f"  Part{number} part{number}(*node);\n" for number in range(classes))
    begin = '  rclcpp::init(argc, argv);\n  auto node = std::make_shared<rclcpp::Node>("grown");\n'
    main = f"{includes}int main(int argc, char ** argv) {{\n{begin}{parts}  rclcpp::spin(node);\n}}\n"
    (root / "src/main.cpp").write_text(main)
    return root
