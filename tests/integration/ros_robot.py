"""A robot in rospy: prints every Twist on cmd_vel as JSON, publishes its odometry ten times a second; once, and latched, its
map's size and a text of 5 MiB.
Run with Debian's interpreter, ROS_MASTER_URI and ROS_IP set."""
import json
import sys

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import MapMetaData, Odometry
from std_msgs.msg import String


def print_line(text):
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def on_twist(twist):
    numbers = [twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y, twist.angular.z]
    print_line("twist " + json.dumps(numbers))


def main():
    rospy.init_node("robot", anonymous=True, disable_signals=True)
    rospy.Subscriber("cmd_vel", Twist, on_twist)
    publisher = rospy.Publisher("odom", Odometry, queue_size=1)
    rospy.Publisher("map_metadata", MapMetaData, latch=True, queue_size=1).publish(MapMetaData(width=40, height=30))
    rospy.Publisher("novel", String, latch=True, queue_size=1).publish(String("x" * (5 << 20)))
    odometry = Odometry()
    odometry.child_frame_id = "base_link"
    odometry.pose.pose.position.x = 1.25
    odometry.pose.pose.position.y = -2.5
    odometry.pose.pose.orientation.w = 1.0
    print_line("ready")
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        odometry.header.stamp = rospy.Time.now()
        publisher.publish(odometry)
        rate.sleep()


main()
