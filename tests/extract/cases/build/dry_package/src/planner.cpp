// src/planner.cpp
