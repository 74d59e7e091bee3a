#pragma once
#include <rclcpp/rclcpp.hpp>

namespace sweeper
{
class Path
{
public:
  virtual ~Path() = default;
  virtual void configure(rclcpp::Node::SharedPtr node) = 0;
};

class Alarm
{
public:
  virtual ~Alarm() = default;
  virtual void configure(rclcpp::Node::SharedPtr node) = 0;
};
}  // namespace sweeper
