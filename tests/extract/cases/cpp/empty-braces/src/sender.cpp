#include <stdexcept>

#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

namespace
{

tl::expected<void, std::string> connected()
{
  return {};
}

std::string empty()
{
  return {};
}

std::shared_ptr<Driver> nothing()
{
  return {};
}

std::vector<std::string> no_names()
{
  return {};
}

class Sender : public rclcpp::Node
{
public:
  Sender()
  : Node("sender")
  {
    if (const auto result = connected(); !result) {
      throw std::runtime_error("no connection");
    }
    add("state" + empty());
    if (nothing()) {
      add("never");
    }
    for (const auto & name : no_names()) {
      add(name);
    }
    declare_parameter<std::string>("text", {});
    declare_parameter<int64_t>("count", {});
    declare_parameter<std::vector<std::string>>("names", {});
  }

private:
  void add(const std::string & name)
  {
    publishers_.push_back(create_publisher<std_msgs::msg::String>(name, 1));
  }

  std::vector<rclcpp::Publisher<std_msgs::msg::String>::SharedPtr> publishers_;
};

}  // namespace

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Sender>());
}
