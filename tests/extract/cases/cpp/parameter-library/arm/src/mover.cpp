#include "controllers.hpp"

int main(int argc, char** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("mover");
  Controller controller(node.get());
  rclcpp::spin(node);
}
