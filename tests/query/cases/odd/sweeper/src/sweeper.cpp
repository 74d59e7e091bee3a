#include <pluginlib/class_loader.hpp>

#include "sweeper/path.hpp"

class Sweeper : public rclcpp::Node
{
public:
  Sweeper() : Node("sweeper"), paths_("sweeper", "sweeper::Path"), alarms_("sweeper", "sweeper::Alarm")
  {
    declare_parameter("floor.plugin", "sweeper::Spiral");
    for (const auto & name : declare_parameter("paths", std::vector<std::string>{"floor"})) {
      path_ = paths_.createUniqueInstance(get_parameter(name + ".plugin").as_string());
    }
    alarm_ = alarms_.createSharedInstance("sweeper::Loud");
  }

private:
  pluginlib::ClassLoader<sweeper::Path> paths_;
  pluginlib::ClassLoader<sweeper::Alarm> alarms_;
  pluginlib::UniquePtr<sweeper::Path> path_;
  std::shared_ptr<sweeper::Alarm> alarm_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Sweeper>());
}
