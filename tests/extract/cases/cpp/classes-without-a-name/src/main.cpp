#include <ros/ros.h>
#include <geometry_msgs/PoseStamped.h>
#include <vector>

typedef struct
{
  double weight;
} hypothesis_t;

class Filter
{
public:
  Filter()
  {
    hypothesis_t best;
    pose_.publisher = nh_.advertise<geometry_msgs::PoseStamped>("pose", 2);
    std::vector<hypothesis_t> all = {best, hypothesis_t()};
  }

private:
  ros::NodeHandle nh_;
  struct
  {
    ros::Publisher publisher;
  } pose_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "filter");
  Filter filter;
  ros::spin();
  return 0;
}
