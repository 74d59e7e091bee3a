// src/threshold_nodelet.cpp
