#include <crane_control/msg/hoist_state.hpp>
#include <rclcpp/rclcpp.hpp>

#include <crane_control/everything.hpp>

using namespace crane_control::msg;

class Hoist : public rclcpp::Node
{
public:
  Hoist() : Node("hoist")
  {
    command_ = create_publisher<HoistCommand>("command", 10);
    state_ = create_subscription<HoistState>("state", 10, [](HoistState::SharedPtr) {});
    raw_ = create_publisher<HoistRaw>("raw", 10);
  }

private:
  rclcpp::Publisher<HoistCommand>::SharedPtr command_;
  rclcpp::Publisher<HoistRaw>::SharedPtr raw_;
  rclcpp::Subscription<HoistState>::SharedPtr state_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Hoist>());
  return 0;
}
