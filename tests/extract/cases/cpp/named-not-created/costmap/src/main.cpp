#include "costmap/costmap.hpp"

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<costmap::CostmapNode>("costmap");
  node->activate();
  rclcpp::spin(node);
  return 0;
}
