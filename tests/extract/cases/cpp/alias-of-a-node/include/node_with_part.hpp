#pragma once
#include <memory>
#include <rclcpp/rclcpp.hpp>

template <typename PartT>
class NodeWithPart : public rclcpp::Node {
 public:
  explicit NodeWithPart(const std::string& name) : Node(name) { part_ = std::make_unique<PartT>(*this); }

 private:
  std::unique_ptr<PartT> part_;
};
