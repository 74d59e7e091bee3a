// src/median_nodelet.cpp
