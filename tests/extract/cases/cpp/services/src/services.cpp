#include <ros/ros.h>
#include <nav_msgs/GetMap.h>
#include <nav_msgs/GetPlan.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

bool reset(std_srvs::Empty::Request&, std_srvs::Empty::Response&)
{
  return true;
}

class Server
{
public:
  Server() : own_("~")
  {
    servers_.push_back(own_.advertiseService("reset", reset));
    servers_.push_back(own_.advertiseService("toggle", &Server::toggle, this));
    servers_.push_back(own_.advertiseService<std_srvs::TriggerRequest, std_srvs::TriggerResponse>(
        "trigger", boost::bind(&Server::trigger, this, _1, _2)));
    servers_.push_back(own_.advertiseService("bound", &Server::trigger, this));
    servers_.push_back(own_.advertiseService("event", &Server::event, this));
    servers_.push_back(own_.advertiseService<std_srvs::Empty::Request, std_srvs::Empty::Response>(
        "lambda", [](std_srvs::Empty::Request&, std_srvs::Empty::Response&) { return true; }));
    client_ = nh_.serviceClient<nav_msgs::GetMap>("static_map");
    planner_ = own_.serviceClient<nav_msgs::GetPlan>("plan", true);
  }

  void clear()
  {
    std_srvs::Empty request;
    ros::service::call("/clear", request);
    ros::service::waitForService("waited", 5000);
    std_srvs::Trigger trigger;
    if (ros::service::exists("present", false))
    {
      ros::service::call("asked", trigger);
    }
    auto switched = std_srvs::SetBool();
    ros::service::call("switch", switched);
  }

private:
  bool toggle(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);
  bool trigger(std_srvs::TriggerRequest& request, std_srvs::TriggerResponse& response)
  {
    return true;
  }
  bool event(ros::ServiceEvent<std_srvs::SetBool::Request, std_srvs::SetBool::Response>& event)
  {
    return true;
  }
  ros::NodeHandle nh_, own_;
  std::vector<ros::ServiceServer> servers_;
  ros::ServiceClient client_, planner_;
};

bool Server::toggle(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response)
{
  return true;
}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "services");
  Server server;
  server.clear();
  ros::spin();
}
