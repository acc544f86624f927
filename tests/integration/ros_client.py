"""A client of a base with move_base, in rospy. One argument, the namespace; lines of stdin: 'goal FRAME X Y QZ QW', 'twist X TURN',
'battery', 'odom'. Each is answered with one line of JSON. Run with Debian's interpreter, ROS_MASTER_URI and ROS_IP set."""
import json
import sys

import genpy.dynamic
import rospy
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry

NAMESPACE = "/" + sys.argv[1] + "/"
WAIT_S = 20


def answer(value):
    sys.stdout.write(json.dumps(value) + "\n")
    sys.stdout.flush()


def goal_of(frame, x, y, qz, qw):
    goal = PoseStamped()
    goal.header.frame_id = "" if frame == "-" else frame
    goal.pose.position.x, goal.pose.position.y = float(x), float(y)
    goal.pose.orientation.z, goal.pose.orientation.w = float(qz), float(qw)
    return goal


def twist_of(x, turn):
    twist = Twist()
    twist.linear.x, twist.angular.z = float(x), float(turn)
    return twist


def heard(topic):
    """A message of a type that need not be installed here: its definition comes with the connection."""
    raw = rospy.wait_for_message(topic, rospy.AnyMsg, WAIT_S)
    header = raw._connection_header
    return genpy.dynamic.generate_dynamic(header["type"], header["message_definition"])[header["type"]]().deserialize(raw._buff)


def members(message):
    return {name: getattr(message, name) for name in message.__slots__ if isinstance(getattr(message, name), (int, float))}


def pose(odometry):
    at = odometry.pose.pose
    return [at.position.x, at.position.y, at.orientation.z, at.orientation.w]


def main():
    rospy.init_node("client", anonymous=True, disable_signals=True)
    goals = rospy.Publisher(NAMESPACE + "move_base_simple/goal", PoseStamped, queue_size=10)
    twists = rospy.Publisher(NAMESPACE + "cmd_vel", Twist, queue_size=10)
    while goals.get_num_connections() == 0 or twists.get_num_connections() == 0:
        rospy.rostime.wallsleep(0.02)
    answer("ready")
    for line in sys.stdin:
        word, *rest = line.split()
        if word == "goal":
            goals.publish(goal_of(*rest))
            answer("sent")
        elif word == "twist":
            twists.publish(twist_of(*rest))
            answer("sent")
        elif word == "battery":
            answer(members(heard(NAMESPACE + "battery")))
        else:
            answer(pose(rospy.wait_for_message(NAMESPACE + "odom", Odometry, WAIT_S)))


main()
