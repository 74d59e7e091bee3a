#include "nodes.hpp"

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::executors::MultiThreadedExecutor executor;
  auto node = std::make_shared<ways::Talker>();
  executor.add_node(node);
  executor.spin();
}
