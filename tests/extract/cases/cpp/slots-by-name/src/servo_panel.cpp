#include <QApplication>
#include <QMainWindow>

#include <ros/ros.h>
#include <std_msgs/Int16.h>

#include "ui_servo_panel.h"

class ServoPanel : public QMainWindow
{
public:
  ServoPanel()
  : ui_(new Ui::ServoPanel)
  {
    ui_->setupUi(this);
  }

private slots:
  void on_moveButton_clicked()
  {
    servo_ = handle_.advertise<std_msgs::Int16>("servo", 1);
  }

private:
  void on_nothing()
  {
    unused_ = handle_.advertise<std_msgs::Int16>("unused", 1);
  }

  Ui::ServoPanel * ui_;
  ros::NodeHandle handle_;
  ros::Publisher servo_, unused_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "servo_panel");
  QApplication application(argc, argv);
  ServoPanel panel;
  panel.show();
  return application.exec();
}
