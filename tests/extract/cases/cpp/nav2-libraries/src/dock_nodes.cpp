#include <behaviortree_cpp/bt_factory.h>
#include <nav2_behavior_tree/bt_action_node.hpp>
#include <nav2_behavior_tree/bt_service_node.hpp>
#include <nav2_msgs/action/dock_robot.hpp>
#include <std_srvs/srv/trigger.hpp>

class Dock : public nav2_behavior_tree::BtActionNode<nav2_msgs::action::DockRobot>
{
public:
  Dock(const std::string & tag, const std::string & action, const BT::NodeConfiguration & configuration)
  : nav2_behavior_tree::BtActionNode<nav2_msgs::action::DockRobot>(tag, action, configuration)
  {
  }
};

class Unlock : public nav2_behavior_tree::BtServiceNode<std_srvs::srv::Trigger>
{
public:
  Unlock(const std::string & name, const BT::NodeConfiguration & configuration)
  : BtServiceNode<std_srvs::srv::Trigger>(name, configuration, "unlock")
  {
  }
};

BT_REGISTER_NODES(factory)
{
  BT::NodeBuilder builder = [](const std::string & name, const BT::NodeConfiguration & configuration) {
      return std::make_unique<Dock>(name, "dock", configuration);
    };
  factory.registerBuilder<Dock>("Dock", builder);
  factory.registerNodeType<Unlock>("Unlock");
}
