#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

class Main : public rclcpp::Node
{
public:
  Main() : Node("this_one") {instance_ = this;}
  static Main * get() {return instance_;}

private:
  static Main * instance_;
};

Main * Main::instance_ = nullptr;

class User
{
public:
  User()
  {
    if (Main::get()) {
      sent_ = Main::get()->create_publisher<std_msgs::msg::String>("used", 1);
    }
  }

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr sent_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<Main>();
  User user;
  rclcpp::spin(node);
}
