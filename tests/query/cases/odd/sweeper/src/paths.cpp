#include <std_msgs/msg/empty.hpp>

#include "sweeper/path.hpp"

namespace sweeper
{
class Spiral : public Path
{
public:
  void configure(rclcpp::Node::SharedPtr node) override { node->declare_parameter("turns", 8); }
};

class Rows : public Path
{
public:
  void configure(rclcpp::Node::SharedPtr node) override { node->declare_parameter("gap", 0.2); }
};

class Loud : public Alarm
{
public:
  void configure(rclcpp::Node::SharedPtr node) override
  {
    horn_ = node->create_publisher<std_msgs::msg::Empty>("horn", 1);
  }

private:
  rclcpp::Publisher<std_msgs::msg::Empty>::SharedPtr horn_;
};
}  // namespace sweeper
