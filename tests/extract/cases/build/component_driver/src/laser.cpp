// src/laser.cpp
