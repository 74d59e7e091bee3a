#include "arm_parameters.hpp"
#include "controllers.hpp"

Controller::Controller(rclcpp::Node* node)
{
  listener_ = std::make_shared<arm::ParamListener>(node->get_node_parameters_interface(), "left");
  params_ = listener_->get_params();
  publisher_ = node->create_publisher<std_msgs::msg::String>(params_.topic, 10);
}
