#include <ros/ros.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Bool.h>
#include <std_msgs/String.h>

class Publishers
{
public:
  Publishers() : own_("~"), odom_topic_("odom")
  {
    own_.param("topic", topic_, std::string("scan"));
    own_.getParam("odom_topic", odom_topic_);
    publishers_.push_back(nh_.advertise<sensor_msgs::LaserScan>(topic_, 1));
    publishers_.push_back(nh_.advertise<nav_msgs::Odometry>(odom_topic_, 1));
    start();
  }

private:
  void start()
  {
    std::string cloud = own_.param<std::string>("cloud_topic", "cloud");
    publishers_.push_back(nh_.advertise<sensor_msgs::PointCloud2>(cloud, 1));
    std::string imu;
    own_.getParam("imu_topic", imu);
    publishers_.push_back(nh_.advertise<sensor_msgs::Imu>(imu, 1));
    std::string prefix;
    ros::param::get("~prefix", prefix);
    publishers_.push_back(nh_.advertise<nav_msgs::Path>(prefix + "/path", 1));
    std::string robot;
    nh_.param<std::string>("robot", robot, "robot1");
    ros::NodeHandle named(own_, robot);
    publishers_.push_back(named.advertise<nav_msgs::OccupancyGrid>("map", 1));
    std::string chosen;
    if (!own_.getParam("chosen", chosen))
    {
      chosen = "fallback";
    }
    publishers_.push_back(nh_.advertise<std_msgs::String>(chosen, 1));
  }

  ros::NodeHandle nh_, own_;
  std::string topic_, odom_topic_;
  std::vector<ros::Publisher> publishers_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "names_from_parameters");
  Publishers publishers;
  ros::NodeHandle nh;
  ros::Publisher given = nh.advertise<std_msgs::Bool>(argv[1], 1);
  ros::spin();
}
