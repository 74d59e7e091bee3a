// src/main.cpp
