#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>
#include <shared/limits_parameters.hpp>
#include "arm_parameters.hpp"
#include <tuned/gripper_parameters.hpp>

namespace tuned
{
class Arm : public rclcpp::Node
{
public:
  explicit Arm(const rclcpp::NodeOptions & options) : rclcpp::Node("arm", options)
  {
    listener_ = std::make_shared<arm::ParamListener>(get_node_parameters_interface());
    params_ = listener_->get_params();
    if (params_.joints.size() != 2) {
      return;
    }
    for (size_t i = 0; i < params_.joints.size(); ++i) {
      joints_.push_back(create_publisher<std_msgs::msg::String>(params_.joints[i], 1));
    }
    publisher_ = create_publisher<std_msgs::msg::String>(params_.frame + "/pose", 1);
  }
  std::shared_ptr<arm::ParamListener> listener_;
  arm::Params params_;
  std::vector<rclcpp::Publisher<std_msgs::msg::String>::SharedPtr> joints_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr publisher_;
};

class Fingers
{
public:
  explicit Fingers(rclcpp::Node * node) : listener_(node, node->get_logger(), "left.") {}
  gripper::ParamListener listener_;
};

class Gripper : public rclcpp::Node
{
public:
  explicit Gripper(const rclcpp::NodeOptions & options) : rclcpp::Node("gripper", options), fingers_(this) {}
  Fingers fingers_;
};

class Both : public Arm
{
public:
  explicit Both(const rclcpp::NodeOptions & options)
  : Arm(options), other_(std::make_unique<gripper::ParamListener>(this, "hand")) {}
  std::unique_ptr<gripper::ParamListener> other_;
};

class Limited : public rclcpp::Node
{
public:
  explicit Limited(const rclcpp::NodeOptions & options) : rclcpp::Node("limited", options)
  {
    limits::ParamListener listener(get_node_parameters_interface());
  }
};

class Plain : public rclcpp::Node
{
public:
  explicit Plain(const rclcpp::NodeOptions & options) : rclcpp::Node("plain", options) {}
  void use(std::shared_ptr<arm::ParamListener> listener) { params_ = listener->get_params(); }
  arm::Params params_;
};
}  // namespace tuned

RCLCPP_COMPONENTS_REGISTER_NODE(tuned::Arm)
