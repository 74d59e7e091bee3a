#include <ros/ros.h>
#include <std_msgs/String.h>

class Sender
{
public:
  Sender() { commands_ = handle_.subscribe("command", 1, &Sender::command, this); }

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

  ros::NodeHandle handle_;
  ros::Subscriber commands_, errors_;
  ros::Publisher results_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "sender");
  Sender sender;
  ros::spin();
}
