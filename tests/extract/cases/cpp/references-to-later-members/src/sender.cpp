#include <ros/ros.h>
#include <std_msgs/String.h>

class Settings
{
public:
  explicit Settings(ros::NodeHandle & handle) : handle_(handle) {}

  void read() { handle_.param<std::string>("topic", topic, "status"); }

  std::string topic;

private:
  ros::NodeHandle & handle_;
};

class Output
{
public:
  explicit Output(ros::NodeHandle * handle) : handle_(handle) {}

  void open() { publisher_ = handle_->advertise<std_msgs::String>("output", 1); }

private:
  ros::NodeHandle * handle_;
  ros::Publisher publisher_;
};

class Sender
{
public:
  Sender() : settings_(private_), output_(&handle_), handle_("arm"), private_("~")
  {
    settings_.read();
    output_.open();
    publisher_ = handle_.advertise<std_msgs::String>(settings_.topic, 1);
  }

private:
  Settings settings_;
  Output output_;
  ros::NodeHandle handle_;
  ros::NodeHandle private_;
  ros::Publisher publisher_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "sender");
  Sender sender;
  ros::spin();
}
