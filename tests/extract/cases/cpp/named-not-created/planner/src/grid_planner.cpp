#include "planner/planner_core.hpp"
#include <nav_msgs/msg/path.hpp>
#include <pluginlib/class_list_macros.hpp>

namespace planner
{

class GridPlanner : public planner_core::Planner
{
public:
  void configure(
    rclcpp::Node::SharedPtr node, const std::string & name,
    std::shared_ptr<costmap::CostmapNode> costmap) override
  {
    costmap_ = costmap;
    costmap_->activate();
    plan_ = node->create_publisher<nav_msgs::msg::Path>("plan", 1);
  }

private:
  std::shared_ptr<costmap::CostmapNode> costmap_;
  rclcpp::Publisher<nav_msgs::msg::Path>::SharedPtr plan_;
};

}  // namespace planner

PLUGINLIB_EXPORT_CLASS(planner::GridPlanner, planner_core::Planner)
