#include "layers/stack.hpp"
#include <std_msgs/msg/string.hpp>

namespace layers
{
class Walls : public Layer
{
public:
  void initialize(rclcpp::Node::SharedPtr node, const std::string & name) override
  {
    publisher_ = node->create_publisher<std_msgs::msg::String>(name + "/walls", 1);
  }

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr publisher_;
};
}  // namespace layers
