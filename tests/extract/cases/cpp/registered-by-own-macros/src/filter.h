#include <nodelet/nodelet.h>
#include <ros/ros.h>

template <typename T>
class Filter : public nodelet::Nodelet
{
public:
  explicit Filter(const std::string & name) : name_(name) {}

protected:
  void onInit() override {out_ = getPrivateNodeHandle().advertise<T>(name_, 1);}
  std::string name_;
  ros::Publisher out_;
};

#define DECLARE_FILTER_OF(TYPE, MESSAGE, NAME) \
namespace filters \
{ \
class TYPE ## Filter : public Filter<MESSAGE> \
{ \
public: \
  TYPE ## Filter() : Filter(NAME "_out") {} \
}; \
} \
PLUGINLIB_EXPORT_CLASS(filters::TYPE ## Filter, nodelet::Nodelet)

#define DECLARE_FILTER(TYPE, NAME) \
DECLARE_FILTER_OF(TYPE, std_msgs::TYPE, NAME)
