#include "bases.hpp"
#include <nav2_msgs/action/follow_path.hpp>

namespace trees
{
class Drive : public ActionNode<nav2_msgs::action::FollowPath>
{
public:
  Drive(const std::string & tag, const std::string & action, const BT::NodeConfiguration & conf)
  : ActionNode<nav2_msgs::action::FollowPath>(tag, action, conf) {}
};
}

#include "behaviortree_cpp/bt_factory.h"
BT_REGISTER_NODES(factory)
{
  BT::NodeBuilder builder =
    [](const std::string & name, const BT::NodeConfiguration & config)
    {
      return std::make_unique<trees::Drive>(name, "follow_path", config);
    };
  factory.registerBuilder<trees::Drive>("DriveAlong", builder);
}
