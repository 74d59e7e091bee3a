#include "scene/scene.hpp"

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = rclcpp::Node::make_shared("planner");
  scene::Scene<sensor_msgs::msg::PointCloud2> scene(node);
  scene.setup("cloud");
  scene.repeat("cloud_again");
  rclcpp::spin(node);
}
