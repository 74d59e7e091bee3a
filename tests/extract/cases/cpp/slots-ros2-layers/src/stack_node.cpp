#include "layers/stack.hpp"

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<layers::Stack>("stack"));
}
