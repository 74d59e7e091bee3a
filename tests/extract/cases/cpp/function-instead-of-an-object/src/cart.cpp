#include <ros/ros.h>
#include <std_msgs/String.h>

class Cart
{
private:
  ros::NodeHandle nh_;
  ros::Publisher load_ = nh_.advertise<std_msgs::String>("load", 1);
};

class Wheel
{
public:
  explicit Wheel(ros::NodeHandle nh) { speed_ = nh.advertise<std_msgs::String>("speed", 1); }

private:
  ros::Publisher speed_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "cart");
  Cart cart();  // declares a function that returns a cart
  Wheel wheel(ros::NodeHandle("front"));
  ros::spin();
  return 0;
}
