#include "layers/stack.hpp"

class Server : public rclcpp::Node
{
public:
  Server() : Node("server"), stack_(std::make_shared<layers::Stack>("inner")) {}

private:
  std::shared_ptr<layers::Stack> stack_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Server>());
}
