#include <bus/driver.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/string.hpp>

namespace drivers
{
template <class N>
class Part : public bus::Part<N>
{
public:
  explicit Part(N * node) : bus::Part<N>(node), node_(node) {}
  void init(bool from_base) override {state_ = node_->template create_publisher<std_msgs::msg::String>("state", 1);}

private:
  N * node_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr state_;
};

class Aside : public bus::Aside
{
public:
  explicit Aside(rclcpp::Node * node) : node_(node) {}
  void init() override {node_->create_publisher<std_msgs::msg::Bool>("aside", 1);}

private:
  rclcpp::Node * node_;
};

class Driver : public bus::Driver
{
public:
  explicit Driver(rclcpp::NodeOptions options) : bus::Driver(options)
  {
    own_ = std::make_shared<Part<rclcpp::Node>>(this);
    part_of_the_base_ = std::static_pointer_cast<bus::Interface>(own_);
    aside_ = std::make_shared<Aside>(this);
  }

private:
  std::shared_ptr<Part<rclcpp::Node>> own_;
  std::shared_ptr<Aside> aside_;
};
}  // namespace drivers

RCLCPP_COMPONENTS_REGISTER_NODE(drivers::Driver)
