#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>

#define OFFER(publisher, type, topic)                                        \
  do {                                                                       \
    RCLCPP_INFO(node->get_logger(), "offers %s", topic);                     \
    publisher = node->create_publisher<type>(topic, 10);                     \
  } while (0)

#define LISTEN(topic) node->create_subscription<std_msgs::msg::Bool>(topic, 10, callback)

int main() {
  auto node = std::make_shared<rclcpp::Node>("sender");
  rclcpp::PublisherBase::SharedPtr left, right;
  auto callback = [](std_msgs::msg::Bool::SharedPtr) {};
  OFFER(left, std_msgs::msg::Bool, "left");

  OFFER(right, std_msgs::msg::Bool, "right");
  auto heard = LISTEN("heard");
  rclcpp::spin(node);
}
