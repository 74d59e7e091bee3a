#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/string.hpp>

namespace robot
{
namespace arm
{
class Driver : public rclcpp::Node
{
public:
  Driver();
  void open();
  void close();

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr state_;
  rclcpp::Subscription<std_msgs::msg::Bool>::SharedPtr stop_;
};

arm::Driver::Driver() : Node("driver")
{
  open();
  close();
}

void robot::arm::Driver::open() { state_ = create_publisher<std_msgs::msg::String>("state", 1); }
}  // namespace arm

void robot::arm::Driver::close()
{
  stop_ = create_subscription<std_msgs::msg::Bool>("stop", 1, [](std_msgs::msg::Bool::SharedPtr) {});
}
}  // namespace robot

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<robot::arm::Driver>());
}
