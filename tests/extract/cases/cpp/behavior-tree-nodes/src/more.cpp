#include "bases.hpp"
#include <std_srvs/srv/empty.hpp>
#include <std_msgs/msg/string.hpp>

namespace trees
{
class Clear : public ServiceNode<std_srvs::srv::Empty>
{
public:
  Clear(const std::string & tag, const BT::NodeConfiguration & conf)
  : ServiceNode<std_srvs::srv::Empty>(tag, conf) {}
};

class Stop : public ServiceNode<std_srvs::srv::Empty>
{
public:
  Stop(const std::string & tag, const BT::NodeConfiguration & conf)
  : ServiceNode<std_srvs::srv::Empty>(tag, conf, "stop") {}
};

class Select : public BT::SyncActionNode
{
public:
  Select(const std::string & tag, const BT::NodeConfiguration & conf)
  : BT::SyncActionNode(tag, conf) {}

  static BT::PortsList providedPorts()
  {
    return {BT::InputPort<std::string>("topic", "selection", "the topic"), BT::InputPort<int>("times", "how often")};
  }

  BT::NodeStatus tick() override
  {
    getInput("topic", topic_);
    node_ = config().blackboard->get<rclcpp::Node::SharedPtr>("node");
    sub_ = node_->create_subscription<std_msgs::msg::String>(topic_, 10, [](std_msgs::msg::String::SharedPtr) {});
    return BT::NodeStatus::SUCCESS;
  }

private:
  std::string topic_;
  rclcpp::Node::SharedPtr node_;
  rclcpp::Subscription<std_msgs::msg::String>::SharedPtr sub_;
};

class IsThere : public BT::ConditionNode
{
public:
  IsThere(const std::string & tag, const BT::NodeConfiguration & conf)
  : BT::ConditionNode(tag, conf) {}
  BT::NodeStatus tick() override { return BT::NodeStatus::SUCCESS; }
};
}

#include "behaviortree_cpp/bt_factory.h"
BT_REGISTER_NODES(factory)
{
  factory.registerNodeType<trees::Clear>("Clear");
  factory.registerNodeType<trees::Stop>("Stop");
  factory.registerNodeType<trees::Select>("Select");
  factory.registerNodeType<trees::IsThere>("IsThere");
}
