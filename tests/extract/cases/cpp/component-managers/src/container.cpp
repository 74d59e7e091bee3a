#include <rclcpp_components/component_manager.hpp>
#include <std_srvs/srv/trigger.hpp>

class Container : public rclcpp_components::ComponentManager
{
public:
  explicit Container(std::weak_ptr<rclcpp::Executor> executor)
  : rclcpp_components::ComponentManager(executor, "container")
  {
    start_ = create_service<std_srvs::srv::Trigger>("~/start", [](auto, auto) {});
  }

private:
  rclcpp::Service<std_srvs::srv::Trigger>::SharedPtr start_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto executor = std::make_shared<rclcpp::executors::SingleThreadedExecutor>();
  executor->add_node(std::make_shared<Container>(executor));
  executor->spin();
}
