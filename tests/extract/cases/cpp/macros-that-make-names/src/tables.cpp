#include <ros/ros.h>
#include <std_msgs/String.h>

#define GET(name, value) private_.param(#name, name, value)
#define DECLARE(name, value) std::string name = private_.param<std::string>(#name, value)
#define ADVERTISE(name) name##_publisher = handle.advertise<std_msgs::String>(#name, 1)

typedef void (*Setup)(ros::NodeHandle &);

void lamp(ros::NodeHandle & handle)
{
  static ros::Publisher publisher = handle.advertise<std_msgs::String>("lamp", 1);
}

void horn(ros::NodeHandle & handle)
{
  static ros::Publisher publisher = handle.advertise<std_msgs::String>("horn", 1);
}

struct Device
{
  const char * topic;
  Setup setup;
};

static const Device DEVICES[] = {{"lamp_state", lamp}, {"horn_state", horn}};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "tables");
  ros::NodeHandle handle, private_("~");
  int rate;
  GET(rate, 10);
  DECLARE(output, "out");
  ros::Publisher publisher = handle.advertise<std_msgs::String>(output, 1);
  ros::Publisher status_publisher;
  ADVERTISE(status);
  for (size_t i = 0; i < sizeof(DEVICES) / sizeof(DEVICES[0]); i++) {
    publisher = handle.advertise<std_msgs::String>(DEVICES[i].topic, 1);
    DEVICES[i].setup(handle);
  }
  status_publisher.publish(std_msgs::String());
  ros::spin();
}
