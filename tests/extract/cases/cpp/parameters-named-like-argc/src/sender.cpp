#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("sender");
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr counted, other;
  if (node->declare_parameter("argcount", false)) {
    counted = node->create_publisher<std_msgs::msg::String>("counted", 1);
  } else {
    other = node->create_publisher<std_msgs::msg::String>("other", 1);
  }
  if (argc > 2) {
    auto extra = node->create_publisher<std_msgs::msg::String>("extra", 1);
  }
  rclcpp::spin(node);
}
