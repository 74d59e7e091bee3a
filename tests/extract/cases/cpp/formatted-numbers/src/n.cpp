#include <iomanip>
#include <sstream>
#include <ros/ros.h>
#include <std_msgs/Bool.h>

int main(int argc, char** argv)
{
  ros::init(argc, argv, "n");
  ros::NodeHandle nh;
  std::vector<ros::Publisher> all;
  auto add = [&](const std::string& name) { all.push_back(nh.advertise<std_msgs::Bool>(name, 1)); };
  std::stringstream a;
  a << "hex/x" << std::hex << 26;
  add(a.str());
  std::stringstream b;
  b << "padded/p" << std::setw(3) << std::setfill('0') << 7;
  add(b.str());
  std::ostringstream c;
  c << "upper/x" << std::uppercase << std::hex << 171 << std::dec << "_" << 10;
  add(c.str());
  std::stringstream d;
  d << "fixed/f" << std::fixed << std::setprecision(1) << 2.0;
  add(d.str());
  int id = 0;
  read(fd, &id, sizeof(id));
  std::stringstream e;
  e << "device/x" << std::hex << id;
  add(e.str());
  std::stringstream lines[2];
  for (int i = 0; i < 2; i++) {
    lines[i] << "line/l" << i;
    add(lines[i].str());
  }
  std::stringstream f("start/", std::ios_base::out | std::ios_base::ate);
  f << "end";
  add(f.str());
  int number = 0;
  while (ros::ok()) {
    number = serial.read();
    std::stringstream g;
    g << "loop/x" << std::hex << number;
    add(g.str());
  }
  uint8_t byte = 0;
  for (int i = 0; i < 3; ++i) {
    serial.read(&byte, 1);
    add("byte/" + std::to_string(byte));
  }
  std::stringstream h;
  h << "two/x" << std::setfill('0') << std::setw(2) << std::hex << static_cast<int>(id) << "/end";
  add(h.str());
  std::stringstream k;
  k << std::boolalpha << "truth/" << true;
  add(k.str());
  char text[20];
  sprintf(text, "print/%02d_%x_%c", 3, 255, 'c');
  add(text);
  add((boost::format("boost/%03d") % 5).str());
  add(fmt::format("fmt/{:02x}/{:>3}", 10, 4));
  ros::spin();
}
