#include "parts.hpp"

void Second::begin()
{
  server_ = nh_.advertiseService("second", &Second::serve, this);
}

void Second::never()
{
  server_ = nh_.advertiseService("never", &Second::serve, this);
}

bool Second::serve(std_srvs::Empty::Request& request, std_srvs::Empty::Response& response)
{
  return true;
}
