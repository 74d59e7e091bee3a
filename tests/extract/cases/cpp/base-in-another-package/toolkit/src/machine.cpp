#include "toolkit/machine.hpp"

namespace toolkit
{
Stoppable::Stoppable()
{
  subscriber_ = nh_.subscribe("/stop", 1, &Stoppable::stop, this);
  nh_.param("stop_timeout", timeout_, 1.0);
}

void Stoppable::stop(const std_msgs::BoolConstPtr& stop)
{
}
}  // namespace toolkit
