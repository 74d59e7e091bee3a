#include <gz/plugin/Register.hh>
#include <gz/sim/System.hh>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

namespace demo {

class Thruster : public gz::sim::System, public gz::sim::ISystemConfigure {
 public:
  void Configure(const gz::sim::Entity& entity, const std::shared_ptr<const sdf::Element>& sdf,
                 gz::sim::EntityComponentManager& components, gz::sim::EventManager& events) override {
    node_ = std::make_shared<rclcpp::Node>("thruster");
    thrust_ = node_->create_subscription<std_msgs::msg::Float64>("thrust", 1, [](std_msgs::msg::Float64::SharedPtr) {});
  }

 private:
  rclcpp::Node::SharedPtr node_;
  rclcpp::Subscription<std_msgs::msg::Float64>::SharedPtr thrust_;
};

}  // namespace demo

GZ_ADD_PLUGIN(demo::Thruster, gz::sim::System, demo::Thruster::ISystemConfigure)
