#include "listener.hpp"
#include <std_msgs/Bool.h>
#include <std_msgs/Float32.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>
#include <std_msgs/Int64.h>
#include <std_msgs/String.h>
#include <std_msgs/UInt16.h>
#include <std_msgs/UInt32.h>
#include <std_msgs/UInt8.h>

void function(const std_msgs::String::ConstPtr& text) {}
void pointer(std_msgs::Int32ConstPtr number) {}
void reference(const std_msgs::Int64& number) {}
void shared(const boost::shared_ptr<std_msgs::UInt8 const>& number) {}
void standard(const std::shared_ptr<const std_msgs::UInt16> number) {}
void value(std_msgs::UInt32 number) {}
void event(const ros::MessageEvent<std_msgs::Bool const>& event) {}
void options(const std_msgs::Float32ConstPtr& number) {}

struct Handler
{
  void operator()(const std_msgs::Float64ConstPtr& number) const {}
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "callbacks");
  ros::NodeHandle nh;
  Listener listener(nh);
  ros::Subscriber a = nh.subscribe("function", 1, function);
  ros::Subscriber b = nh.subscribe("pointer", 1, &pointer);
  ros::Subscriber c = nh.subscribe("reference", 1, reference);
  ros::Subscriber d = nh.subscribe("shared", 1, shared);
  ros::Subscriber e = nh.subscribe("standard", 1, standard);
  ros::Subscriber f = nh.subscribe("value", 1, value, ros::TransportHints().tcpNoDelay());
  ros::Subscriber g = nh.subscribe("event", 1, event);
  ros::SubscribeOptions options_of_it;
  options_of_it.init<std_msgs::Float32>("options", 1, options);
  ros::Subscriber h = nh.subscribe(options_of_it);
  ros::Subscriber i = nh.subscribe<std_msgs::Float64>("object", 1, Handler());
  ros::spin();
}
