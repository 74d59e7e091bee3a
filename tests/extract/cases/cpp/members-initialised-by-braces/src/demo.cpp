#include <ros/ros.h>
#include <std_msgs/Int32.h>
#include <string>
#include <vector>

class Bus
{
public:
  static constexpr int DEFAULT_ID{6};
  static constexpr double RATE{1.5};
  static constexpr auto TOPIC{"state"};
  static inline const std::string FRAME{"base"};
  static inline const std::vector<std::string> JOINTS{"one"};
  static constexpr int PINS[]{7};

  void read(ros::NodeHandle& nh)
  {
    int id{DEFAULT_ID};
    double rate{RATE};
    std::string frame = FRAME;
    nh.getParam("id", id);
    nh.getParam("rate", rate);
    nh.getParam("frame", frame);
    pub_ = nh.advertise<std_msgs::Int32>(TOPIC, 1);
    for (const auto& joint : JOINTS)
      subs_.push_back(nh.advertise<std_msgs::Int32>(joint, 1));
    for (int pin : PINS)
      subs_.push_back(nh.advertise<std_msgs::Int32>("pin" + std::to_string(pin), 1));
  }

private:
  ros::Publisher pub_;
  std::vector<ros::Publisher> subs_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "demo");
  ros::NodeHandle nh;
  Bus bus;
  bus.read(nh);
  ros::spin();
}
