#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  auto first = std::make_shared<rclcpp::Node>("first");
  auto second = std::make_shared<rclcpp::Node>("second", "/inner");
  auto outer = first->create_publisher<std_msgs::msg::String>("outer", 10);
  auto inner = second->create_publisher<std_msgs::msg::String>("inner", 10);
  auto own = second->create_publisher<std_msgs::msg::String>("~/own", 10);
  rclcpp::spin(first);
}
