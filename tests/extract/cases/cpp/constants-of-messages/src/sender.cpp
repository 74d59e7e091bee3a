#include <demo/msg/topics.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

using Topics = demo::msg::Topics;

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("sender");
  auto speed = node->create_publisher<std_msgs::msg::String>(demo::msg::Topics::SPEED, Topics::COUNT);
  if (Topics::COUNT == 3) {
    auto never = node->create_publisher<std_msgs::msg::String>(Topics::SPEED + "/never", 1);
  }
  auto other = node->create_publisher<std_msgs::msg::String>(Topics::OTHER, 1);
  rclcpp::spin(node);
}
