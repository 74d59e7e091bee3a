#include "case/sender.hpp"

Sender::Sender(const rclcpp::NodeOptions& options) : Node("sender", options)
{
  initialize();
}

void Sender::initialize()
{
  bool big = declare_parameter("big", true);
#if 0
  if (!big) {
#elif LIBRARY_VERSION >= 50
  if (big) {
    first_ = create_publisher<std_msgs::msg::String>("first", 1);
#else
  if (true) {
    first_ = create_publisher<std_msgs::msg::String>("other_version", 1);
#endif
    second_ = create_publisher<std_msgs::msg::String>("second", 1);
  }
  if (!big) {
    fourth_ = create_publisher<std_msgs::msg::String>("fourth", 1);
#if LIBRARY_VERSION >= 53
  } else if (declare_parameter("bigger", false)) {
    fourth_ = create_publisher<std_msgs::msg::String>("fifth", 1);
#endif
  } else {
    fourth_ = create_publisher<std_msgs::msg::String>("sixth", 1);
  }
#ifdef WITH_THIRD
  third_ = create_publisher<std_msgs::msg::String>("third", 1);
#endif
}

int main(int argc, char** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Sender>());
}
