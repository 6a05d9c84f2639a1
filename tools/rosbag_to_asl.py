#!/usr/bin/env python3
"""Makes an ASL folder, as leviosim reads it, of a ROS 2 bag: SQLite (.db3) or MCAP (.mcap), the file or its folder.

usage: rosbag_to_asl.py BAG OUT --image TOPIC --imu TOPIC --camera sensor.yaml --imu-model sensor.yaml
       rosbag_to_asl.py BAG --list

Messages are sensor_msgs/msg/Image (mono8, mono16, rgb8, bgr8), CompressedImage (PNG, JPEG) and Imu, in CDR. The two
sensor.yaml files are copied: a bag holds no calibration of both sensors. Needs nothing but Python, and for chunks of an
MCAP file that are compressed the program zstd or lz4. Left out: bags of ROS 1, compressed .db3 files, ground truth."""

import argparse
import math
import pathlib
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import urllib.parse
import zlib

IMAGE, COMPRESSED, IMU = ("sensor_msgs/msg/" + name for name in ("Image", "CompressedImage", "Imu"))
MAGIC = b"\x89MCAP0\r\n"
NAME = pathlib.Path(sys.argv[0]).name  # leviosim-bag-to-asl, where it is installed
MOST_MESSAGE = 256 << 20  # bytes of a message, and of a chunk once it is decompressed
MOST_CHUNKS = 4 << 30  # bytes of all chunks
MOST_PIXELS = 1 << 24  # as leviosim reads them


class Refused(Exception):
    pass


def decoded(name):
    try:
        return name.decode()
    except UnicodeDecodeError:
        raise Refused(f"a name is not UTF-8: {name[:40]!r}") from None


class Cdr:
    """Reads a message in the representation that ROS 2 sends: aligned, the byte order in its head."""

    def __init__(self, data):
        if len(data) < 4 or data[0] != 0 or data[1] > 1:
            raise Refused("a message is not in plain CDR")
        self.data, self.at, self.order = data[4:], 0, "<" if data[1] == 1 else ">"

    def take(self, kind, count=1):
        size = struct.calcsize("=" + kind)
        self.at += -self.at % size
        if self.at + size * count > len(self.data):
            raise Refused("a message ends early")
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
        return decoded(self.octets().rstrip(b"\0"))

    def stamp(self):
        """Of a std_msgs/msg/Header. [ns]"""
        seconds, nanoseconds = self.take("i"), self.take("I")
        if seconds < 0 or nanoseconds >= 10**9:
            raise Refused(f"a message has the time {seconds} s and {nanoseconds} ns")
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
    if not (width and height and width * height <= MOST_PIXELS):
        raise Refused(f"an image is of {width}x{height}; expected 1x1 to {MOST_PIXELS} pixels")
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
    accel = cdr.take("d", 3)
    if not all(map(math.isfinite, gyro + accel)):
        raise Refused(f"the IMU sample of {stamp} ns has a value that is no number")
    return stamp, gyro, accel


