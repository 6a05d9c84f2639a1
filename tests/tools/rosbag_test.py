"""ROS 2 bags of both kinds, made here, become ASL folders that leviosim reads. Run by ctest with the program and the
script."""

import pathlib
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SCRIPT = (str(pathlib.Path(word).absolute()) for word in sys.argv[1:3])
MAGIC = b"\x89MCAP0\r\n"
START = 1_700_000_000 * 10**9
TYPES = {"/cam": "sensor_msgs/msg/Image", "/imu": "sensor_msgs/msg/Imu"}


class Cdr:
    def __init__(self):
        self.data = b""

    def put(self, kind, *values):
        self.data += b"\0" * (-len(self.data) % struct.calcsize("=" + kind))
        self.data += struct.pack(f"<{len(values)}{kind}", *values)
        return self

    def octets(self, data):
        self.put("I", len(data))
        self.data += data
        return self

    def header(self, t_ns):
        return self.put("i", t_ns // 10**9).put("I", t_ns % 10**9).octets(b"body\0")

    def message(self):
        return b"\0\1\0\0" + self.data


def picture(frame, size):
    return bytes((x * 3 + frame * 7) % 256 for x in range(160 * 120 * size))


def image(t_ns, frame, encoding, size):
    cdr = Cdr().header(t_ns).put("I", 120).put("I", 160).octets(encoding.encode() + b"\0")
    return cdr.put("B", 0).put("I", 160 * size).octets(picture(frame, size)).message()


def imu(t_ns):
    values = [0.0, 0.0, 0.0, 1.0] + [0.0] * 9 + [0.01, -0.02, 0.03] + [0.0] * 9 + [0.1, 0.2, 9.81] + [0.0] * 9
    return Cdr().header(t_ns).put("d", *values).message()


def flight(encoding="mono8", size=1):
    """(time, topic, message): four frames at 20 Hz, samples at 200 Hz, not in order of time."""
    frames = [(START + i * 50_000_000, "/cam", image(START + i * 50_000_000, i, encoding, size)) for i in range(4)]
    return frames + [(START + i * 5_000_000, "/imu", imu(START + i * 5_000_000)) for i in range(-10, 41)]


def write_db3(path, messages):
    base = sqlite3.connect(path)
    base.execute("create table topics(id integer primary key, name text, type text, serialization_format text, "
                 "offered_qos_profiles text)")
    base.execute("create table messages(id integer primary key, topic_id integer, timestamp integer, data blob)")
    for number, (topic, kind) in enumerate(TYPES.items()):
        base.execute("insert into topics values(?,?,?,'cdr','')", (number, topic, kind))
    for time, topic, message in messages:
        base.execute("insert into messages(topic_id, timestamp, data) values(?,?,?)",
                     (list(TYPES).index(topic), time, message))
    base.commit()
    base.close()


def text(data):
    return struct.pack("<I", len(data)) + data.encode()


def record(kind, body):
    return struct.pack("<BQ", kind, len(body)) + body


def write_mcap(path, messages, compression=""):
    inner = b""
    for number, (topic, kind) in enumerate(TYPES.items()):
        inner += record(3, struct.pack("<H", number + 1) + text(kind) + text("ros2msg") + text(""))
        inner += record(4, struct.pack("<HH", number, number + 1) + text(topic) + text("cdr") + text(""))
    for time, topic, message in messages:
        inner += record(5, struct.pack("<HIQQ", list(TYPES).index(topic), 0, time, time) + message)
    stored = inner
    if compression:
        stored = subprocess.run([compression, "-c"], input=inner, stdout=subprocess.PIPE, check=True).stdout
    chunk = struct.pack("<QQQI", 0, 0, len(inner), 0) + text(compression) + struct.pack("<Q", len(stored)) + stored
    path.write_bytes(MAGIC + record(1, text("ros2") + text("")) + record(6, chunk) + record(15, b"\0" * 4) + MAGIC)


SENSOR = """
rate_hz: {rate}
T_BS:
  cols: 4
  rows: 4
  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
"""
CAMERA = SENSOR.format(rate=20) + """resolution: [160, 120]
camera_model: pinhole
intrinsics: [114, 114, 80, 60]
distortion_model: radial-tangential
distortion_coefficients: [0, 0, 0, 0]
"""
IMU_MODEL = SENSOR.format(rate=200) + """gyroscope_noise_density: 1e-4
gyroscope_random_walk: 1e-5
accelerometer_noise_density: 1e-3
accelerometer_random_walk: 1e-3
"""


class Rosbag(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name)
        (self.folder / "camera.yaml").write_text(CAMERA)
        (self.folder / "imu.yaml").write_text(IMU_MODEL)

    def tearDown(self):
        self.scratch.cleanup()

    def convert(self, bag, out="out", image_topic="/cam", imu_topic="/imu"):
        words = [bag, out, "--image", image_topic, "--imu", imu_topic, "--camera", "camera.yaml", "--imu-model", "imu.yaml"]
        return subprocess.run([sys.executable, SCRIPT, *words], cwd=self.folder, capture_output=True, text=True)

    def run_on(self, folder):
        done = subprocess.run([PROGRAM, "run", "--native", "--data", folder, "--size", "160x120", "--quiet", "--out",
                               folder + "-run"], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def content(self, folder):
        files = (self.folder / folder).rglob("*")
        return {str(f.relative_to(self.folder / folder)): f.read_bytes() for f in files if f.is_file()}

    def test_both_kinds_of_bags_are_the_same_flight(self):
        write_db3(self.folder / "bag.db3", flight())
        (self.folder / "bag").mkdir()
        write_mcap(self.folder / "bag/bag_0.mcap", flight())
        kinds = ["bag.db3", "bag"]
        if shutil.which("zstd"):
            write_mcap(self.folder / "zstd.mcap", flight(), "zstd")
            kinds.append("zstd.mcap")
        for number, bag in enumerate(kinds):
            done = self.convert(bag, f"out{number}")
            self.assertEqual((done.returncode, done.stdout), (0, f"out{number}: 4 images, 51 IMU samples\n"), done.stderr)
            self.assertEqual(self.content(f"out{number}"), self.content("out0"))
        rows = (self.folder / "out0/mav0/imu0/data.csv").read_text().splitlines()
        self.assertEqual(rows[1], f"{START - 50_000_000},0.01,-0.02,0.03,0.1,0.2,9.81")
        self.run_on("out0")

    def test_colours_and_sixteen_bits_are_read(self):
        for encoding, size in (("bgr8", 3), ("rgb8", 3), ("mono16", 2)):
            write_db3(self.folder / f"{encoding}.db3", flight(encoding, size))
            self.assertEqual(self.convert(f"{encoding}.db3", encoding).returncode, 0)
            self.run_on(encoding)

    def test_topics_are_listed(self):
        write_db3(self.folder / "bag.db3", flight())
        done = subprocess.run([sys.executable, SCRIPT, "bag.db3", "--list"], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.stdout, "/cam  sensor_msgs/msg/Image  4\n/imu  sensor_msgs/msg/Imu  51\n")

    def refused(self, done, *parts):
        self.assertEqual(done.returncode, 2)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for part in parts:
            self.assertIn(part, done.stderr)
        self.assertFalse((self.folder / "out").exists())

    def test_what_cannot_be_converted_is_refused_in_a_line_and_leaves_nothing(self):
        write_db3(self.folder / "bag.db3", flight())
        self.refused(self.convert("none.db3"), "none.db3")
        self.refused(self.convert("bag.db3", image_topic="/cm"), "--image /cm: no message", "/cam, /imu")
        self.refused(self.convert("bag.db3", image_topic="/imu", imu_topic="/cam"), "/imu: messages are sensor_msgs/msg/Imu; expected sensor_msgs/msg/Image or")
        write_db3(self.folder / "odd.db3", flight("bayer_rggb8"))
        self.refused(self.convert("odd.db3"), "images are 'bayer_rggb8'", "mono8")
        (self.folder / "cut.db3").write_bytes(b"\x28\xb5\x2f\xfd")
        self.refused(self.convert("cut.db3"), "no SQLite file")
        (self.folder / "cut.mcap").write_bytes(b"no")
        self.refused(self.convert("cut.mcap"), "no MCAP file")
        (self.folder / "camera.yaml").unlink()
        self.refused(self.convert("bag.db3"), "camera.yaml: no such file")

    def test_names_with_marks_of_addresses_are_names(self):
        for name in ("a?b.db3", "a#b.db3", "100%.db3", "a%20b.db3", "a?mode=memory.db3"):
            write_db3(self.folder / name, flight())
            self.assertEqual(self.convert(name, "out-" + name).returncode, 0, name)

    def changed(self, *statements):
        bag = self.folder / "bag.db3"
        bag.unlink(missing_ok=True)
        write_db3(bag, flight())
        base = sqlite3.connect(bag)
        for statement in statements:
            base.execute(statement)
        base.commit()
        base.close()
        return self.convert("bag.db3")

    def test_data_bases_of_others_are_refused(self):
        for statements in (
                ["update messages set data = 'text'"], ["update messages set data = null"], ["update messages set data = 5"],
                ["update topics set name = 7"], ["update topics set type = null"],
                ["update topics set name = cast(x'ff' as text)"], ["update messages set data = x'00'"],
                ["update messages set data = zeroblob(1000)"], ["drop table topics"], ["drop table messages"],
                ["alter table messages rename to m", "create view messages as select * from m"],
                ["alter table topics rename to m", "create view topics as with recursive n(i) as (select 1 union all "
                 "select i + 1 from n) select i as id, 'a' as name, 'b' as type from n"],
                ["alter table messages rename to m", "create table messages(id, topic_id, timestamp, "
                 "data as (zeroblob(1000000000)))", "insert into messages values(1, 1, 1)"]):
            self.refused(self.changed(*statements))

    def test_chunks_of_others_are_refused(self):
        bag = self.folder / "bag.mcap"

        def chunk(inner, size=None, kind="", stored=None):
            stored = inner if stored is None else stored
            size = len(inner) if size is None else size
            return record(6, struct.pack("<QQQI", 0, 0, size, 0) + text(kind) + struct.pack("<Q", len(stored)) + stored)

        nested = b""
        for _ in range(2000):
            nested = chunk(nested)
        zeros = [b"\0" * (64 << 20)]
        bombs = [subprocess.run(["zstd", "-c"], input=zeros[0], stdout=subprocess.PIPE, check=True).stdout] if shutil.which("zstd") else []
        contents = [nested, record(5, struct.pack("<HIQQ", 9, 0, 0, 0)), record(4, b"\0"), record(3, b"\0\0\xff\xff\xff\xff"),
                    record(3, struct.pack("<HI", 1, 1) + b"\xff"), struct.pack("<BQ", 5, 1 << 62), record(6, b"\0"),
                    chunk(b"", 1 << 62), chunk(b"", 100, "lzma"), chunk(b"", 100, "zstd", b"no"), chunk(b"", 100, "\ud7ff")]
        contents += [chunk(b"", 1000, "zstd", bomb) for bomb in bombs]
        for content in contents:
            bag.write_bytes(MAGIC + content)
            self.refused(self.convert("bag.mcap"), "rosbag_to_asl.py: ")

    def test_messages_without_pixels_or_numbers_are_refused(self):
        def empty(width, height):
            return Cdr().header(START).put("I", height).put("I", width).octets(b"mono8\0").put("B", 0).put("I", width).octets(b"").message()

        nan = float("nan")
        samples = [[nan if i == 13 else 0.0 for i in range(37)], [float("inf")] * 37, [nan if i == 27 else 0.0 for i in range(37)]]
        bad = [("/cam", empty(0, 0)), ("/cam", empty(0, 5)), ("/cam", empty(5, 0)), ("/cam", empty(1 << 20, 1 << 20)),
               ("/imu", Cdr().put("i", -5).put("I", 0).octets(b"\0").put("d", *[0.0] * 37).message())]
        bad += [("/imu", Cdr().header(START).put("d", *values).message()) for values in samples]
        for topic, message in bad:
            (self.folder / "bag.db3").unlink(missing_ok=True)
            write_db3(self.folder / "bag.db3", flight() + [(START, topic, message)])
            self.refused(self.convert("bag.db3"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
