#include <ros/ros.h>
#include <std_msgs/String.h>

class Sender
{
public:
  Sender() : private_("~")
  {
    commands_ = handle_.subscribe("command", 1, &Sender::command, this);
    if (!topic_.empty() || ros::ok()) nothing_ = private_.subscribe(topic_, 1, &Sender::error, this);
  }

private:
  void command(const std_msgs::String::ConstPtr & message)
  {
    const std::string text = message->data;
    const auto colon = text.find(':');
    const std::string letter = colon == std::string::npos ? "" : text.substr(colon + 1);
    errors_ = handle_.subscribe<std_msgs::String>("error_" + letter, 1, &Sender::error, this);
    const std::string prefix = colon == std::string::npos ? "" : text.substr(0, colon);
    results_ = handle_.advertise<std_msgs::String>(prefix + "result", 1);
  }

  void error(const std_msgs::String::ConstPtr & message) {}

  std::string topic_ = "";
  ros::NodeHandle handle_, private_;
  ros::Subscriber commands_, errors_, nothing_;
  ros::Publisher results_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "sender");
  Sender sender;
  ros::spin();
}
