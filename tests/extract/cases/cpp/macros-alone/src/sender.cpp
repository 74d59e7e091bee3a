#include "case/sender.hpp"

Sender::Sender()
: Node("sender")
{
  const int kind =
    KIND_FIRST
    + KIND_SECOND;
  if (kind == KIND_SECOND) {
    first_ = create_publisher<std_msgs::msg::String>("first", 1);
  }
  second_ = create_publisher<std_msgs::msg::String>("second", 1);
}

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Sender>());
}
