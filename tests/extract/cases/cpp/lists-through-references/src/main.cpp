#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <string>

namespace values
{
typedef XmlRpc::XmlRpcValue List;
typedef XmlRpc::XmlRpcValue Struct;

template <class T>
void fetch(ros::NodeHandle own, const std::string& name, T& output)
{
  XmlRpc::XmlRpcValue found;
  if (!own.getParam(name, found))
  {
    throw ros::Exception(name);
  }
  output = static_cast<T>(found);
}

template <class T>
void item(List& of, int index, T& output)
{
  output = static_cast<T>(of[index]);
}

template <class T>
void member(Struct& of, const std::string& name, T& output)
{
  output = static_cast<T>(of[name]);
}
}  // namespace values

int main(int argc, char** argv)
{
  ros::init(argc, argv, "lists_through_references");
  ros::NodeHandle nh, own("~");
  values::List listed;
  values::fetch(own, "inputs", listed);
  values::Struct one;
  std::string topic;
  for (int i = 0; i < listed.size(); ++i)
  {
    values::item(listed, i, one);
    values::member(one, "topic", topic);
    ros::Publisher publisher = nh.advertise<std_msgs::Bool>(topic, 1);
  }
  ros::spin();
}
