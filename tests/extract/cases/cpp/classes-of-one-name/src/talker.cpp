#include "case/talker.hpp"

Talker::Talker(rclcpp::NodeOptions options) : Node("talker", options)
{
  publisher_ = create_publisher<std_msgs::msg::String>("topic", 10);
}

#include "rclcpp_components/register_node_macro.hpp"
RCLCPP_COMPONENTS_REGISTER_NODE(Talker)
