// The name is one of two.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

bool loud();

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>(loud() ? "siren" : "bell");
  auto tone = node->create_publisher<std_msgs::msg::String>("~/tone", 1);
  rclcpp::spin(node);
}
