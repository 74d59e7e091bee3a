#include "families/types.h"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "estimator");
  LinearEstimator estimator;
  estimator.run();
  return 0;
}
