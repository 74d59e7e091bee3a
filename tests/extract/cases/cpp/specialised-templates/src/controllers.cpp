#include "bases/controller.hpp"
#include <pluginlib/class_list_macros.hpp>

namespace bases
{
Limits<Steering>::Limits(rclcpp_lifecycle::LifecycleNode::SharedPtr node)
{
  node->declare_parameter<double>("angle", 0.5);
}

template <>
void Controller<Wheels>::extra()
{
  get_node()->declare_parameter<bool>("brakes", true);
}

template <>
void Controller<Steering>::extra()
{
  get_node()->declare_parameter<int>("axles", 2);
}

template <>
void Controller<Arms>::extra()
{
  get_node()->declare_parameter<int>("joints", 6);
}
}  // namespace bases

PLUGINLIB_EXPORT_CLASS(bases::Controller<bases::Wheels>, controller_interface::ControllerInterface)
PLUGINLIB_EXPORT_CLASS(bases::SteeringController, controller_interface::ControllerInterface)
PLUGINLIB_EXPORT_CLASS(bases::Controller<bases::Arms>, controller_interface::ControllerInterface)
