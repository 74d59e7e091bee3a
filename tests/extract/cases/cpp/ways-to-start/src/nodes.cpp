#include "nodes.hpp"

namespace ways
{
Talker::Talker(const rclcpp::NodeOptions & options) : rclcpp::Node("talker", options)
{
  declare_parameter("rate", 10.0);
  publisher_ = create_publisher<std_msgs::msg::String>("chatter", 10);
}

Listener::Listener(const std::string & name, const rclcpp::NodeOptions & options) : rclcpp::Node(name, options)
{
  subscription_ = create_subscription<std_msgs::msg::String>("~/heard", 10, [](std_msgs::msg::String::SharedPtr) {});
}

Echo::Echo(const rclcpp::NodeOptions & options) : rclcpp::Node("echo", options)
{
  publisher_ = create_publisher<std_msgs::msg::String>("echo", 10);
}

Base::Base(const std::string & name, const rclcpp::NodeOptions & options) : rclcpp::Node(name, options)
{
  publisher_ = create_publisher<std_msgs::msg::String>("output", 10);
}
}  // namespace ways
