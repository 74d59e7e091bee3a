#include <std_msgs/String.h>
#include "chain.h"

int main(int argc, char ** argv)
{
  spin<std_msgs::String>("chain", argc, argv);
}
