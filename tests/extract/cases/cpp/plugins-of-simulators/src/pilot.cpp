#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("pilot");
  auto thrust = node->create_publisher<std_msgs::msg::Float64>("thrust", 10);
  rclcpp::spin(node);
}
