#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>

int main()
{
  auto node = std::make_shared<rclcpp::Node>("driver");
// Only a branch of CMake that does not hold defines the first; what an option decides can be either.
#ifdef OLD_ROS
  auto state = node->create_publisher<std_msgs::msg::Bool>("old", 1);
#elif NEW_ROS
  auto state = node->create_publisher<std_msgs::msg::Bool>("new", 1);
#endif
#ifdef WITH_POSE
  auto pose = node->create_publisher<std_msgs::msg::Bool>("pose", 1);
#endif
  rclcpp::spin(node);
}
