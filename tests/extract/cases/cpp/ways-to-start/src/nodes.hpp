#pragma once
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

namespace ways
{
class Talker : public rclcpp::Node
{
public:
  explicit Talker(const rclcpp::NodeOptions & options = rclcpp::NodeOptions());
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr publisher_;
};

class Listener : public rclcpp::Node
{
public:
  explicit Listener(const rclcpp::NodeOptions & options) : Listener("listener", options) {}
  Listener(const std::string & name, const rclcpp::NodeOptions & options);
  rclcpp::Subscription<std_msgs::msg::String>::SharedPtr subscription_;
};

class Echo : public rclcpp::Node
{
public:
  explicit Echo(const rclcpp::NodeOptions & options);
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr publisher_;
};

class Base : public rclcpp::Node
{
public:
  Base(const std::string & name, const rclcpp::NodeOptions & options);
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr publisher_;
};

class First : public Base
{
public:
  explicit First(const rclcpp::NodeOptions & options) : Base("first", options) {}
};

class Second : public Base
{
public:
  explicit Second(const rclcpp::NodeOptions & options) : Base("second", options) {}
};
}  // namespace ways
