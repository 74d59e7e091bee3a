#include <company/abstract_server.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_srvs/srv/empty.hpp>

class Server : public company::AbstractServer
{
public:
  explicit Server(const rclcpp::Node::SharedPtr & node)
  : company::AbstractServer(node)
  {
    clear_ = node_->create_service<std_srvs::srv::Empty>("~/clear", [](auto, auto) {});
  }

private:
  rclcpp::Service<std_srvs::srv::Empty>::SharedPtr clear_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("server");
  Server server(node);
  rclcpp::spin(node);
}
