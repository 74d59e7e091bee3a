#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <my_msgs/action/dock.hpp>
#include <my_msgs/msg/feedback.hpp>
#include <my_msgs/msg/goal.hpp>
#include <my_msgs/msg/request.hpp>
#include <my_msgs/msg/result.hpp>
#include <my_msgs/srv/response.hpp>
#include <sensor_msgs/msg/image.hpp>

struct Frame
{
  int width;
};

template <>
struct rclcpp::TypeAdapter<Frame, sensor_msgs::msg::Image>
{
  using is_specialized = std::true_type;
  using custom_type = Frame;
  using ros_message_type = sensor_msgs::msg::Image;
};

using Adapted = rclcpp::TypeAdapter<Frame, sensor_msgs::msg::Image>;

class Typed : public rclcpp::Node
{
public:
  Typed() : Node("typed")
  {
    feedback_ = create_publisher<my_msgs::msg::Feedback>("feedback", 1);
    result_ = create_publisher<my_msgs::msg::Result>("result", 1);
    goal_ = create_subscription<my_msgs::msg::Goal>(
      "goal", 1, [](my_msgs::msg::Goal::ConstSharedPtr) {});
    request_ = create_subscription<my_msgs::msg::Request>(
      "request", 1, [](const my_msgs::msg::Request &) {});
    service_ = create_service<my_msgs::srv::Response>(
      "response", [](my_msgs::srv::Response::Request::SharedPtr, my_msgs::srv::Response::Response::SharedPtr) {});
    dock_ = rclcpp_action::create_client<my_msgs::action::Dock>(this, "dock");
    adapted_ = create_publisher<Adapted>("adapted", 1);
  }

private:
  rclcpp::Publisher<my_msgs::msg::Feedback>::SharedPtr feedback_;
  rclcpp::Publisher<my_msgs::msg::Result>::SharedPtr result_;
  rclcpp::Subscription<my_msgs::msg::Goal>::SharedPtr goal_;
  rclcpp::Subscription<my_msgs::msg::Request>::SharedPtr request_;
  rclcpp::Service<my_msgs::srv::Response>::SharedPtr service_;
  rclcpp_action::Client<my_msgs::action::Dock>::SharedPtr dock_;
  rclcpp::Publisher<Adapted>::SharedPtr adapted_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Typed>());
  return 0;
}
