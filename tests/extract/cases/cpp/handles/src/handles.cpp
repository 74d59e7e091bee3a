#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Int32.h>
#include <std_msgs/String.h>

void announce(ros::NodeHandle& handle)
{
  static ros::Publisher publisher = handle.advertise<std_msgs::Bool>("passed", 1);
}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "pose_keeper");
  ros::NodeHandle nh;
  ros::NodeHandle own("~");
  ros::Publisher a = nh.advertise<std_msgs::String>("relative", 1);
  ros::Publisher b = own.advertise<std_msgs::String>("private", 1);
  ros::Publisher c = own.advertise<std_msgs::String>("/absolute", 1);

  ros::NodeHandle arm("arm"), own_arm("~arm"), own_left(own_arm, "left"), rooted("/arm");
  ros::Publisher d = arm.advertise<std_msgs::Int32>("joint", 1);
  ros::Publisher e = own_arm.advertise<std_msgs::Int32>("joint", 1);
  ros::Publisher f = own_left.advertise<std_msgs::Int32>("joint", 1);
  ros::Publisher g = rooted.advertise<std_msgs::Int32>("joint", 1);

  ros::NodeHandle copy(nh);
  boost::shared_ptr<ros::NodeHandle> pointer(new ros::NodeHandle("~"));
  ros::Publisher h = copy.advertise<std_msgs::Bool>("copied", 1);
  ros::Publisher i = pointer->advertise<std_msgs::Bool>("pointed", 1, true);
  ros::Publisher j = ros::NodeHandle("~").advertise<std_msgs::Bool>("temporary", 1);
  announce(own);

  const std::string base = "base";
  ros::Publisher k = ros::NodeHandle(nh, base).advertise<std_msgs::Bool>("named", 1);
  ros::spin();
}
