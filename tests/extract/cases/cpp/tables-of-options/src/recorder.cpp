#include <getopt.h>
#include <popt.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

bool timing = false;
bool quiet = false;

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "recorder");
  ros::NodeHandle handle;
  int verbose = 0;
  static struct poptOption options[] = {
    {"timing", 't', POPT_ARG_NONE, &timing, 0, "Publish how long it takes", "NONE"},
    POPT_AUTOHELP
    {NULL, 0, 0, NULL, 0, NULL, NULL}
  };
  poptContext context = poptGetContext(NULL, argc, (const char **)argv, options, 0);
  while (poptGetNextOpt(context) >= 0) {
  }
  struct option more[] = {{"verbose", no_argument, &verbose, 1}, {0, 0, 0, 0}};
  while (getopt_long(argc, argv, "", more, 0) >= 0) {
  }
  ros::Publisher taken, detail, sound;
  if (timing) {
    taken = handle.advertise<std_msgs::Float64>("taken", 1);
  }
  if (verbose) {
    detail = handle.advertise<std_msgs::Float64>("detail", 1);
  }
  if (quiet) {
    sound = handle.advertise<std_msgs::Float64>("sound", 1);
  }
  ros::spin();
  return 0;
}
