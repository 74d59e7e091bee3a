#include <nav2_costmap_2d/obstacle_layer.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <sensor_msgs/msg/camera_info.hpp>

namespace depth_layer
{
class DepthLayer : public nav2_costmap_2d::ObstacleLayer
{
public:
  void onInitialize() override;

private:
  rclcpp::Subscription<sensor_msgs::msg::CameraInfo>::SharedPtr info_;
};

void DepthLayer::onInitialize()
{
  declareParameter("info_topic", rclcpp::ParameterValue(std::string("/camera_info")));
  auto node = node_.lock();
  std::string topic;
  node->get_parameter(name_ + ".info_topic", topic);
  info_ = node->create_subscription<sensor_msgs::msg::CameraInfo>(topic, 1, nullptr);
}
}  // namespace depth_layer

PLUGINLIB_EXPORT_CLASS(depth_layer::DepthLayer, nav2_costmap_2d::Layer)