def sqlite_messages(path):
    """Yields topic, type and message, in the order of time."""
    with open(path, "rb") as file:
        if file.read(16) != b"SQLite format 3\0":
            raise Refused(f"{path}: no SQLite file; decompress it with: ros2 bag convert, or zstd -d")
    base = sqlite3.connect("file:" + urllib.parse.quote(str(path.absolute())) + "?mode=ro", uri=True)
    if hasattr(base, "setlimit"):  # Python 3.11
        base.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MOST_MESSAGE)
    base.execute("pragma trusted_schema = off")
    steps = [100 + path.stat().st_size // 100]  # of 10 000 instructions: far more than rows need

    def stop():
        steps[0] -= 1
        return steps[0] < 0

    base.set_progress_handler(stop, 10_000)
    # What a view or a computed column would give is not in the file, and may have no end.
    for table in ("topics", "messages"):
        kinds = base.execute("select type from sqlite_master where name = ? and sql like 'create table%'", (table,))
        if [kind for (kind,) in kinds] != ["table"] or any(c[6] for c in base.execute(f"pragma table_xinfo({table})")):
            raise Refused(f"{path}: {table} is no plain table of a bag")
    rows = base.execute(
        "select name, type, data from messages join topics on topics.id = topic_id order by timestamp, messages.id")
    for name, kind, data in rows:
        if not (isinstance(name, str) and isinstance(kind, str) and isinstance(data, bytes)):
            raise Refused(f"{path}: a message has another type than bags have")
        yield name, kind, data


def decompressed(kind, data, size):
    """@param size  that it says to have"""
    if size > MOST_MESSAGE:
        raise Refused(f"a chunk has {size} bytes; expected at most {MOST_MESSAGE}")
    if kind == "":
        return data
    if kind not in ("zstd", "lz4"):
        raise Refused(f"chunks are compressed by '{kind}'; expected zstd or lz4")
    if shutil.which(kind) is None:
        raise Refused(f"chunks are compressed, and the program {kind} is missing; apt-get install {kind}")
    with tempfile.TemporaryFile() as stored:
        stored.write(data)
        stored.seek(0)
        with subprocess.Popen([kind, "-dc"], stdin=stored, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as child:
            text = child.stdout.read(size + 1)
            if len(text) > size:
                child.kill()
    if len(text) != size or child.returncode != 0:
        raise Refused(f"a chunk is damaged: it says to have {size} bytes")
    return text


def records(data):
    at = 0
    while at + 9 <= len(data):
        kind, size = struct.unpack_from("<BQ", data, at)
        if size > len(data) - at - 9:
            raise Refused("ends in the middle of a record; recover it with: mcap recover")
        yield kind, data[at + 9 : at + 9 + size]
        at += 9 + size


def prefixed(data, at):
    (size,) = struct.unpack_from("<I", data, at)
    if size > len(data) - at - 4:
        raise Refused("a record ends early")
    return data[at + 4 : at + 4 + size], at + 4 + size


def mcap_messages(path):
    """As sqlite_messages(), in the order of time."""
    data = path.read_bytes()
    if not data.startswith(MAGIC):
        raise Refused(f"{path}: no MCAP file")
    schemas, channels, messages = {}, {}, []
    left = [MOST_CHUNKS]

    def add(kind, body, is_inner):
        if kind == 0x03:
            schemas[struct.unpack_from("<H", body)[0]] = decoded(prefixed(body, 2)[0])
        elif kind == 0x04:
            channel, schema = struct.unpack_from("<HH", body)
            topic, at = prefixed(body, 4)
            channels[channel] = (decoded(topic), schemas.get(schema, ""), prefixed(body, at)[0])
        elif kind == 0x05:
            channel, _, _, time = struct.unpack_from("<HIQQ", body)
            messages.append((time, len(messages), channel, body[22:]))
        elif kind == 0x06:
            if is_inner:
                raise Refused(f"{path}: a chunk lies in another")
            (size,) = struct.unpack_from("<Q", body, 16)
            left[0] -= size
            if left[0] < 0:
                raise Refused(f"{path}: its chunks have more than {MOST_CHUNKS} bytes")
            compression, at = prefixed(body, 28)
            for inner in records(decompressed(decoded(compression), body[at + 8 :], size)):
                add(*inner, True)

    for record in records(data[len(MAGIC) :]):
        if record[0] == 0x0F:  # the end of the data; a summary follows
            break
        add(*record, False)
    for _, _, channel, message in sorted(messages):
        if channel not in channels:
            raise Refused(f"{path}: a message is of channel {channel}, which the file does not describe")
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


def shown(text):
    """No character of a name does anything to a terminal."""
    return "".join(c if c == "\n" or c.isprintable() else ascii(c)[1:-1] for c in text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.replace("rosbag_to_asl.py", NAME), formatter_class=argparse.RawDescriptionHelpFormatter)
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
        sys.stdout.write(shown(listed(arguments.bag) if arguments.list else convert(arguments)))
    except KeyboardInterrupt:
        sys.exit(130)
    except (Refused, OSError, sqlite3.Error, struct.error, ValueError, OverflowError, MemoryError) as error:
        print(f"{NAME}: {' '.join(shown(str(error) or 'too little memory').split())}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
