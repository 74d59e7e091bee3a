// src/preview.cpp
