#ifndef ROBOT__NODE_HPP_
#define ROBOT__NODE_HPP_

#include "rclcpp/rclcpp.hpp"
#include "rclcpp_lifecycle/lifecycle_node.hpp"

#define PLAIN 1
#define MANAGED 2
#define PARENT PLAIN

#if PARENT == PLAIN
#define PARENT_NODE rclcpp::Node
#elif PARENT == MANAGED
#define PARENT_NODE rclcpp_lifecycle::LifecycleNode
#endif

namespace robot
{
class Node : public PARENT_NODE
{
public:
  explicit Node(const std::string & name) : PARENT_NODE(name)
  {
    rate_ = read<double>("rate", 10.0);
  }

#if PARENT == MANAGED
  template<typename MessageT>
  void create_publisher(const std::string & name, int depth)
  {
    rclcpp::create_publisher<MessageT>(*this, "managed/" + name, depth);
  }
#endif

  // Returns a name without its first slash, if it has one.
  std::string global(const std::string & name)
  {
    if (name.find("/") == 0) {
      return name.substr(1);
    }
    return name;
  }

  template<typename T>
  T read(const std::string & name, const T & value)
  {
    if (!this->has_parameter(name)) {
      this->declare_parameter<T>(name, value);
    }
    return get<T>(name);
  }

private:
  template<typename T>
  T get(const std::string & name)
  {
    const rclcpp::Parameter found = this->get_parameter(name);
    return found.template get_value<T>();
  }

  double rate_;
};
}  // namespace robot

#endif  // ROBOT__NODE_HPP_
