#include <rclcpp/rclcpp.hpp>
#include <rclcpp/wait_for_message.hpp>
#include <sensor_msgs/msg/imu.hpp>

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("waiter");
  sensor_msgs::msg::Imu first;
  if (rclcpp::wait_for_message(first, node, "imu", std::chrono::seconds(5))) {
    rclcpp::spin(node);
  }
}
