#include "case/senders.hpp"

namespace of_this_file = camera::old_bridge;

int main(int argc, char** argv)
{
  rclcpp::init(argc, argv);
  auto node = rclcpp::Node::make_shared("sender");
  camera::old_bridge::Sender first(node, "in_a_namespace");
  short_name::Sender second(node, "of_a_header");
  of_this_file::Sender third(node, "of_an_alias");
  namespace local = camera::bridge;
  local::Sender fourth(node, "in_a_function");
  local::listen(node, "function_in_a_function");
  camera::old_bridge::listen(node, "function_in_a_namespace");
  auto publisher = node->create_publisher<messages::String>("message", 1);
  rclcpp::spin(node);
}
