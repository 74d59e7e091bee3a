#include "arm_parameters.hpp"
#include "controllers.hpp"

void watch(Controller* controller, const arm::Params& params)
{
}

int main(int argc, char** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("watcher");
  node->declare_parameter("rate", 10.0);
  rclcpp::spin(node);
}
