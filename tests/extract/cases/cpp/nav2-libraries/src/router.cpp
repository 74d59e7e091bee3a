#include <nav2_msgs/action/follow_path.hpp>
#include <nav2_ros_common/lifecycle_node.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_srvs/srv/trigger.hpp>

using FollowPath = nav2_msgs::action::FollowPath;

class Router : public nav2::LifecycleNode
{
public:
  explicit Router(const rclcpp::NodeOptions & options = rclcpp::NodeOptions())
  : nav2::LifecycleNode("router", options)
  {
  }

protected:
  nav2::CallbackReturn on_configure(const rclcpp_lifecycle::State &) override
  {
    const auto topic = declare_or_get_parameter("blocked_topic", std::string("blocked"));
    blocked_ = create_subscription<std_msgs::msg::Bool>(topic, [](std_msgs::msg::Bool::ConstSharedPtr) {}, 5);
    state_ = create_publisher<std_msgs::msg::Bool>("state");
    pause_ = create_client<std_srvs::srv::Trigger>("pause", true);
    follow_ = create_action_client<FollowPath>("follow_path");
    route_ = create_action_server<FollowPath>("route", std::bind(&Router::route, this));
    return nav2::CallbackReturn::SUCCESS;
  }

private:
  void route() {}
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<Router>();
  rclcpp::spin(node->get_node_base_interface());
}
