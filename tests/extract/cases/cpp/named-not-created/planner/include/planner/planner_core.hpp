#pragma once
#include "costmap/costmap.hpp"

namespace planner_core
{

class Planner
{
public:
  virtual ~Planner() = default;
  virtual void configure(
    rclcpp::Node::SharedPtr node, const std::string & name, std::shared_ptr<costmap::CostmapNode> costmap) = 0;
};

}  // namespace planner_core
