#include "toolkit/machine.hpp"

namespace toolkit
{
Stoppable::Stoppable()
{
  subscriber_ = nh_.subscribe("/stop", 1, &Stoppable::stop, this);
}

void Stoppable::stop(const std_msgs::BoolConstPtr& stop)
{
}
}  // namespace toolkit
