#include "demo/drive.hpp"

namespace demo {

template <typename Kind>
hardware_interface::CallbackReturn Drive<Kind>::on_init(const hardware_interface::HardwareInfo& info) {
  node_ = std::make_shared<rclcpp::Node>("bridge");
  publisher_ = node_->create_publisher<sensor_msgs::msg::JointState>(Kind::TOPIC, 1);
  return hardware_interface::CallbackReturn::SUCCESS;
}

template class Drive<Wheels>;
template class Drive<Legs>;

}  // namespace demo

#include <pluginlib/class_list_macros.hpp>
PLUGINLIB_EXPORT_CLASS(demo::WheeledDrive, hardware_interface::SystemInterface)
PLUGINLIB_EXPORT_CLASS(demo::LeggedDrive, hardware_interface::SystemInterface)
