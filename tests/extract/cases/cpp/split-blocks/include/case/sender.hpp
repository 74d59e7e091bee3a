#pragma once
#if __has_include(<rclcpp/version.h>)
#include <rclcpp/version.h>
#else
#include <rclcpp/old_version.h>
#endif
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

class Sender : public rclcpp::Node
{
public:
  CASE_PUBLIC explicit Sender(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

private:
  CASE_LOCAL
  void initialize();

  std::shared_ptr<void> first_, second_, third_, fourth_;
};
