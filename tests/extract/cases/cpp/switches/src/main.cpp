#include <nav_msgs/OccupancyGrid.h>
#include <ros/ros.h>
#include <std_msgs/String.h>

class Localizer
{
public:
  Localizer() : use_map_topic_(false), changed_(false)
  {
    ros::NodeHandle pnh("~");
    pnh.param("use_map_topic", use_map_topic_, false);
    pnh.param<bool>("quiet", quiet_, true);
    pnh.param("changed", changed_, false);
    bool debug = pnh.param("debug", false);
    if (use_map_topic_)
      map_ = nh_.subscribe("map", 1, &Localizer::map, this);
    else
      grid_ = nh_.subscribe("grid", 1, &Localizer::map, this);
    if (!quiet_ && debug)
      words_ = nh_.advertise<std_msgs::String>("words", 1);
    changed_ = words_.getNumSubscribers() > 0;
    if (changed_)
      more_ = nh_.advertise<std_msgs::String>("more", 1);
    std::string mode = pnh.param<std::string>("mode", "grid");
    int level = pnh.param("level", 0);
    if (mode == "scan")
      scan_ = nh_.advertise<std_msgs::String>("of_scan", 1);
    else if (mode == "cloud" && level != 2)
      scan_ = nh_.advertise<std_msgs::String>("of_cloud", 1);
    else
      scan_ = nh_.advertise<std_msgs::String>("of_grid", 1);
    if (mode == "a" && level == 1)
      scan_ = nh_.advertise<std_msgs::String>("of_both", 1);
    else if (mode == "b" && level == 1)
      scan_ = nh_.advertise<std_msgs::String>("of_both", 1);
    bool often = pnh.param("often", false);
    if (often && words_.getNumSubscribers() > 0)
      scan_ = nh_.advertise<std_msgs::String>("of_often", 1);
    else
      scan_ = nh_.advertise<std_msgs::String>("of_seldom", 1);
    if (words_.getNumSubscribers() > 1)
      often = false;
    if (often)
      scan_ = nh_.advertise<std_msgs::String>("of_more", 1);
    if (1 < level)
      scan_ = nh_.advertise<std_msgs::String>("of_levels", 1);
    std::string kind;
    pnh.getParam("kind", kind);
    if (kind == "fast")
      scan_ = nh_.advertise<std_msgs::String>("of_fast", 1);
    std::string source, sink;
    if (pnh.getParam("source", source))
      grid_ = nh_.subscribe(source, 1, &Localizer::map, this);
    if (!pnh.getParam("sink", sink))
      sink = "sink";
    scan_ = nh_.advertise<std_msgs::String>(sink, 1);
    if (pnh.getParam("kind", kind))
      scan_ = nh_.advertise<std_msgs::String>("of_kind", 1);
    if (level % 2 == 1)
      scan_ = nh_.advertise<std_msgs::String>("of_rest", 1);
    if ("my_" + mode == "my_scan")
      scan_ = nh_.advertise<std_msgs::String>("of_part", 1);
    int target = pnh.param("target", -1);
    if (target == Target::PRESET)
      scan_ = nh_.advertise<std_msgs::String>("of_preset", 1);
    else if (target == COMPUTED)
      scan_ = nh_.advertise<std_msgs::String>("of_computed", 1);
    if (quiet_ || debug)
      either_ = nh_.advertise<std_msgs::String>("either", 1);
  }
  void map(const nav_msgs::OccupancyGrid::ConstPtr& grid) {}

private:
  enum Target { MANUAL = 1, PRESET, COMPUTED = MANUAL << 4 };
  ros::NodeHandle nh_;
  ros::Subscriber map_, grid_;
  ros::Publisher words_, more_, either_, scan_;
  bool use_map_topic_, quiet_, changed_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "localizer");
  Localizer localizer;
  ros::spin();
  return 0;
}
