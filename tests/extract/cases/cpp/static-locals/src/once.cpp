#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/int32.hpp>
#include <std_msgs/msg/string.hpp>

// All calls share the publisher of the first one.
void log(rclcpp::Node& node, const std::string& topic)
{
  static auto publisher = node.create_publisher<std_msgs::msg::String>(topic, 1);
  publisher->publish(std_msgs::msg::String());
}

// Each instance of the template has its own.
template <typename Message>
void send(rclcpp::Node& node, const std::string& topic)
{
  static auto publisher = node.create_publisher<Message>(topic, 1);
}

std::string next()
{
  static int count = 0;
  return "part_" + std::to_string(count++);
}

// The second call runs what the first one left out.
void twice(rclcpp::Node& node)
{
  static bool first = true;
  if (first)
  {
    static auto one = node.create_publisher<std_msgs::msg::String>("first_call", 1);
    first = false;
  }
  else
  {
    static auto other = node.create_publisher<std_msgs::msg::String>("later_calls", 1);
  }
}

int main(int argc, char** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("once");
  log(*node, "first_log");
  log(*node, "second_log");
  send<std_msgs::msg::String>(*node, "text");
  send<std_msgs::msg::Int32>(*node, "number");
  send<std_msgs::msg::Int32>(*node, "second_number");
  auto zeroth = node->create_publisher<std_msgs::msg::String>(next(), 1);
  auto first = node->create_publisher<std_msgs::msg::String>(next(), 1);
  twice(*node);
  rclcpp::spin(node);
}
