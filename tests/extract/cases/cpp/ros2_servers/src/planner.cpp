#include "simple_server.hpp"

#include <demo_interfaces/action/plan.hpp>
#include <demo_interfaces/action/follow.hpp>

namespace servers
{
class Planner : public rclcpp::Node
{
  using PlanServer = SimpleServer<demo_interfaces::action::Plan>;
  using FollowServer = SimpleServer<demo_interfaces::action::Follow>;

public:
  Planner() : Node("planner")
  {
    using namespace std::string_literals;
    plan_ = std::make_unique<PlanServer>(shared_from_this(), "plan", true);
    follow_ = std::make_unique<FollowServer>(shared_from_this(), "follow"s + "_path"s, true);
  }

private:
  std::unique_ptr<PlanServer> plan_;
  std::unique_ptr<FollowServer> follow_;
};
}  // namespace servers

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<servers::Planner>());
}
