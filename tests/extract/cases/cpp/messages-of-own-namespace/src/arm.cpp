#include <rover/srv/stop.hpp>
#include <tools/msg/gripper.hpp>

using namespace tools;

namespace rover {

class Arm : public rclcpp::Node {
 public:
  Arm() : Node("arm") {
    state_ = create_publisher<msg::JointState2D>("state", 10);
    stop_ = create_service<srv::Stop>("stop", [](srv::Stop::Request::SharedPtr, srv::Stop::Response::SharedPtr) {});
    command_ = create_subscription<std_msgs::msg::Empty>("command", 1, [](std_msgs::msg::Empty::SharedPtr) {});
    echo_ = create_subscription("echo", 1, [](msg::JointState2D::ConstSharedPtr state) {});
    reach_ = rclcpp_action::create_client<action::Reach>(this, "reach");
  }
};

}  // namespace rover

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rover::Arm>();
  auto gripper = node->create_publisher<msg::Gripper>("gripper", 10);
  rclcpp::spin(node);
}
