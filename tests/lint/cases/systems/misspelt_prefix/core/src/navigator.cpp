#include <memory>
#include <string>

#include "rclcpp/rclcpp.hpp"

class Stage
{
public:
  explicit Stage(const std::string & name) : name_(name) {}

  std::string title() const { return name_; }

  void configure(rclcpp::Node & node)
  {
    speed_ = node.declare_parameter(title() + ".speed", 0.5);
    window_ = node.declare_parameter(title() + "window", 2.0);
  }

private:
  std::string name_;
  double speed_;
  double window_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("navigator");
  Stage stage("drive_to");
  stage.configure(*node);
  rclcpp::spin(node);
}
