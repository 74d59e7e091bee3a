#include <endpoints.hpp>
#include <rclcpp/rclcpp.hpp>

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("server");
  auto stop = node->create_service<StopService::Type>(StopService::name(), [](auto, auto) {});
  rclcpp::spin(node);
}
