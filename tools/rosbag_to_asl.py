#!/usr/bin/env python3
"""Makes an ASL folder, as leviosim reads it, of a ROS 2 bag: SQLite (.db3) or MCAP (.mcap), the file or its folder.

usage: rosbag_to_asl.py BAG OUT --image TOPIC --imu TOPIC --camera sensor.yaml --imu-model sensor.yaml
       rosbag_to_asl.py BAG --list

Messages are sensor_msgs/msg/Image (mono8, mono16, rgb8, bgr8), CompressedImage (PNG, JPEG) and Imu, in CDR. The two
sensor.yaml files are copied: a bag holds no calibration of both sensors. Needs nothing but Python, and for chunks of an
MCAP file that are compressed the program zstd or lz4. Left out: bags of ROS 1, compressed .db3 files, ground truth."""

import argparse
import pathlib
import shutil
import sqlite3
import struct
import subprocess
import sys
import zlib

IMAGE, COMPRESSED, IMU = ("sensor_msgs/msg/" + name for name in ("Image", "CompressedImage", "Imu"))
MAGIC = b"\x89MCAP0\r\n"


class Refused(Exception):
    pass


class Cdr:
    """Reads a message in the representation that ROS 2 sends: aligned, the byte order in its head."""

    def __init__(self, data):
        if len(data) < 4 or data[0] != 0 or data[1] > 1:
            raise Refused("a message is not in plain CDR")
        self.data, self.at, self.order = data[4:], 0, "<" if data[1] == 1 else ">"

    def take(self, kind, count=1):
        size = struct.calcsize("=" + kind)
        self.at += -self.at % size
        values = struct.unpack_from(f"{self.order}{count}{kind}", self.data, self.at)
        self.at += size * count
        return values[0] if count == 1 else values

    def octets(self):
        size = self.take("I")
        self.at += size
        if self.at > len(self.data):
            raise Refused("a message ends early")
        return self.data[self.at - size : self.at]

    def text(self):
        return self.octets().rstrip(b"\0").decode()

    def stamp(self):
        """Of a std_msgs/msg/Header. [ns]"""
        seconds, nanoseconds = self.take("i"), self.take("I")
        self.text()
        return seconds * 10**9 + nanoseconds


def png(width, height, colour, bits, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    head = struct.pack(">IIBBBBB", width, height, bits, 2 if colour else 0, 0, 0, 0)
    pixels = b"".join(b"\0" + row for row in rows)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(pixels, 1)) + chunk(b"IEND", b"")


def swapped(row, size, order):
    """Every pixel's bytes in that order."""
    out = bytearray(row)
    for to, from_ in enumerate(order):
        out[to::size] = row[from_::size]
    return bytes(out)


def image_of(message):
    """@returns stamp [ns] and the bytes of a PNG file"""
    cdr = Cdr(message)
    stamp = cdr.stamp()
    height, width, encoding = cdr.take("I"), cdr.take("I"), cdr.text()
    big, step, data = cdr.take("B"), cdr.take("I"), cdr.octets()
    kinds = {"mono8": (1, 8), "8UC1": (1, 8), "mono16": (2, 16), "16UC1": (2, 16), "rgb8": (3, 8), "bgr8": (3, 8)}
    if encoding not in kinds:
        raise Refused(f"images are '{encoding}'; expected one of {', '.join(kinds)}")
    size, bits = kinds[encoding]
    if step < width * size or len(data) < step * height:
        raise Refused(f"an image of {width}x{height} has {len(data)} bytes")
    rows = [data[y * step : y * step + width * size] for y in range(height)]
    if size == 2 and not big:
        rows = [swapped(row, 2, (1, 0)) for row in rows]  # PNG has the upper byte first
    if encoding == "bgr8":
        rows = [swapped(row, 3, (2, 1, 0)) for row in rows]
    return stamp, png(width, height, size == 3, bits, rows)


def compressed_of(message):
    cdr = Cdr(message)
    stamp = cdr.stamp()
    cdr.text()  # what it says of the format is not always true; leviosim looks at the bytes
    return stamp, cdr.octets()


def imu_of(message):
    """@returns stamp [ns], angular velocity [rad/s], acceleration [m/s²]"""
    cdr = Cdr(message)
    stamp = cdr.stamp()
    cdr.take("d", 4 + 9)
    gyro = cdr.take("d", 3)
    cdr.take("d", 9)
    return stamp, gyro, cdr.take("d", 3)


def sqlite_messages(path):
    """Yields topic, type and message, in the order of time."""
    with open(path, "rb") as file:
        if file.read(16) != b"SQLite format 3\0":
            raise Refused(f"{path}: no SQLite file; decompress it with: ros2 bag convert, or zstd -d")
    base = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
    yield from base.execute(
        "select name, type, data from messages join topics on topics.id = topic_id order by timestamp, messages.id")


def decompressed(kind, data):
    if kind == "":
        return data
    if kind not in ("zstd", "lz4"):
        raise Refused(f"chunks are compressed by '{kind}'; expected zstd or lz4")
    if shutil.which(kind) is None:
        raise Refused(f"chunks are compressed, and the program {kind} is missing; apt-get install {kind}")
    return subprocess.run([kind, "-dc"], input=data, stdout=subprocess.PIPE, check=True).stdout


def records(data):
    at = 0
    while at + 9 <= len(data):
        kind, size = struct.unpack_from("<BQ", data, at)
        yield kind, data[at + 9 : at + 9 + size]
        at += 9 + size


