#include <rclcpp/rclcpp.hpp>
#include <settings/settings.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/string.hpp>

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("reader");
  std::string filled, kept = "usual";
  settings::read("topic", filled);
  settings::read("other", kept);
  auto first = node->create_publisher<std_msgs::msg::String>(filled, 1);
  auto second = node->create_publisher<std_msgs::msg::Bool>(kept, 1);
  rclcpp::spin(node);
}
