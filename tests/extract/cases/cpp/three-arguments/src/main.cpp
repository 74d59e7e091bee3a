#include <ros/ros.h>
#include <std_msgs/String.h>

#include <string>
#include <vector>

class Filter
{
public:
  Filter(ros::NodeHandle nh, ros::NodeHandle own, std::string name, std::vector<double> gains);
  Filter(ros::NodeHandle nh, ros::NodeHandle own, std::vector<double> gains);

private:
  void got(const std_msgs::String::ConstPtr & message);
  ros::NodeHandle nh_;
  ros::NodeHandle own_;
  ros::Subscriber subscriber_;
  ros::Publisher publisher_;
};

Filter::Filter(ros::NodeHandle nh, ros::NodeHandle own, std::string name, std::vector<double> gains)
: nh_(nh), own_(own)
{
  std::string topic;
  own_.getParam("source", topic);
  subscriber_ = nh_.subscribe(topic, 1, &Filter::got, this);
  publisher_ = own_.advertise<std_msgs::String>("state", 1);
}

Filter::Filter(ros::NodeHandle nh, ros::NodeHandle own, std::vector<double> gains)
: Filter(nh, own, "filter", gains)
{
}

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "filter");
  ros::NodeHandle nh;
  ros::NodeHandle own("~");
  std::vector<double> gains(3, 0);
  Filter filter(nh, own, gains);
  ros::spin();
  return 0;
}
