// src/monitor.cpp
