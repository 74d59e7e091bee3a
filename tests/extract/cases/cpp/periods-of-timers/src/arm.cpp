#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Arm
{
public:
  Arm()
  {
    timer_ = nh_.createTimer(ros::Duration(period_), &Arm::tick, this);
  }

private:
  void tick(const ros::TimerEvent&)
  {
    bool compensated;
    nh_.param("compensated", compensated, false);
    if (!torque_) {
      torque_ = nh_.advertise<std_msgs::Float64>("torque", 1);
    }
  }

  ros::NodeHandle nh_;
  ros::Timer timer_;
  ros::Publisher torque_;
  double period_ = 0.1;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "arm");
  Arm arm;
  ros::spin();
}
