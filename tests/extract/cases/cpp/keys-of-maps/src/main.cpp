#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/String.h>
#include <map>
#include <string>

int main(int argc, char** argv)
{
  ros::init(argc, argv, "keys_of_maps");
  ros::NodeHandle nh, own("~");
  XmlRpc::XmlRpcValue ranks;
  own.param("ranks", ranks, ranks);
  std::map<std::string, int> order;
  std::map<std::string, XmlRpc::XmlRpcValue>::iterator entry;
  for (entry = ranks.begin(); entry != ranks.end(); ++entry)
  {
    order[entry->first] = static_cast<int>(entry->second);
    ros::Publisher alarm = nh.advertise<std_msgs::Bool>(static_cast<std::string>(entry->second["alarm"]), 1);
  }
  for (auto& one : order)
  {
    ros::Publisher said = nh.advertise<std_msgs::String>(one.first + "/said", 1);
  }
  std::map<rs2_stream, std::string> names;
  names[RS2_STREAM_DEPTH] = "depth";
  names[RS2_STREAM_COLOR] = "color";
  ros::Publisher depth = nh.advertise<std_msgs::Bool>(names[RS2_STREAM_DEPTH] + "/ready", 1);
  ros::spin();
}
