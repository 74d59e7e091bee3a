#ifndef LASER_SCAN_MERGER_H
#define LASER_SCAN_MERGER_H
#include <ros/ros.h>
namespace laser
{
class Other;

/// Settings that the merger reads from a file.
struct Settings
{
  int count;
};

/**
 * @class ScanMerger
 * @brief Merges the scans of two laser range finders into one.
 *
 * The later scan is moved into the frame of the **first** by `tf`.
 *
 * @param nothing is no description
 */
class ScanMerger
{
public:
  ScanMerger();

private:
  ros::NodeHandle nh_;
  ros::Publisher pub_;
};
}
#endif
