#include <ros/ros.h>
#include <XmlRpcValue.h>

int main(int argc, char** argv)
{
  ros::init(argc, argv, "parameters");
  ros::NodeHandle nh;
  ros::NodeHandle own("~");
  double rate;
  own.param("rate", rate, 10.0);
  std::string frame = own.param<std::string>("frame", "base_link");
  int count = own.param("count", 3);
  bool verbose;
  own.param<bool>("verbose", verbose, true);
  std::vector<double> gains;
  own.getParam("gains", gains);
  XmlRpc::XmlRpcValue table;
  own.getParam("table", table);
  std::string description;
  if (nh.getParam("robot_description", description))
  {
    ROS_INFO("described");
  }
  std::string mode;
  ros::param::param<std::string>("~mode", mode, "on");
  if (nh.hasParam("/use_sim_time"))
  {
    own.setParam("started", true);
  }
  ros::NodeHandle limits(own, "limits");
  double upper = limits.param("upper", 1e-3), lower;
  limits.param("lower", lower, -2.5);
  std::string key;
  nh.searchParam("tf_prefix", key);
  int value = count + 1;
  ros::param::set("/shared/value", value);
  own.deleteParam("old");
  std::string direct;
  ros::param::param("~direct", direct, std::string("x"));
  int cached;
  own.getParamCached("cached", cached);
}
