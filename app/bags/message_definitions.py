"""Message definitions: for recordings without any, as sqlite3 before ROS 2 Iron kept only names.

ROS 2's own types come with rosbags. These are the other types of recorded topics of keypoints or of
video packets.
"""

from __future__ import annotations

DEFINITIONS = {
    # The published implementation's port to ROS 2.
    "keypoints_interfaces/msg/PoseKeypoints": "string name\nfloat32 x\nfloat32 y\n",
    "keypoints_interfaces/msg/PoseKeypointsArray": "PoseKeypoints[] keypoints\n",
    # Our own, as in ros2/osg_interfaces/msg.
    "osg_interfaces/msg/Keypoint": "string name\nfloat64 x\nfloat64 y\nfloat64 confidence\n",
    "osg_interfaces/msg/Hand": "string side\nfloat64 score\nKeypoint[] keypoints\n",
    "osg_interfaces/msg/Hands": (
        "std_msgs/Header header\nuint32 image_width\nuint32 image_height\nfloat64 salute\n"
        "Hand[] hands\n"
    ),
    "osg_interfaces/msg/BodyKeypoints": (
        "std_msgs/Header header\nstring body_id\nuint32 image_width\nuint32 image_height\n"
        "float64 score\nKeypoint[] keypoints\n"
    ),
    # ROS4HRI (REP-155).
    "hri_msgs/msg/NormalizedPointOfInterest2D": "float32 x\nfloat32 y\nfloat32 c\n",
    "hri_msgs/msg/Skeleton2D": (
        "std_msgs/Header header\nNormalizedPointOfInterest2D[18] skeleton\n"
    ),
    # ffmpeg_image_transport and Foxglove's bridge.
    "ffmpeg_image_transport_msgs/msg/FFMPEGPacket": (
        "std_msgs/Header header\nint32 width\nint32 height\nstring encoding\nuint64 pts\n"
        "uint8 flags\nbool is_bigendian\nuint8[] data\n"
    ),
    "foxglove_msgs/msg/CompressedVideo": (
        "builtin_interfaces/Time timestamp\nstring frame_id\nuint8[] data\nstring format\n"
    ),
}
"""Definition by type name, without comments and constants, which do not affect decoding."""
