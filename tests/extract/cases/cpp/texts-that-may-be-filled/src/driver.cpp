#include <cmath>
#include <json/json.h>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

struct Info
{
  bool failed = false;
  std::string protocol;
};

class Device
{
public:
  Info read()
  {
    Info info;
    int32_t code;
    query(info.protocol, code);
    return info;
  }

private:
  void query(std::string & protocol, int32_t & code)
  {
    Json::Value answer = http_->get("info");
    code = answer["code"].asInt();
    if (code == 0) {
      protocol = answer["protocol"].asString();
    }
  }
  std::shared_ptr<Http> http_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("driver");
  node->declare_parameter("angle", M_PI / 2);
  Device device;
  auto info = device.read();
  if (info.failed) {
    return 1;
  }
  if (info.protocol != "scanner") {
    return 1;
  }
  auto name = std::string(node->get_namespace()) + node->get_name() + "/scan";
  auto publisher = node->create_publisher<std_msgs::msg::String>(name, 1);
  rclcpp::spin(node);
}
