#include "costmap/costmap.hpp"
#include <std_msgs/msg/bool.hpp>

class Watcher
{
public:
  Watcher(rclcpp::Node * node, costmap::CostmapNode * costmap) : costmap_(costmap)
  {
    stale_ = node->create_publisher<std_msgs::msg::Bool>("stale", 1);
    if (costmap_) {
      costmap_->activate();
    }
  }

private:
  costmap::CostmapNode * costmap_;
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr stale_;
};

class Monitor : public rclcpp::Node
{
public:
  Monitor() : Node("monitor"), watcher_(this, nullptr) {}

  void use(const std::shared_ptr<costmap::CostmapNode> & costmap) { costmap_ = costmap; }

private:
  Watcher watcher_;
  std::shared_ptr<costmap::CostmapNode> costmap_;
  std::unique_ptr<costmap::CostmapNode> never_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Monitor>());
  return 0;
}
