#include "behaviortree_cpp/bt_factory.h"
#include "rclcpp/rclcpp.hpp"
#include "std_srvs/srv/trigger.hpp"

class Stop : public BT::SyncActionNode
{
public:
  Stop(const std::string & name, const BT::NodeConfig & config) : BT::SyncActionNode(name, config)
  {
    node_ = config.blackboard->get<rclcpp::Node::SharedPtr>("node");
    stop_ = node_->create_client<std_srvs::srv::Trigger>("stop");
  }

  BT::NodeStatus tick() override { return BT::NodeStatus::SUCCESS; }

private:
  rclcpp::Node::SharedPtr node_;
  rclcpp::Client<std_srvs::srv::Trigger>::SharedPtr stop_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("mission");
  node->declare_parameter("time_limit", 60);
  BT::BehaviorTreeFactory factory;
  factory.registerNodeType<Stop>("stop_robot");
  auto blackboard = BT::Blackboard::create();
  blackboard->set<rclcpp::Node::SharedPtr>("node", node);
  auto tree = factory.createTreeFromFile("mission.xml", blackboard);
  tree.tickWhileRunning();
}
