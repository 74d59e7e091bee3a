#include <geometry_msgs/msg/twist.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <tf2_ros/transform_broadcaster.h>

#include <demo_interfaces/action/dock.hpp>

using Dock = demo_interfaces::action::Dock;
using geometry_msgs::msg::Twist;

class Ends : public rclcpp_lifecycle::LifecycleNode
{
public:
  explicit Ends(const rclcpp::NodeOptions & options) : LifecycleNode("both_ends", options)
  {
    rclcpp::QoS latched(rclcpp::KeepLast(1));
    latched.transient_local();
    pub_ = create_publisher<Twist>("cmd_vel", 10);
    map_ = this->create_publisher<nav_msgs::msg::Odometry>("~/odometry", latched);
    sub_ = create_subscription<sensor_msgs::msg::Image>(
      "/camera/" + std::string("image"), rclcpp::SensorDataQoS().keep_last(2),
      [this](const sensor_msgs::msg::Image::ConstSharedPtr msg) { on_image(msg); });
    auto relay = create_sub_node("relay");
    relay_ = relay->create_publisher<Twist>("out", rclcpp::QoS{3}.best_effort());
    service_ = create_service<std_srvs::srv::Trigger>(
      "~/start", std::bind(&Ends::on_start, this, std::placeholders::_1, std::placeholders::_2));
    client_ = rclcpp::create_client<std_srvs::srv::Trigger>(
      get_node_base_interface(), get_node_graph_interface(), get_node_services_interface(), "stop", qos_, nullptr);
    server_ = rclcpp_action::create_server<Dock>(this, "dock", on_goal, on_cancel, on_accepted);
    actions_ = rclcpp_action::create_client<Dock>(this, "~/undock");
    anything_ = create_generic_subscription("any", "std_msgs/msg/String", 1, on_any);
    broadcaster_ = std::make_shared<tf2_ros::TransformBroadcaster>(this);
    for (const auto & side : {"left", "right"}) {
      wheels_.push_back(create_publisher<Twist>(std::string(side) + "/" + topic_, rclcpp::QoS(5)));
    }
  }

private:
  void on_image(const sensor_msgs::msg::Image::ConstSharedPtr & msg);
  void on_start(
    const std::shared_ptr<std_srvs::srv::Trigger::Request> request,
    std::shared_ptr<std_srvs::srv::Trigger::Response> response);
  const std::string topic_ = "speed";
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Ends>(rclcpp::NodeOptions())->get_node_base_interface());
}
