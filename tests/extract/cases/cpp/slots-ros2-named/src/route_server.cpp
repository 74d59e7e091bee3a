#include <memory>
#include <string>
#include <vector>

#include <pluginlib/class_loader.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

template<typename NodeT>
void declare_if_missing(NodeT node, const std::string & name, const rclcpp::ParameterValue & value)
{
  if (!node->has_parameter(name)) {
    node->declare_parameter(name, value);
  }
}

template<typename NodeT>
std::string class_of(NodeT node, const std::string & name)
{
  std::string found;
  if (!node->get_parameter(name + ".plugin", found)) {
    throw std::runtime_error("no class");
  }
  return found;
}

namespace routes
{
class Route;
class Guard;

class RouteServer : public rclcpp_lifecycle::LifecycleNode
{
public:
  RouteServer()
  : LifecycleNode("route_server"),
    routes_("routes", "routes::Route"),
    default_ids_{"ShortRoute", "SafeRoute"},
    default_types_{"routes::Short", "routes::Safe"}
  {
  }

  CallbackReturn on_configure(const rclcpp_lifecycle::State &) override
  {
    auto node = shared_from_this();
    declare_if_missing(node, "route_plugins", rclcpp::ParameterValue(default_ids_));
    get_parameter("route_plugins", ids_);
    if (ids_ == default_ids_) {
      for (size_t i = 0; i < default_ids_.size(); ++i) {
        declare_if_missing(node, default_ids_[i] + ".plugin", rclcpp::ParameterValue(default_types_[i]));
      }
    }
    types_.resize(ids_.size());
    for (size_t i = 0; i != ids_.size(); i++) {
      types_[i] = class_of(node, ids_[i]);
      auto route = routes_.createUniqueInstance(types_[i]);
      route->configure(node, ids_[i]);
    }
    for (const auto & id : declare_parameter("guard_plugins", std::vector<std::string>{})) {
      guards_.push_back(guard_loader_.createSharedInstance(class_of(node, id)));
    }
    return CallbackReturn::SUCCESS;
  }

private:
  pluginlib::ClassLoader<Route> routes_;
  pluginlib::ClassLoader<Guard> guard_loader_{"routes", "routes::Guard"};
  std::vector<std::shared_ptr<Guard>> guards_;
  std::vector<std::string> default_ids_;
  std::vector<std::string> default_types_;
  std::vector<std::string> ids_;
  std::vector<std::string> types_;
};
}  // namespace routes

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<routes::RouteServer>();
  rclcpp::spin(node->get_node_base_interface());
}
