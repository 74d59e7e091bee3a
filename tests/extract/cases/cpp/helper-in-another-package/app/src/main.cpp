#include <ros/ros.h>
#include <std_msgs/String.h>
#include <tools/listener.h>

class App
{
public:
  App() : listener_("odom") { publisher_ = node_.advertise<std_msgs::String>("state", 1); }

private:
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  tools::Listener listener_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "app");
  App app;
  ros::spin();
  return 0;
}
