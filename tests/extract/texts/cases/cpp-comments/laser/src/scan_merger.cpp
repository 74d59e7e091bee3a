#include <laser/scan_merger.h>
#include <sensor_msgs/LaserScan.h>
namespace laser
{
ScanMerger::ScanMerger()
{
  pub_ = nh_.advertise<sensor_msgs::LaserScan>("merged", 1);
}
}
