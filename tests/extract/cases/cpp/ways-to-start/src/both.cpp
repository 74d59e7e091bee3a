#include "nodes.hpp"

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::executors::SingleThreadedExecutor executor;
  auto talker = std::make_shared<ways::Talker>();
  auto echo = std::make_shared<ways::Echo>(rclcpp::NodeOptions());
  executor.add_node(talker);
  executor.add_node(echo);
  executor.spin();
}
