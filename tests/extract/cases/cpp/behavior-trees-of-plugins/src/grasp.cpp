#include <behaviortree_cpp/bt_factory.h>
#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/rclcpp.hpp>
#include <robot/skill.hpp>
#include <std_msgs/msg/float64.hpp>
#include <std_srvs/srv/trigger.hpp>

namespace skills {

class Close : public BT::SyncActionNode {
 public:
  Close(const std::string& name, const BT::NodeConfig& config, rclcpp::Node::SharedPtr node)
      : BT::SyncActionNode(name, config), node_(node) {}

  BT::NodeStatus tick() override {
    client_ = node_->create_client<std_srvs::srv::Trigger>("close");
    return BT::NodeStatus::SUCCESS;
  }

 private:
  rclcpp::Node::SharedPtr node_;
  rclcpp::Client<std_srvs::srv::Trigger>::SharedPtr client_;
};

// The program that loads the skill gives it its node and its factory.
class Grasping : public robot::Skill {
 public:
  void configure(rclcpp::Node::SharedPtr node, BT::BehaviorTreeFactory& factory) override {
    width_ = node->create_publisher<std_msgs::msg::Float64>("width", 1);
    factory.registerBuilder<Close>("grasping.Close", [node](const std::string& name, const BT::NodeConfig& config) {
      return std::make_unique<Close>(name, config, node);
    });
  }

 private:
  rclcpp::Publisher<std_msgs::msg::Float64>::SharedPtr width_;
};

}  // namespace skills

PLUGINLIB_EXPORT_CLASS(skills::Grasping, robot::Skill)
