// dump.cpp
