#include <rclcpp/rclcpp.hpp>

class Sender : public rclcpp::Node
{
public:
  Sender()
  : Node("sender")
  {
    const std::string other = "/painter";
    first_ = std::make_shared<rclcpp::AsyncParametersClient>(this, other);
    const auto any = declare_parameter<std::string>("any");
    second_ = std::make_shared<rclcpp::SyncParametersClient>(this, any);
  }

private:
  rclcpp::AsyncParametersClient::SharedPtr first_;
  rclcpp::SyncParametersClient::SharedPtr second_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Sender>());
}
