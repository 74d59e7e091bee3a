#include <jsk_topic_tools/diagnostic_nodelet.h>
#include <pluginlib/class_list_macros.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/String.h>

namespace handed_down
{
class Filter : public jsk_topic_tools::DiagnosticNodelet
{
public:
  Filter() : DiagnosticNodelet("Filter")
  {
  }

protected:
  void onInit() override
  {
    DiagnosticNodelet::onInit();
    publisher_ = advertise<sensor_msgs::PointCloud2>(*pnh_, "output", 1);
    state_ = nh_->subscribe("robot/state", 1, &Filter::state, this);
    onInitPostProcess();
  }
  void subscribe() override
  {
    subscriber_ = pnh_->subscribe("input", 1, &Filter::filter, this);
  }
  void unsubscribe() override
  {
    subscriber_.shutdown();
  }
  void filter(const sensor_msgs::PointCloud2::ConstPtr& cloud) {}
  void state(const std_msgs::String::ConstPtr& state) {}
  ros::Publisher publisher_;
  ros::Subscriber subscriber_, state_;
};
}  // namespace handed_down

PLUGINLIB_EXPORT_CLASS(handed_down::Filter, nodelet::Nodelet)
