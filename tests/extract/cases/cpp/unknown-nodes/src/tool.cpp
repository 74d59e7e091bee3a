#include <company/hub.hpp>
#include <rclcpp/rclcpp.hpp>

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("tool");
  company::hub()->create_client<company::Account>("nobody");
  rclcpp::spin(node);
}
