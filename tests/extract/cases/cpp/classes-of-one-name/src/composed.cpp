#include "case/talker.hpp"

int main(int argc, char** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Talker>(rclcpp::NodeOptions()));
}
