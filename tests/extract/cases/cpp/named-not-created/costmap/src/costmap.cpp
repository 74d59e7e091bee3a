#include "costmap/costmap.hpp"

namespace costmap
{

CostmapNode::CostmapNode(const std::string & name) : rclcpp::Node(name)
{
  declare_parameter<double>("resolution", 0.05);
  grid_ = create_publisher<nav_msgs::msg::OccupancyGrid>("grid", 1);
  service_ = create_service<std_srvs::srv::Empty>(
    "clear", std::bind(&CostmapNode::clear, this, std::placeholders::_1, std::placeholders::_2));
}

void CostmapNode::activate()
{
  updates_ = create_publisher<nav_msgs::msg::OccupancyGrid>("grid_updates", 1);
}

}  // namespace costmap
