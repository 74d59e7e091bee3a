#include <nav_msgs/MapMetaData.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/ros.h>
#include <string>

template<typename Number, typename Grid>
class Sender
{
public:
  explicit Sender(const std::string& topic) : topic_(topic) {}
  void init(ros::NodeHandle& nh)
  {
    sender_ = nh.advertise<Grid>(topic_, 1);
  }

private:
  std::string topic_;
  ros::Publisher sender_;
};

class Plain : public Sender<unsigned char, nav_msgs::OccupancyGrid>
{
public:
  using Sender<unsigned char, nav_msgs::OccupancyGrid>::Sender;
};

class Server
{
public:
  explicit Server() : sender_("map")
  {
    ros::NodeHandle nh;
    sender_.init(nh);
  }

private:
  Plain sender_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "server");
  Server server;
  ros::spin();
}
