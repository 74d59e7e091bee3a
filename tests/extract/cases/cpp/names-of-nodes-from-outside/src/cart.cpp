// The name is an argument of the command line.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = rclcpp::Node::make_shared(argv[1]);
  auto load = node->create_publisher<std_msgs::msg::String>("~/load", 1);
  rclcpp::spin(node);
}
