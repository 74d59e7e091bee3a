#include "nodes.hpp"

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<ways::Echo>(rclcpp::NodeOptions());
  auto state = node->create_publisher<std_msgs::msg::String>("state", 1);
  rclcpp::spin(node);
}
