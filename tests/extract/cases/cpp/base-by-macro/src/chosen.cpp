#include "robot/node.hpp"
#include "std_msgs/msg/string.hpp"
#include "std_srvs/srv/trigger.hpp"

class Chosen : public robot::Node
{
public:
  Chosen() : robot::Node("chosen")
  {
    status_ = create_publisher<std_msgs::msg::String>(global("status"), 10);
    alarm_ = create_publisher<std_msgs::msg::String>(global("/alarm"), 10);
    arm_ = create_subscription<std_msgs::msg::String>(
      read<std::string>("arm", "left") + "/state", 10, [](const std_msgs::msg::String & message) {});
    stop_ = create_service<std_srvs::srv::Trigger>(
      "stop", [](std_srvs::srv::Trigger::Request::SharedPtr request, std_srvs::srv::Trigger::Response::SharedPtr) {});
  }

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr status_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr alarm_;
  rclcpp::Subscription<std_msgs::msg::String>::SharedPtr arm_;
  rclcpp::Service<std_srvs::srv::Trigger>::SharedPtr stop_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Chosen>());
  return 0;
}
