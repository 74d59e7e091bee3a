#pragma once
#include <string>
#include <geometry_msgs/msg/twist.hpp>
#include <ackermann_msgs/msg/ackermann_drive.hpp>

namespace bases
{
struct Wheels {};
struct Steering {};
struct Arms {};

template <typename Hardware>
struct Traits;

template <>
struct Traits<Wheels>
{
  using Command = geometry_msgs::msg::Twist;
  static constexpr const char * topic = "wheels/command";
  static std::string odometry() { return "wheels/odometry"; }
};

template <>
struct Traits<Steering>
{
  using Command = ackermann_msgs::msg::AckermannDrive;
  static constexpr const char * topic = "steering/command";
  static std::string odometry() { return "steering/odometry"; }
};
}  // namespace bases
