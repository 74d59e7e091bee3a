#include <pluginlib/class_list_macros.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <std_msgs/msg/string.hpp>

namespace layers
{
class Layer
{
public:
  void initialize(std::string name, rclcpp_lifecycle::LifecycleNode::WeakPtr node)
  {
    name_ = name;
    node_ = node;
    onInitialize();
  }
  virtual void onInitialize() {}
  virtual void activate() {}
  virtual void reset() {}

protected:
  std::string joinWithParentNamespace(const std::string & topic)
  {
    auto node = node_.lock();
    if (topic[0] != '/') {
      std::string node_namespace = node->get_namespace();
      std::string parent_namespace = node_namespace.substr(0, node_namespace.rfind("/"));
      return parent_namespace + "/" + topic;
    }
    return topic;
  }
  std::string name_;
  rclcpp_lifecycle::LifecycleNode::WeakPtr node_;
};

class Filter : public Layer
{
public:
  void onInitialize() override
  {
    auto node = node_.lock();
    node->declare_parameter<std::string>(name_ + ".info_topic");
    info_topic_ = node->get_parameter(name_ + ".info_topic").as_string();
  }
  void activate() override { initializeFilter(info_topic_); }
  void reset() override { initializeFilter(info_topic_); }
  virtual void initializeFilter(const std::string & info_topic) = 0;

protected:
  std::string info_topic_;
};

class Speed : public Filter
{
public:
  void initializeFilter(const std::string & info_topic) override
  {
    auto node = node_.lock();
    info_topic_ = joinWithParentNamespace(info_topic);
    info_ = node->create_subscription<std_msgs::msg::String>(info_topic_, 1, [](std_msgs::msg::String::SharedPtr) {});
  }

private:
  rclcpp::Subscription<std_msgs::msg::String>::SharedPtr info_;
};

class Static : public Layer
{
public:
  void onInitialize() override
  {
    auto node = node_.lock();
    std::string topic = node->declare_parameter<std::string>(name_ + ".map_topic", "map");
    topic = joinWithParentNamespace(topic);
    map_ = node->create_subscription<nav_msgs::msg::OccupancyGrid>(topic, 1, [](nav_msgs::msg::OccupancyGrid::SharedPtr) {});
  }

private:
  rclcpp::Subscription<nav_msgs::msg::OccupancyGrid>::SharedPtr map_;
};
}

PLUGINLIB_EXPORT_CLASS(layers::Speed, layers::Layer)
PLUGINLIB_EXPORT_CLASS(layers::Static, layers::Layer)
