#pragma once
#include <string>

#include <hardware_interface/system_interface.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/joint_state.hpp>

namespace demo {

struct Wheels {
  static constexpr auto TOPIC = "wheels";
};
struct Legs {
  static constexpr auto TOPIC = "legs";
};

template <typename Kind>
class Drive : public hardware_interface::SystemInterface {
 public:
  CallbackReturn on_init(const hardware_interface::HardwareInfo& info) override;

 private:
  rclcpp::Node::SharedPtr node_;
  rclcpp::Publisher<sensor_msgs::msg::JointState>::SharedPtr publisher_;
};

using WheeledDrive = Drive<Wheels>;
using LeggedDrive = Drive<Legs>;

}  // namespace demo
