#include <mapping/extension.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/imu.hpp>

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("mapper");
  auto imu = node->create_subscription<sensor_msgs::msg::Imu>("imu", 10, [](sensor_msgs::msg::Imu::SharedPtr) {});
  auto extension = mapping::Extension::load("libviewer.so");
  extension->start(*node);
  rclcpp::spin(node);
}
