"""A node in rospy: 'NAME listen TOPIC ...' prints the topic and x of each Twist, 'NAME say TYPE TOPIC' says the type's zero five
times a second. Run with Debian's interpreter, ROS_MASTER_URI and ROS_IP set."""
import sys

import rospy
import std_msgs.msg
from geometry_msgs.msg import Twist


def print_line(text):
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def say(kind, topic):
    kind = getattr(std_msgs.msg, kind)
    publisher = rospy.Publisher(topic, kind, queue_size=1)
    print_line("ready")
    while not rospy.is_shutdown():
        publisher.publish(kind())
        rospy.rostime.wallsleep(0.2)


def listen(*topics):
    for topic in topics:
        rospy.Subscriber(topic, Twist, lambda twist, topic=topic: print_line(f"{topic} {twist.linear.x}"))
    print_line("ready")
    rospy.spin()


rospy.init_node(sys.argv[1], disable_signals=True)
{"say": say, "listen": listen}[sys.argv[2]](*sys.argv[3:])
