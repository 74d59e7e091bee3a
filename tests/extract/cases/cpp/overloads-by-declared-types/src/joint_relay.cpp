#include <map>
#include <string>
#include <vector>

#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

// Defined in a library that is not part of the sources.
bool readGroups(const std::string & name, std::map<int, std::string> & groups);
bool readJoints(const std::string & name, std::vector<std::string> & joints);

class JointRelay
{
public:
  void init(const std::map<int, std::string> & groups);
  void init(const std::vector<std::string> & joints);

private:
  ros::NodeHandle handle_;
  ros::Publisher publisher_;
};

void JointRelay::init(const std::map<int, std::string> & groups)
{
  publisher_ = handle_.advertise<sensor_msgs::JointState>("group_states", groups.size());
}

void JointRelay::init(const std::vector<std::string> & joints)
{
  publisher_ = handle_.advertise<sensor_msgs::JointState>("joint_states", joints.size());
}

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "joint_relay");
  JointRelay relay;
  std::map<int, std::string> groups;
  if (readGroups("groups", groups)) {
    relay.init(groups);
  } else {
    std::vector<std::string> joints;
    readJoints("joints", joints);
    relay.init(joints);
  }
  ros::spin();
}
