// The first node has no known name, the second one has.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto engine = std::make_shared<rclcpp::Node>(argv[1]);
  auto wagon = std::make_shared<rclcpp::Node>("wagon");
  auto speed = engine->create_publisher<std_msgs::msg::String>("~/speed", 1);
  auto cargo = wagon->create_publisher<std_msgs::msg::String>("~/cargo", 1);
}
