#include <cmath>
#include <limits>
#include <rclcpp/rclcpp.hpp>

template <typename T>
void declare(const rclcpp::Node::SharedPtr& node, const std::string& name, const T value) {
  node->declare_parameter<T>(name, value);
}

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("limits");
  node->declare_parameter("range.max", std::numeric_limits<double>::infinity());
  node->declare_parameter("range.min", -std::numeric_limits<float>::infinity());
  node->declare_parameter("age.max", std::numeric_limits<int>::max());
  node->declare_parameter("id.min", std::numeric_limits<int16_t>::lowest());
  node->declare_parameter("count.min", static_cast<int>(std::numeric_limits<size_t>::min()));
  declare(node, "offset", std::numeric_limits<double>::quiet_NaN());
  node->declare_parameter("speed.max", INFINITY);
  rclcpp::spin(node);
  return 0;
}
