#include "aliases/filter.h"

Filter::Filter(ros::NodeHandle nh) : nh_(nh)
{
  int queue = 5;
  imu_.reset(new ImuSubscriber(nh_, "imu/data_raw", queue));
  field_ = boost::make_shared<FieldSubscriber>(nh_, "imu/mag", queue);
}
