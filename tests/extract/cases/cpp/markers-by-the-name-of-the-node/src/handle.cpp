#include <interactive_markers/interactive_marker_server.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>

class Handle : public rclcpp::Node
{
public:
  explicit Handle(const std::string & name) : Node(name)
  {
    server_ = std::make_unique<interactive_markers::InteractiveMarkerServer>(get_name(), this);
  }

private:
  std::unique_ptr<interactive_markers::InteractiveMarkerServer> server_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Handle>(argv[1]));
}
