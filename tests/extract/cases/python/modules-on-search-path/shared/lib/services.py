import rospy
import which
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

stop = rospy.ServiceProxy("/" + which.name + "/stop", Trigger)
