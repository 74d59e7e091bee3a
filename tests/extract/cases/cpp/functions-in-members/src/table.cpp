#include <functional>
#include <map>
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <vector>

struct Row
{
  std::string topic;
  std::function<void(ros::NodeHandle&, const std::string&)> make;
};

static const std::map<std::string, std::function<std::string(int)>> NAMES = {
  { "wheel", [](int index) { return "wheel_" + std::to_string(index); } }
};

class Table
{
public:
  Table()
  {
    Row single{ "single", [this](ros::NodeHandle& nh, const std::string& topic) { one_ = nh.advertise<std_msgs::String>(topic, 1); } };
    single.make(nh_, single.topic);
    const std::vector<Row> rows = {
      { "listed", [this](ros::NodeHandle& nh, const std::string& topic) { one_ = nh.advertise<std_msgs::String>(topic, 1); } }
    };
    for (const auto& row : rows)
      row.make(nh_, row.topic);
    auto found = NAMES.find("wheel");
    if (found != NAMES.end())
      one_ = nh_.advertise<std_msgs::String>(found->second(3), 1);
  }

private:
  ros::NodeHandle nh_;
  ros::Publisher one_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "table");
  Table table;
  ros::spin();
}
