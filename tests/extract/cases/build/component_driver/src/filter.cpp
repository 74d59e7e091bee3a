// src/filter.cpp
