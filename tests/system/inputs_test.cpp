// Inputs that nobody means: each is refused at once with one line, and nothing is left behind.
// The program runs with a bound on its time, so that a fault that never ends shows as a failure
// before it has taken the memory of the machine.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>

#include "tests/support/image_files.h"
#include "tests/support/paths.h"
#include "tests/support/run_program.h"
#include "tests/traces/work_trace_example.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::ProgramResult;
using traces::testing::AslFolder;
using traces::testing::TempFolder;

class Inputs : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const {
    outputs::write_file_atomically(folder_ / name, text);
  }

  /// Three seconds of processor time; thirty of the clock, for what waits.
  ProgramResult program(const std::vector<std::string>& words) const {
    const auto quoted = [](const std::string& word) { return "'" + word + "'"; };
    std::string command = "ulimit -t 3; exec timeout -s KILL 30 ";
    command += quoted(leviosim::tests::program_path());
    for (const std::string& word : words) command += " " + quoted(word);
    command += " >" + quoted(path("stdout.txt")) + " 2>" + quoted(path("stderr.txt"));
    const int status = std::system(command.c_str());
    ProgramResult result;
    result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.out = base::read_text_file(folder_ / "stdout.txt");
    result.err = base::read_text_file(folder_ / "stderr.txt");
    return result;
  }

  void expect_refusal(const std::vector<std::string>& words,
                      const std::vector<std::string>& parts) const {
    std::string all;
    for (const std::string& word : words) all += word + " ";
    SCOPED_TRACE(all);
    expect_refused(program(words), parts);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename().string();
      EXPECT_EQ(name.find("out"), name == "stdout.txt" ? 3 : std::string::npos) << name;
    }
  }
  std::vector<std::string> run_words(const std::string& data) const {
    return {"run", "--native", "--data", data, "--size", "32x24", "--out", path("out")};
  }
  void expect_run_refused(const AslFolder& data, const std::vector<std::string>& parts) const {
    expect_refusal(run_words(data.root().string()), parts);
  }
  void expect_platform_refused(const std::string& file, const std::vector<std::string>& parts) {
    expect_refusal({"run", "--platform", path(file), "--data", data_.root().string(), "--size",
                    "32x24", "--out", path("out")},
                   parts);
  }
  void expect_plan_refused(const std::string& file, const std::vector<std::string>& parts) {
    expect_refusal({"sweep", path(file), "--out", path("out"), "--cache", path("cache")}, parts);
  }

  TempFolder folder_;
  AslFolder data_;
};

