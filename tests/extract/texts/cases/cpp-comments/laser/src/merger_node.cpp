/*
 * Copyright (c) 2020, Somebody. All rights reserved.
 *
 * Redistribution and use in source and binary forms, with or without
 * modification, are permitted.
 */

/**
 * \file merger_node.cpp
 * \brief Starts the merger of two scans.
 * \author Somebody
 * \date 2020
 */

// ROS includes
#include <ros/ros.h>
#include <laser/scan_merger.h>

// int old = 3;
// ros::spin();

/**
 * Reads the command line and
 * spins until it is stopped.
 */
int main(int argc, char **argv)
{
  ros::init(argc, argv, "merger"); // a comment behind code says nothing
  laser::ScanMerger merger;
  ros::spin();
}
