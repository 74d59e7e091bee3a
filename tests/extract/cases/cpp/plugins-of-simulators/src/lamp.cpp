#include <gazebo/common/Plugin.hh>
#include <gazebo_ros/node.hpp>
#include <std_msgs/msg/bool.hpp>

namespace demo {

class Lamp : public gazebo::ModelPlugin {
 public:
  void Load(gazebo::physics::ModelPtr model, sdf::ElementPtr sdf) override {
    node_ = gazebo_ros::Node::Get(sdf);
    light_ = node_->create_subscription<std_msgs::msg::Bool>("light", 1, [](std_msgs::msg::Bool::SharedPtr) {});
  }

 private:
  gazebo_ros::Node::SharedPtr node_;
  rclcpp::Subscription<std_msgs::msg::Bool>::SharedPtr light_;
};

GZ_REGISTER_MODEL_PLUGIN(Lamp)

}  // namespace demo
