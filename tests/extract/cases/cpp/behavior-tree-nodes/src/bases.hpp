#pragma once
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include "behaviortree_cpp/action_node.h"

namespace trees
{
template<class ActionT>
class ActionNode : public BT::ActionNodeBase
{
public:
  ActionNode(const std::string & tag, const std::string & action, const BT::NodeConfiguration & conf)
  : BT::ActionNodeBase(tag, conf), action_(action)
  {
    node_ = config().blackboard->template get<rclcpp::Node::SharedPtr>("node");
    std::string other;
    if (getInput("server_name", other)) {
      action_ = other;
    }
    client_ = rclcpp_action::create_client<ActionT>(node_, action_);
  }

protected:
  std::string action_;
  rclcpp::Node::SharedPtr node_;
  typename rclcpp_action::Client<ActionT>::SharedPtr client_;
};

template<class ServiceT>
class ServiceNode : public BT::ActionNodeBase
{
public:
  ServiceNode(const std::string & tag, const BT::NodeConfiguration & conf, const std::string & service = "")
  : BT::ActionNodeBase(tag, conf), service_(service)
  {
    std::string given;
    getInput("service_name", given);
    given = given.empty() ? service_ : given;
    if (given.empty()) {
      throw std::runtime_error("no name");
    }
    if (given != service_ || !client_) {
      service_ = given;
      node_ = config().blackboard->template get<rclcpp::Node::SharedPtr>("node");
      client_ = node_->create_client<ServiceT>(service_);
    }
  }

protected:
  std::string service_;
  rclcpp::Node::SharedPtr node_;
  typename rclcpp::Client<ServiceT>::SharedPtr client_;
};
}