def prefixed(data, at):
    (size,) = struct.unpack_from("<I", data, at)
    return data[at + 4 : at + 4 + size], at + 4 + size


def mcap_messages(path):
    """As sqlite_messages(), in the order of time."""
    data = path.read_bytes()
    if not data.startswith(MAGIC):
        raise Refused(f"{path}: no MCAP file")
    schemas, channels, messages = {}, {}, []

    def add(kind, body):
        if kind == 0x03:
            schemas[struct.unpack_from("<H", body)[0]] = prefixed(body, 2)[0].decode()
        elif kind == 0x04:
            channel, schema = struct.unpack_from("<HH", body)
            topic, at = prefixed(body, 4)
            channels[channel] = (topic.decode(), schemas.get(schema, ""), prefixed(body, at)[0])
        elif kind == 0x05:
            channel, _, _, time = struct.unpack_from("<HIQQ", body)
            messages.append((time, len(messages), channel, body[22:]))
        elif kind == 0x06:
            compression, at = prefixed(body, 28)
            for inner in records(decompressed(compression.decode(), body[at + 8 :])):
                add(*inner)

    for record in records(data[len(MAGIC) :]):
        if record[0] == 0x0F:  # the end of the data; a summary follows
            break
        add(*record)
    for _, _, channel, message in sorted(messages):
        topic, kind, encoding = channels[channel]
        if encoding == b"cdr":
            yield topic, kind, message


def messages_of(bag):
    files = [bag] if bag.is_file() else sorted(f for f in bag.glob("*") if f.suffix in (".db3", ".mcap"))
    if not files:
        raise Refused(f"{bag}: no .db3 or .mcap file there")
    for file in files:
        yield from mcap_messages(file) if file.suffix == ".mcap" else sqlite_messages(file)


def listed(bag):
    counts = {}
    for topic, kind, _ in messages_of(bag):
        counts[topic, kind] = counts.get((topic, kind), 0) + 1
    return "".join(f"{topic}  {kind}  {count}\n" for (topic, kind), count in sorted(counts.items()))


def convert(arguments):
    mav0 = arguments.out / "mav0"
    if arguments.out.exists():
        raise Refused(f"{arguments.out}: exists; expected a new folder")
    for sensor in (arguments.camera, arguments.imu_model):
        if not sensor.is_file():
            raise Refused(f"{sensor}: no such file; expected a sensor.yaml as ASL folders have it")
    try:
        return write(arguments, mav0)
    except BaseException:
        shutil.rmtree(arguments.out, ignore_errors=True)
        raise


def write(arguments, mav0):
    frames, samples, seen = [], [], set()
    (mav0 / "cam0/data").mkdir(parents=True)
    (mav0 / "imu0").mkdir()
    readers = {IMAGE: image_of, COMPRESSED: compressed_of}
    for topic, kind, message in messages_of(arguments.bag):
        seen.add(topic)
        if topic == arguments.image and kind in readers:
            stamp, picture = readers[kind](message)
            frames.append(stamp)
            (mav0 / "cam0/data" / f"{stamp}.png").write_bytes(picture)
        elif topic == arguments.imu and kind == IMU:
            samples.append(imu_of(message))
        elif topic in (arguments.image, arguments.imu):
            expected = f"{IMAGE} or {COMPRESSED}" if topic == arguments.image else IMU
            raise Refused(f"{topic}: messages are {kind}; expected {expected}")
    for option, topic, found in (("--image", arguments.image, frames), ("--imu", arguments.imu, samples)):
        if not found:
            raise Refused(f"{option} {topic}: no message; the bag has {', '.join(sorted(seen))}")
    (mav0 / "cam0/data.csv").write_text(
        "#timestamp [ns],filename\n" + "".join(f"{t},{t}.png\n" for t in sorted(frames)))
    rows = "".join(f"{t},{','.join(map(repr, gyro + accel))}\n" for t, gyro, accel in sorted(samples))
    (mav0 / "imu0/data.csv").write_text("#timestamp [ns],w_RS_S_x,w_RS_S_y,w_RS_S_z,a_RS_S_x,a_RS_S_y,a_RS_S_z\n" + rows)
    shutil.copy(arguments.camera, mav0 / "cam0/sensor.yaml")
    shutil.copy(arguments.imu_model, mav0 / "imu0/sensor.yaml")
    return f"{arguments.out}: {len(frames)} images, {len(samples)} IMU samples\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bag", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path, nargs="?")
    parser.add_argument("--list", action="store_true", help="topics, types, numbers of messages")
    for option in ("--image", "--imu"):
        parser.add_argument(option, metavar="TOPIC")
    for option in ("--camera", "--imu-model"):
        parser.add_argument(option, metavar="FILE", type=pathlib.Path)
    arguments = parser.parse_args()
    needed = (arguments.out, arguments.image, arguments.imu, arguments.camera, arguments.imu_model)
    if not arguments.list and None in needed:
        parser.error("expected BAG OUT --image TOPIC --imu TOPIC --camera FILE --imu-model FILE, or BAG --list")
    try:
        sys.stdout.write(listed(arguments.bag) if arguments.list else convert(arguments))
    except (Refused, OSError, sqlite3.Error, struct.error, subprocess.CalledProcessError) as error:
        print(f"rosbag_to_asl.py: {error}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
