#include <ros/ros.h>
#include <std_msgs/Bool.h>

ros::Publisher color, depth;
bool with_color, with_depth = true;
double rate;
std::string frame;

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "camera");
  ros::NodeHandle nh("~");
  ros::param::get("~with_color", with_color);
  ros::param::get("~with_depth", with_depth);
  ros::param::get("~rate", rate);
  ros::param::get("~frame", frame);
  if (with_color)
  {
    color = nh.advertise<std_msgs::Bool>("color", 1);
  }
  if (with_depth)
  {
    depth = nh.advertise<std_msgs::Bool>("depth", 1);
  }
  ros::spin();
}
