#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>

bool ready = false;

void onReady(const std_msgs::Bool::ConstPtr & message)
{
  ready = message->data;
}

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "late_arm");
  ros::NodeHandle handle;
  ros::Subscriber subscriber = handle.subscribe("ready", 1, onReady);
  ros::Publisher publisher;
  ros::Rate rate(10);
  while (ros::ok()) {
    ros::spinOnce();
    if (ready) {
      publisher = handle.advertise<std_msgs::Float64>("angle", 1);
    }
    rate.sleep();
  }
}
