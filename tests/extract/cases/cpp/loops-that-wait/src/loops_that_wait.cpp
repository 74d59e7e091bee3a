#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>

class Settings
{
public:
  Settings(ros::NodeHandle & nh, const std::string & service) : nh_(nh), received_(false), service_(service)
  {
    updates_ = nh_.subscribe("server/updates", 1, &Settings::on_update, this);
    while (received_ == false)
    {
      ros::spinOnce();
      ros::Duration(0.5).sleep();
    }
  }

  bool set()
  {
    if (received_ == false)
    {
      return false;
    }
    dynamic_reconfigure::Reconfigure::Request request;
    dynamic_reconfigure::Reconfigure::Response response;
    return ros::service::call(service_, request, response);
  }

private:
  void on_update(const dynamic_reconfigure::Config & message)
  {
    received_ = true;
  }

  ros::NodeHandle nh_;
  ros::Subscriber updates_;
  bool received_;
  std::string service_;
};

bool ready = false;

void on_ready(const std_msgs::Bool &) { ready = true; }

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "waiter");
  ros::NodeHandle nh;
  Settings settings(nh, "server/set_parameters");
  settings.set();
  ros::Subscriber wait = nh.subscribe("ready", 1, on_ready);
  while (ros::ok() && !ready)
  {
    ros::spinOnce();
  }
  if (!ready)
  {
    return 1;
  }
  bool done = false;
  while (!done)
  {
    done = true;
  }
  ros::Publisher late = nh.advertise<std_msgs::Bool>(done ? "after" : "never", 1);
  ros::spin();
}
