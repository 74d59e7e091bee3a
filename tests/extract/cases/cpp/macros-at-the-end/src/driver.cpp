#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>
#include <vendor/macros.hpp>

namespace driver
{
struct Settings
{
  int rate;
  VENDOR_DEFINE_MEMBERS(ALL_OF_THEM)
};

class Driver : public rclcpp::Node
{
public:
  Driver() : Node("driver")
  {
    state_ = create_publisher<std_msgs::msg::String>("state", 1);
    VENDOR_LOG_INFO("the driver is ready")  // and has a state
  }

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr state_;
};
}  // namespace driver

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<driver::Driver>());
}
