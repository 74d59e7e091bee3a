#include "specs.hpp"

#include <image_transport/image_transport.hpp>
#include <message_filters/subscriber.h>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <std_msgs/msg/float64.hpp>

namespace wrapped
{
class WRAPPED_PUBLIC Wrapped : public rclcpp::Node
{
public:
  explicit Wrapped(const rclcpp::NodeOptions & options)
  : Node("wrapped", options), adaptor_(this), debug_(this, "~/debug")
  {
    latest_ = autoware_utils::InterProcessPollingSubscriber<nav_msgs::msg::Odometry>::create_subscription(
      this, "~/input/latest", rclcpp::QoS{1});
    held_ = decltype(held_)::element_type::create_subscription(this, "~/input/held", rclcpp::QoS{2});
    cloud_.subscribe(this, "~/input/points", rmw_qos_profile_sensor_data);
    adaptor_.init_pub(pub_mode_);
    adaptor_.init_srv(srv_restart_, this, &Wrapped::on_restart), timer_ = create_wall_timer(1s, [this] { on_tick(); });
    const auto expand = [this](const std::string & name) {
      return rclcpp::expand_topic_or_service_name(name, get_name(), get_namespace());
    };
    camera_ = image_transport::create_camera_subscription(
      this, expand("camera/image"), std::bind(&Wrapped::on_image, this, std::placeholders::_1), "raw");
    const std::string topic = get_node_base_interface()->resolve_topic_or_service_name("image", false);
    image_ = image_transport::create_publisher(this, topic, rmw_qos_profile_default);
  }

private:
  void on_tick()
  {
    debug_.publish<std_msgs::msg::Float64>("latency", 1.0);
  }
  autoware_utils::InterProcessPollingSubscriber<nav_msgs::msg::Odometry> odometry_{this, "~/input/odometry"};
  autoware_utils::InterProcessPollingSubscriber<nav_msgs::msg::Odometry>::SharedPtr held_;
  message_filters::Subscriber<sensor_msgs::msg::PointCloud2> cloud_;
  component_interface_utils::NodeAdaptor adaptor_;
  component_interface_utils::Publisher<specs::CurrentMode>::SharedPtr pub_mode_;
  component_interface_utils::Service<specs::Restart>::SharedPtr srv_restart_;
  autoware_utils::DebugPublisher debug_;
};
}  // namespace wrapped

RCLCPP_COMPONENTS_REGISTER_NODE(wrapped::Wrapped)
