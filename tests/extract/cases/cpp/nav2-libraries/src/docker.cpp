#include <nav2_msgs/action/dock_robot.hpp>
#include <nav2_util/lifecycle_node.hpp>
#include <nav2_util/service_client.hpp>
#include <nav2_util/simple_action_server.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_srvs/srv/trigger.hpp>

using DockRobot = nav2_msgs::action::DockRobot;

class Docker : public nav2_util::LifecycleNode
{
public:
  Docker() : nav2_util::LifecycleNode("docker", "") { declare_parameter("speed", 0.1); }

  nav2_util::CallbackReturn on_configure(const rclcpp_lifecycle::State &) override
  {
    docked_ = create_publisher<std_msgs::msg::Bool>("docked", 1);
    server_ = std::make_unique<nav2_util::SimpleActionServer<DockRobot>>(
      shared_from_this(), "dock", std::bind(&Docker::dock, this));
    unlock_ = std::make_shared<nav2_util::ServiceClient<std_srvs::srv::Trigger>>("unlock", shared_from_this());
    return nav2_util::CallbackReturn::SUCCESS;
  }

private:
  void dock() {}

  rclcpp_lifecycle::LifecyclePublisher<std_msgs::msg::Bool>::SharedPtr docked_;
  std::unique_ptr<nav2_util::SimpleActionServer<DockRobot>> server_;
  std::shared_ptr<nav2_util::ServiceClient<std_srvs::srv::Trigger>> unlock_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Docker>()->get_node_base_interface());
}
