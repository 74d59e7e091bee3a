// src/planner_ros.cpp
