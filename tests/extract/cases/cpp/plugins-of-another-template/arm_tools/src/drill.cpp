#include <arm_base/tool.hpp>
#include <std_msgs/msg/float64.hpp>

namespace arm
{
class Drill : public Tool
{
public:
  explicit Drill(rclcpp::Node::SharedPtr given)
  : Tool(given)
  {
    speed_ = node->create_publisher<std_msgs::msg::Float64>("~/speed", 10);
  }

private:
  rclcpp::Publisher<std_msgs::msg::Float64>::SharedPtr speed_;
};
}  // namespace arm

ARM_REGISTER(arm::Drill)
