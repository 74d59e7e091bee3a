#pragma once

#include <memory>
#include <string>

#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <image_transport/image_transport.hpp>
#include <message_filters/subscriber.h>
#include <message_filters/time_synchronizer.h>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/camera_info.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

namespace drone_control
{

/// Points the camera at what it looks for; a component, so that pictures are not copied between processes.
class Gimbal : public rclcpp::Node
{
public:
  explicit Gimbal(const rclcpp::NodeOptions & options);

private:
  void on_picture(const sensor_msgs::msg::Image::ConstSharedPtr & picture);
  void on_both(
    const sensor_msgs::msg::Image::ConstSharedPtr & depth,
    const sensor_msgs::msg::CameraInfo::ConstSharedPtr & info);
  void on_center(
    const std_srvs::srv::Trigger::Request::SharedPtr request, std_srvs::srv::Trigger::Response::SharedPtr response);

  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  image_transport::Subscriber picture_sub_;
  image_transport::Publisher stabilized_pub_;
  message_filters::Subscriber<sensor_msgs::msg::Image> depth_sub_;
  message_filters::Subscriber<sensor_msgs::msg::CameraInfo> info_sub_;
  std::shared_ptr<message_filters::TimeSynchronizer<sensor_msgs::msg::Image, sensor_msgs::msg::CameraInfo>> both_;
  rclcpp::Publisher<geometry_msgs::msg::Vector3Stamped>::SharedPtr angles_pub_;
  rclcpp::Service<std_srvs::srv::Trigger>::SharedPtr center_srv_;
};

}  // namespace drone_control
