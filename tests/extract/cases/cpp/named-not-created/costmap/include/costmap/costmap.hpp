#pragma once
#include <memory>
#include <string>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_srvs/srv/empty.hpp>

namespace costmap
{

class CostmapNode : public rclcpp::Node
{
public:
  explicit CostmapNode(const std::string & name);
  void activate();
  std::string frame() const { return frame_; }

private:
  void clear(const std_srvs::srv::Empty::Request::SharedPtr, std_srvs::srv::Empty::Response::SharedPtr) {}

  std::string frame_{"map"};
  rclcpp::Publisher<nav_msgs::msg::OccupancyGrid>::SharedPtr grid_;
  rclcpp::Publisher<nav_msgs::msg::OccupancyGrid>::SharedPtr updates_;
  rclcpp::Service<std_srvs::srv::Empty>::SharedPtr service_;
};

}  // namespace costmap
