#include <ros/ros.h>
#include <std_msgs/String.h>

typedef std::string DEMO_TEXT;

namespace demo
{
class Sender
{
public:
  ROS_DEPRECATED explicit Sender(const std::string & prefix);
  void open();
  DEMO_TEXT name();

private:
  ros::NodeHandle node_;
  std::string prefix_;
  ros::Publisher first_, second_, third_;
};

ROS_DEPRECATED Sender::Sender(const std::string & prefix) :
  node_("~"), prefix_(prefix)
{
  first_ = node_.advertise<std_msgs::String>(prefix_ + "first", 1);
  open();
}

DEMO_NO_INLINE void Sender::open()
{
  second_ = node_.advertise<std_msgs::String>(prefix_ + "second", 1);
  third_ = node_.advertise<std_msgs::String>(name(), 1);
}

DEMO_TEXT Sender::name()
{
  return prefix_ + "third";
}
}

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "sender");
  demo::Sender sender("old_");
  ros::spin();
}