TEST_F(Inputs, YamlThatDidNotEnd) {
  std::string aliases = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 10; ++i) {
    aliases += fmt::format("a{0}: &a{0} [", i);
    for (int k = 0; k < 9; ++k) aliases += fmt::format("*a{}, ", i - 1);
    aliases += "x]\n";
  }
  const std::vector<std::pair<std::string, std::string>> kTexts = {
      {",", ":1: not valid YAML"},
      {",time,x\n0,1,2\n1,3,4\n", ":1: not valid YAML"},
      {"[1],2", ":1: not valid YAML"},
      {"{\"a\":1},\n{\"a\":2}\n", ":1: not valid YAML"},
      {"base: &b { points: *b }\n", ":1: base: anchors (&) and aliases (*)"},
      {"&x base: 1\npoints: *x\n", ":1: anchors (&) and aliases (*)"},
      {aliases, ":1: a0: anchors (&) and aliases (*)"},
      {std::string(100'000, '['), ":1: is nested deeper than 64 levels"},
      {"a: 1\na: 2\n", ":2: a: duplicate key, first given on line 1"},
      {"a: 1\n---\nb: 1\n", ":2: a second document begins"},
      {"", ":1: the file is empty"},
  };
  for (const auto& [text, message] : kTexts) {
    write("it.yaml", text);
    expect_plan_refused("it.yaml", {"it.yaml" + message});
    expect_platform_refused("it.yaml", {"it.yaml" + message});
  }
}

TEST_F(Inputs, ThePlatformOfATrace) {
  traces::WorkTraceWriter writer(3);
  for (int i = 0; i < 3; ++i) writer.add(traces::testing::example_frame(i));
  traces::WorkTraceInfo info = traces::testing::example_info();
  info.platform_yaml = ",";
  write("it.trace", writer.finish(std::move(info)));
  expect_refusal({"replay", path("it.trace"), "--out", path("out")},
                 {"it.trace", "not valid YAML"});
  expect_refusal({"trace", "check", path("it.trace")}, {"it.trace", "not valid YAML"});
  write("it.yaml", "base: { trace: it.trace }\npoints: { grid: { cores: [1] } }\n");
  expect_plan_refused("it.yaml", {"it.trace", "not valid YAML"});
}

TEST_F(Inputs, WhatIsNoRegularFile) {
  ASSERT_EQ(::mkfifo((folder_ / "fifo.yaml").c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", folder_ / "zero.yaml");
  fs::create_directory(folder_ / "folder.yaml");
  fs::create_symlink("round.yaml", folder_ / "round.yaml");
  const std::vector<std::pair<std::string, std::string>> kFiles = {
      {"fifo.yaml", "is a FIFO"},
      {"zero.yaml", "is a device"},
      {"folder.yaml", "is a folder"},
      {"round.yaml", "Too many levels of symbolic links"},
      {std::string(300, 'x') + ".yaml", "File name too long"},
      {"none.yaml", "No such file"},
  };
  for (const auto& [file, reason] : kFiles) {
    expect_platform_refused(file, {file, "cannot be opened as a platform file", reason});
    expect_plan_refused(file, {file, "cannot be opened as a plan", reason});
  }
  for (const char* name : {"fifo.yaml", "zero.yaml"}) {
    expect_refusal({"eval", path(name), path(name)}, {name, "expected a regular file"});
    expect_refusal({"replay", path(name), "--out", path("out")},
                   {name, "cannot be opened as a work trace", "expected a regular file"});
    expect_refusal({"trace", "info", path(name)}, {name, "expected a regular file"});
  }
}

TEST_F(Inputs, NamesThatCannotBeLookedUp) {
  fs::create_symlink("round", folder_ / "round");
  const std::string longest(300, 'x');
  for (const std::string& name : {std::string("round"), longest}) {
    const std::string reason =
        name == "round" ? "Too many levels of symbolic links" : "File name too long";
    const std::vector<std::string> parts{name + ": cannot be looked up: " + reason};
    expect_refusal(run_words(path(name)), parts);
    expect_refusal({"eval", path(name), path(name)}, parts);
    expect_refusal({"replay", path(name), "--out", path("out")}, parts);
    expect_refusal({"synth", "--motion", path(name), "--out", path("flight")}, parts);
  }
}

TEST_F(Inputs, FilesThatAreTooLarge) {
  const auto grow = [&](const std::string& name, std::uintmax_t mebibytes) {
    write(name, "");
    fs::resize_file(folder_ / name, (mebibytes << 20) + 1);  // a hole
  };
  grow("it.yaml", 1);
  expect_platform_refused("it.yaml", {"it.yaml", "larger than a platform file", "1 MiB"});
  expect_plan_refused("it.yaml", {"it.yaml", "larger than a plan", "1 MiB"});
  grow("it.tum", 256);
  expect_refusal({"eval", path("it.tum"), path("it.tum")}, {"it.tum", "larger than a table"});
  grow("it.trace", 4096);
  expect_refusal({"trace", "info", path("it.trace")}, {"it.trace", "larger than a work trace"});
}

TEST_F(Inputs, StreamsThatAreNoFiles) {
  for (const char* name : {"cam0/sensor.yaml", "cam0/data.csv", "imu0/data.csv"}) {
    const AslFolder data;
    fs::remove(data.mav0(name));
    ASSERT_EQ(::mkfifo(data.mav0(name).c_str(), 0600), 0);
    expect_run_refused(data, {name, "not found in"});
  }
  const AslFolder data;
  fs::remove(data.image(2));
  ASSERT_EQ(::mkfifo(data.image(2).c_str(), 0600), 0);
  expect_run_refused(data, {"cam0/data.csv line 4", "is no regular file"});
}

/// Replaces something in one stream and expects that a run is refused.
struct Spoiled {
  const char* file;
  const char* from;
  const char* to;
  std::vector<std::string> parts;
};

TEST_F(Inputs, SensorsThatCannotBe) {
  const std::string camera = "cam0/sensor.yaml";
  const std::string imu = "imu0/sensor.yaml";
  const std::vector<Spoiled> kSpoiled = {
      {"cam0/sensor.yaml",
       "[32, 24]",
       "[65535, 65535]",
       {camera + " line 14, key 'resolution'", "16777216 pixels"}},
      {"cam0/sensor.yaml",
       "rate_hz: 20",
       "rate_hz: 1e300",
       {camera + " line 13, key 'rate_hz'", "1e+300", "from 0.001 to 100000"}},
      {"cam0/sensor.yaml", "rate_hz: 20", "rate_hz: 1e-300", {"key 'rate_hz'", "from 0.001"}},
      {"imu0/sensor.yaml",
       "rate_hz: 200",
       "rate_hz: 1e300",
       {imu + " line", "key 'rate_hz'", "from 0.001 to 100000"}},
      {"cam0/sensor.yaml",
       "rate_hz: 20\n",
       "rate_hz: 20\nrate_hz: 30\n",
       {camera + " line 14, key 'rate_hz': duplicate key, first given on line 13"}},
      {"cam0/sensor.yaml",
       "rate_hz: 20\n",
       "---\nrate_hz: 20\n",
       {camera + " line", "a second document begins"}},
      {"cam0/sensor.yaml", "[20, 21,", "[1e30, 21,", {"key 'intrinsics'", "1e+30"}},
      {"cam0/sensor.yaml", "15.5, 11.25]", "-1e300, 11.25]", {"key 'intrinsics'", "-1e+300"}},
      {"cam0/sensor.yaml",
       "[-0.2, 0.05",
       "[-0.2, 1e20",
       {"key 'distortion_coefficients'", "1e+20"}},
      {"cam0/sensor.yaml",
       "data: [1, 0, 0, 0",
       "data: [1, 0, 0, 1e9",
       {"'T_BS.data'", "1000000000 is beyond"}},
      {"imu0/sensor.yaml",
       "gyroscope_noise_density: 0.0001",
       "gyroscope_noise_density: 1e9",
       {"key 'gyroscope_noise_density'", "at most 1000"}},
      {"imu0/sensor.yaml", "sensor_type: imu", ",", {imu + " line 1: not valid YAML"}},
  };
  for (const Spoiled& spoiled : kSpoiled) {
    const AslFolder data;
    data.replace(spoiled.file, spoiled.from, spoiled.to);
    expect_run_refused(data, spoiled.parts);
  }
}

TEST_F(Inputs, MeasurementsThatNoSensorGives) {
  for (const char* value : {"1e308", "-1e30", "10001"}) {
    const AslFolder data;
    data.set_line("imu0/data.csv", 5, fmt::format("4965000000,0,0,0,0,{},9.8", value));
    expect_run_refused(data, {"imu0/data.csv line 5, column 6 (a_RS_S_y)", value,
                              "any accelerometer", "from -10000 to 10000"});
  }
  for (const char* value : {"1e308", "-1e30", "1001"}) {
    const AslFolder data;
    data.set_line("imu0/data.csv", 5, fmt::format("4965000000,0,0,{},0,9.8,0", value));
    expect_run_refused(data, {"imu0/data.csv line 5, column 4 (w_RS_S_z)", value, "any gyroscope"});
  }
  const AslFolder data;
  data.set_line("state_groundtruth_estimate0/data.csv", 5,
                "4965000000,0,2e7,0,1,0,0,0,0,0,0,0,0,0,0,0,0");
  expect_run_refused(data, {"data.csv line 5, column 3 (p_RS_R_y)", "'2e7'", "any flight"});
}

TEST_F(Inputs, StampsThatDoNotFit) {
  const AslFolder data;
  data.set_line("cam0/data.csv", 7, "9223372036854775807,x.png");
  expect_run_refused(data, {"cam0/data.csv line 7, column 1", "9e18"});
}

/// Eleven years between the last two frames, which IMU and truth seem to cover. The first
/// picture cannot be read, so that a run that gets so far says something else.
TEST_F(Inputs, FlightsThatAreLongerThanSimulatedTimeAreFoundBeforeTheFirstFrame) {
  const AslFolder data;
  constexpr const char* kLast = "350000005000000000";
  data.set_line("cam0/data.csv", 7, fmt::format("{},5250000000.png", kLast));
  data.replace("imu0/sensor.yaml", "rate_hz: 200", "rate_hz: 0.001");
  std::string samples = "#timestamp\n";
  for (std::int64_t t_ns = 4'950'000'000; t_ns < 350'003'000'000'000'000; t_ns += 1'000'000'000'000)
    samples += fmt::format("{},0,0,0,0,0,9.8\n", t_ns);
  outputs::write_file_atomically(data.mav0("imu0/data.csv"), samples);
  outputs::write_file_atomically(data.image(0), "no picture");
  expect_refusal({"run", "--platform", "gap9", "--data", data.root().string(), "--size", "32x24",
                  "--out", path("out")},
                 {"is outside the simulated range"});
}

/// The first picture cannot be read, so that a run that gets so far says something else.
TEST_F(Inputs, TruthThatDoesNotOverlapIsFoundBeforeTheFirstFrame) {
  const AslFolder data;
  std::string truth = "#timestamp\n";
  for (int i = 0; i < 5; ++i)
    truth += fmt::format("{},0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n", 90'000'000'000 + i);
  outputs::write_file_atomically(data.mav0("state_groundtruth_estimate0/data.csv"), truth);
  outputs::write_file_atomically(data.image(0), "no picture");
  const std::vector<std::string> parts{"state_groundtruth_estimate0/data.csv: none of the 6 frames",
                                       "5000000000", "90000000000", "expected at least 3"};
  expect_run_refused(data, parts);
  const std::string folder = data.root().string();
  expect_refusal(
      {"run", "--platform", "gap9", "--data", folder, "--size", "32x24", "--out", path("out")},
      parts);
  expect_refusal({"ablate", "--data", folder, "--out", path("out"), "--cache", path("cache")},
                 parts);
  expect_refusal({"tune", "--platform", "gap9", "--clock", "370", "--data", folder, "--out",
                  path("out"), "--cache", path("cache")},
                 parts);
}

TEST_F(Inputs, TwoPosesOfTruthAreTooFew) {
  const AslFolder data;
  const std::string truth = base::read_text_file(data.mav0("state_groundtruth_estimate0/data.csv"));
  const std::size_t end = truth.find("5055000000");  // frames 0 and 1 lie before
  ASSERT_NE(end, std::string::npos);
  outputs::write_file_atomically(data.mav0("state_groundtruth_estimate0/data.csv"),
                                 truth.substr(0, end));
  expect_run_refused(data, {"2 of the 6 frames", "expected at least 3"});
}

/// The truth covers three frames, of which the slow chip takes one.
TEST_F(Inputs, ARunThatDropsTheFramesOfItsTruthKeepsItsResults) {
  traces::write_synthetic_flight(folder_ / "flight", {.duration_s = 1, .texel_m = 0.02});
  const fs::path file = folder_ / "flight/mav0/state_groundtruth_estimate0/data.csv";
  const std::string truth = base::read_text_file(file);
  const std::size_t end = truth.find("1000105000000");
  ASSERT_NE(end, std::string::npos);
  outputs::write_file_atomically(file, truth.substr(0, end));
  const ProgramResult result =
      program({"run", "--platform", "gap9", "--data", path("flight"), "--out", path("out"),
               "--deadline", "drop", "-p", "cluster.clock=20MHz"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("ATE: none: SE3 alignment needs at least 3 matched poses"),
            std::string::npos)
      << result.out;
  EXPECT_TRUE(fs::exists(folder_ / "out/trajectory.tum"));
}

/// Libraries of pictures have a habit of printing.
TEST_F(Inputs, DamagedPicturesAreOneLine) {
  const auto expect = [&](const std::string& bytes, const std::string& part) {
    const AslFolder data;
    outputs::write_file_atomically(data.image(0), bytes);
    expect_run_refused(data, {"5000000000.png", "cam0/data.csv line 2", part});
  };
  std::string png = base::read_text_file(data_.image(0));
  expect(png.substr(0, png.size() / 2), "damaged PNG");
  std::string flipped = png;
  flipped[png.size() / 2] = static_cast<char>(flipped[png.size() / 2] ^ 0x10);
  expect(flipped, "damaged PNG");
  expect(png.substr(0, 8) + std::string(100, 'x'), "damaged PNG");

  const std::string bytes = tests::jpeg_of(cv::Mat(24, 32, CV_8UC1, 7.0));
  expect(bytes.substr(0, bytes.size() / 2), "damaged JPEG");
  expect(bytes.substr(0, 4) + std::string(100, 'x'), "damaged JPEG");
  expect("P5 32 24 255\n" + std::string(32 * 24, 'x'), "neither PNG nor JPEG");
}

}  // namespace
}  // namespace leviosim::tools
