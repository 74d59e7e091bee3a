#include <string>
#include <vector>

#include <ros/ros.h>
#include <std_msgs/String.h>

bool names(ros::NodeHandle& nh, const std::string& parameter, std::vector<std::string>& found)
{
  XmlRpc::XmlRpcValue list;
  if (!nh.getParam(parameter, list)) {
    return false;
  }
  if (list.getType() == XmlRpc::XmlRpcValue::TypeArray) {
    found.resize(list.size());
    for (int i = 0; i < list.size(); ++i) {
      found[i] = static_cast<std::string>(list[i]);
    }
  } else {
    found.push_back(list);
  }
  return true;
}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "sender");
  ros::NodeHandle nh;
  std::vector<std::string> wheels, filled, known;
  if (!names(nh, "wheels", wheels)) {
    return 1;
  }
  if (wheels.size() != 2) {
    return 1;
  }
  ros::Publisher resized = nh.advertise<std_msgs::String>("resized", 1);
  XmlRpc::XmlRpcValue list;
  nh.getParam("list", list);
  for (int i = 0; i < list.size(); ++i) {
    filled.push_back(static_cast<std::string>(list[i]));
  }
  if (filled.size() == 3) {
    ros::Publisher pushed = nh.advertise<std_msgs::String>("pushed", 1);
  }
  known.resize(2, "known");
  if (known.size() == 3) {
    ros::Publisher never = nh.advertise<std_msgs::String>("never", 1);
  }
  ros::Publisher second = nh.advertise<std_msgs::String>(known[1], 1);
  std::vector<std::string> cameras;
  assertions::getParam(nh, "cameras", cameras);
  for (const auto & camera : cameras) {
    ros::Publisher image = nh.advertise<std_msgs::String>(camera + "/image", 1);
  }
  std::vector<std::string> sides;
  nh.getParam("sides", sides);
  for (const auto & side : sides) {
    const std::string prefix = side.empty() ? "" : side + "/";
    ros::Publisher pose = nh.advertise<std_msgs::String>(prefix + "pose", 1);
  }
  ros::spin();
}
