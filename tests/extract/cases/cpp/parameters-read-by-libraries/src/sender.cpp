#include <ros/ros.h>
#include <rosparam_shortcuts/rosparam_shortcuts.h>
#include <settings_tools/parameters.h>
#include <std_msgs/String.h>

class Sender
{
public:
  explicit Sender(ros::NodeHandle & handle) : handle_(handle)
  {
    std::string topic = "status";
    settings_tools::SafeGetParam(handle_, "topic", topic);
    settings_tools::getParam(handle_, "sender/rate", rate_, 10.0);
    rosparam_shortcuts::get("sender", handle_, "joints", joints_);
    XmlRpc::XmlRpcValue list;
    handle_.getParam("list", list);
    settings_tools::getParam(list[0], "name", topic_);
    publisher_ = handle_.advertise<std_msgs::String>(topic, 1);
  }

private:
  ros::NodeHandle & handle_;
  double rate_;
  std::vector<std::string> joints_;
  std::string topic_;
  ros::Publisher publisher_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "sender");
  ros::NodeHandle handle("~");
  Sender sender(handle);
  ros::spin();
}
