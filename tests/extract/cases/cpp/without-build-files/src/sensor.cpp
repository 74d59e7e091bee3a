#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Sensor
{
public:
  Sensor()
  {
    publisher_ = nh_.advertise<std_msgs::Float64>("reading", 1);
  }

private:
  ros::NodeHandle nh_;
  ros::Publisher publisher_;
};

class Helper
{
  int number_;
};
