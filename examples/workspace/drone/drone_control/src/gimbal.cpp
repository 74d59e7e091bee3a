#include "drone_control/gimbal.hpp"

#include <rclcpp_components/register_node_macro.hpp>

namespace drone_control
{

Gimbal::Gimbal(const rclcpp::NodeOptions & options)
: Node("gimbal", options), buffer_(get_clock()), listener_(buffer_)
{
  // The parameter names the topic; its default counts while nobody sets it.
  const std::string picture_topic = declare_parameter<std::string>("picture_topic", "camera/image_raw");
  const auto depth = declare_parameter("queue_depth", 5);

  picture_sub_ = image_transport::create_subscription(
    this, picture_topic, [this](const auto & picture) {on_picture(picture);}, "raw");
  stabilized_pub_ = image_transport::create_publisher(this, "camera/stabilized");

  depth_sub_.subscribe(this, "camera/depth");
  info_sub_.subscribe(this, "camera/camera_info");
  both_ = std::make_shared<message_filters::TimeSynchronizer<sensor_msgs::msg::Image, sensor_msgs::msg::CameraInfo>>(
    depth_sub_, info_sub_, depth);
  both_->registerCallback(&Gimbal::on_both, this);

  angles_pub_ = create_publisher<geometry_msgs::msg::Vector3Stamped>("~/angles", rclcpp::QoS(rclcpp::KeepAll()).reliable());
  center_srv_ = create_service<std_srvs::srv::Trigger>(
    "~/center", std::bind(&Gimbal::on_center, this, std::placeholders::_1, std::placeholders::_2));
}

void Gimbal::on_picture(const sensor_msgs::msg::Image::ConstSharedPtr & picture)
{
  stabilized_pub_.publish(picture);
}

void Gimbal::on_both(
  const sensor_msgs::msg::Image::ConstSharedPtr & depth, const sensor_msgs::msg::CameraInfo::ConstSharedPtr & info)
{
  geometry_msgs::msg::Vector3Stamped angles;
  angles.header = depth->header;
  angles.vector.x = info->k[2];
  angles_pub_->publish(angles);
}

void Gimbal::on_center(
  const std_srvs::srv::Trigger::Request::SharedPtr, std_srvs::srv::Trigger::Response::SharedPtr response)
{
  response->success = true;
}

}  // namespace drone_control

RCLCPP_COMPONENTS_REGISTER_NODE(drone_control::Gimbal)
