// A table of bad inputs, one row each: the files that are put there, the command, and what its one
// message must say.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "tests/traces/test_folder.h"

namespace leviosim::tools::bad_inputs {

namespace fs = std::filesystem;
using traces::testing::AslFolder;
using Arguments = std::vector<std::string>;

/// Makes the row's files in the folder, or spoils the data.
using Setup = std::function<void(const fs::path& folder, const AslFolder& data)>;

/// In the words, @D is a data folder of six frames, @F the row's folder, @T a recorded trace and @E
/// the trajectory of that run.
struct Row {
  const char* name;
  Arguments words;
  Arguments message;  ///< parts of it
  Setup setup = {};
};
inline void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }

inline Setup file(const std::string& name, const std::string& contents) {
  return [=](const fs::path& folder, const AslFolder&) {
    std::ofstream(folder / name, std::ios::binary) << contents;
  };
}

inline Setup spoilt(const std::string& name, const std::string& from, const std::string& to) {
  return [=](const fs::path&, const AslFolder& data) { data.replace(name, from, to); };
}

inline Setup line(const std::string& name, std::size_t number, const std::string& text) {
  return [=](const fs::path&, const AslFolder& data) { data.set_line(name, number, text); };
}

inline Setup spoilt_image(const std::string& contents) {
  return [=](const fs::path&, const AslFolder& data) {
    std::ofstream(data.image(2), std::ios::binary) << contents;
  };
}

inline Setup folder_with(const std::string& name, const std::string& contents) {
  return [=](const fs::path& folder, const AslFolder&) {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << contents;
  };
}

inline Arguments run(const Arguments& more, const std::string& data = "@D") {
  Arguments words{"run", "--quiet", "--platform", "gap9", "--data", data};
  words.insert(words.end(), more.begin(), more.end());
  const auto by_default = [&](const char* option, const char* value) {
    if (std::find(words.begin(), words.end(), option) == words.end())
      words.insert(words.end(), {option, value});
  };
  by_default("--size", "32x24");
  by_default("--out", "@F/out");
  return words;
}

inline Arguments on_platform() {
  return {"run", "--platform", "@F/p.yaml", "--data", "@D", "--size", "32x24", "--out", "@F/out"};
}

inline Arguments with_plan() {
  return {"sweep", "@F/p.yaml", "--out", "@F/out", "--cache", "@F/cache"};
}

inline Arguments eval(const std::string& estimate, const Arguments& more = {}) {
  Arguments words{"eval", estimate, "@D"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

inline std::vector<Row> command_lines() {
  return {
      {"UnknownCommand", {"rnu"}, {"rnu", "did you mean 'run'"}},
      {"UnknownOption", run({"--forse"}), {"--forse", "did you mean '--force'"}},
      {"EmptyOut", {"run", "--native", "--data", "@D", "--out=", "--quiet"}, {"--out"}},
      {"UnknownPlatform",
       {"run", "--platform", "gap7", "--data", "@D", "--out", "@F/out"},
       {"gap7", "did you mean"}},
      {"UnknownProfile", run({"--profile", "nxt"}), {"nxt", "next"}},
      {"SeedBelowZero", run({"--seed", "-1"}), {"--seed '-1'", "whole number"}},
      {"SeedTooLarge", run({"--seed", "99999999999"}), {"--seed", "99999999999"}},
      {"CoresZero", run({"--cores", "0"}), {"--cores '0'"}},
      {"CoresTooMany", run({"--cores", "4096"}), {"--cores"}},
      {"SizeNoNumber", run({"--size", "axb"}), {"--size 'axb'", "whole numbers from 1 to"}},
      {"SizeHuge", run({"--size", "999999999x3"}), {"--size"}},
      {"FramesBackwards", run({"--frames", "5:2"}), {"'5:2'"}},
      {"FramesBeyond", run({"--frames", "3:99"}), {"99"}},
      {"ParameterUnknown", run({"-p", "cluster.fpus=2"}), {"cluster.fpus", "did you mean"}},
      {"ParameterNoNumber", run({"-p", "cluster.fpu.units=many"}), {"many"}},
      {"ParameterNan", run({"-p", "cluster.clock=nanMHz"}), {"cluster.clock"}},
      {"ParameterBelowZero", run({"-p", "cluster.clock=-5MHz"}), {"cluster.clock"}},
      {"ParameterWrongUnit", run({"-p", "cluster.clock=5kg"}), {"cluster.clock", "kg"}},
      {"ParameterOutOfRange", run({"-p", "cluster.fpu.units=1e300"}), {"cluster.fpu.units"}},
      {"ParameterWithoutValue", run({"-p", "cluster.clock"}), {"cluster.clock"}},
      {"ParameterControlCharacters", run({"-p", "clu\x1b[2Jster\n=3"}), {"\\x1b[2J"}},
      {"WorkloadUnknown", run({"-p", "workload.windw=3"}), {"workload.windw", "workload.window"}},
      {"WorkloadOutOfRange", run({"-p", "workload.window=1e9"}), {"workload.window"}},
      {"CameraRateZero", run({"--fps", "0"}), {"--fps"}},
      {"CameraRateTiny", run({"--fps", "1e-10"}), {"--fps '1e-10'", "from 0.001"}},
      {"InitialDelayNegative", run({"--initial-delay", "-1"}), {"'-1'", "from 0 to 10"}},
      {"InitialDelayOfLevio", run({"--initial-delay", "1"}), {"--profile next"}},
      {"InitialDelayOfOnline",
       run({"--profile", "next", "--online", "--initial-delay", "1"}),
       {"--online", "--initial-delay"}},
      {"DoctorOfNothing", {"doctor", "@F/nosuch"}, {"nosuch", "does not exist"}},
      {"DeadlineUnknown", run({"--fps", "10", "--deadline", "dorp"}), {"dorp", "drop"}},
      {"RecordNative",
       {"run", "--native", "--record", "--data", "@D", "--out", "@F/out"},
       {"--record"}},
      {"OutIsFile", run({"--out", "@F/f"}), {"is a file"}, file("f", "mine")},
      {"OutIsForeign", run({"--force"}), {"thesis.tex"}, folder_with("out/thesis.tex", "mine")},
      {"OutHasForeignManifest", run({"--force"}), {"out"}, folder_with("out/manifest.json", "{}")},
      {"OutBelowFile", run({"--out", "@F/f/out"}), {"f"}, file("f", "mine")},
      {"OutNameTooLong", run({"--out", "@F/" + std::string(300, 'x')}), {"too long"}},
      {"OutLinkLoop",
       run({"--out", "@F/loop"}),
       {"loop"},
       [](const fs::path& folder, const AslFolder&) {
         fs::create_symlink(folder / "loop", folder / "loop");
       }},
      {"OutIsData", run({"--out", "@D", "--force"}), {"--out"}},
      {"TuneClockBackwards",
       {"tune", "--data", "@D", "--clock", "300:100:10", "--out", "@F/out"},
       {"300:100:10"}},
      {"TuneClockTooMany",
       {"tune", "--data", "@D", "--clock", "100:370:0.000001", "--out", "@F/out"},
       {"--clock"}},
      {"MicrobenchOutExists", {"microbench", "--csv", "@F/f"}, {"exists"}, file("f", "mine")},
      {"SynthDurationNoNumber",
       {"synth", "--duration", "long", "--out", "@F/out"},
       {"--duration", "long"}},
      {"SynthOverRecording", {"synth", "--force", "--out", "@D"}, {"mav0", "no record"}},
      {"SynthMotionMissing", {"synth", "--motion", "@F/none", "--out", "@F/out"}, {"none"}},
      {"PlatformsActionUnknown", {"platforms", "lst"}, {"lst", "did you mean 'list'"}},
      {"TraceActionUnknown", {"trace", "chek", "@T"}, {"chek", "check"}},
  };
}

inline std::vector<Row> data_sets() {
  const std::string camera = "cam0/sensor.yaml";
  const std::string imu = "imu0/data.csv";
  const std::string truth = "state_groundtruth_estimate0/data.csv";
  return {
      {"DataMissing", run({}, "@F/none"), {"none"}},
      {"DataIsFile", run({}, "@F/f"), {"f"}, file("f", "x")},
      {"DataIsEmpty",
       run({}, "@F/empty"),
       {"looked for", "mav0/"},
       [](const fs::path& folder, const AslFolder&) { fs::create_directory(folder / "empty"); }},
      {"DataLinkLoop",
       run({}, "@F/loop"),
       {"loop"},
       [](const fs::path& folder, const AslFolder&) {
         fs::create_symlink(folder / "loop", folder / "loop");
       }},
      {"DataNameTooLong", run({}, "@F/" + std::string(5000, 'y')), {"too long"}},
      {"CameraYamlComma",
       run({}),
       {"sensor.yaml"},
       [](const fs::path&, const AslFolder& data) {
         std::ofstream(data.mav0("cam0/sensor.yaml")) << ",";
       }},
      {"CameraYamlNoMapping",
       run({}),
       {"sensor.yaml"},
       [](const fs::path&, const AslFolder& data) {
         std::ofstream(data.mav0("cam0/sensor.yaml")) << "- 1\n- 2\n";
       }},
      {"CameraResolutionHuge",
       run({}),
       {"resolution"},
       spoilt(camera, "[32, 24]", "[65535, 65535]")},
      {"CameraResolutionZero", run({}), {"resolution"}, spoilt(camera, "[32, 24]", "[0, 24]")},
      {"CameraResolutionOther", run({}), {"33"}, spoilt(camera, "[32, 24]", "[33, 24]")},
      {"CameraRateHuge", run({}), {"rate_hz"}, spoilt(camera, "rate_hz: 20", "rate_hz: 1e300")},
      {"CameraKeyTwice",
       run({}),
       {"rate_hz"},
       spoilt(camera, "rate_hz: 20", "rate_hz: 20\nrate_hz: 30")},
      {"CameraSecondDocument",
       run({}),
       {"sensor.yaml"},
       spoilt(camera, "rate_hz: 20", "rate_hz: 20\n---\na: 1")},
      {"CameraTableText", run({}), {"data.csv line 3"}, line("cam0/data.csv", 3, "x,y.png")},
      {"CameraTableOverflow",
       run({}),
       {"data.csv line 3"},
       line("cam0/data.csv", 3, "99999999999999999999,a.png")},
      {"CameraTableBackwards",
       run({}),
       {"data.csv line 3", "stamps must rise"},
       line("cam0/data.csv", 3, "5,5.png")},
      {"ImageMissing",
       run({}),
       {".png"},
       [](const fs::path&, const AslFolder& data) { fs::remove(data.image(2)); }},
      {"ImageEmpty", run({}), {".png"}, spoilt_image("")},
      {"ImageText", run({}), {".png"}, spoilt_image("this is no picture")},
      {"ImageBomb",
       run({}),
       {".png"},
       spoilt_image(std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\x7f\xff\xff\xff\x7f\xff\xff\xff\x08"
                                "\0\0\0\0\x12\x34\x56\x78",
                                33))},
      {"ImageIsFolder",
       run({}),
       {".png"},
       [](const fs::path&, const AslFolder& data) {
         fs::remove(data.image(2));
         fs::create_directory(data.image(2));
       }},
      {"ImageIsFifo",
       run({}),
       {".png"},
       [](const fs::path&, const AslFolder& data) {
         fs::remove(data.image(2));
         ASSERT_EQ(::mkfifo(data.image(2).c_str(), 0600), 0);
       }},
      {"ImuIsDevice",
       run({}),
       {"data.csv"},
       [](const fs::path&, const AslFolder& data) {
         fs::remove(data.mav0("imu0/data.csv"));
         fs::create_symlink("/dev/zero", data.mav0("imu0/data.csv"));
       }},
      {"ImuNan", run({}), {"data.csv line 4"}, line(imu, 4, "4955000000,nan,0,0,0,0,0")},
      {"ImuHuge", run({}), {"data.csv line 4"}, line(imu, 4, "4955000000,1e308,0,0,0,0,0")},
      {"ImuLarge", run({}), {"data.csv line 4"}, line(imu, 4, "4955000000,0,0,0,1e30,0,0")},
      {"ImuColumns", run({}), {"data.csv line 4", "column"}, line(imu, 4, "4955000000,1,2,3")},
      {"ImuEmpty",
       run({}),
       {"data.csv"},
       [](const fs::path&, const AslFolder& data) {
         std::ofstream(data.mav0("imu0/data.csv")) << "#timestamp\n";
       }},
      {"ImuMissing",
       run({}),
       {"imu0"},
       [](const fs::path&, const AslFolder& data) { fs::remove(data.mav0("imu0/data.csv")); }},
      {"TruthElsewhere",
       run({}),
       {"ground truth"},
       [](const fs::path&, const AslFolder& data) {
         std::ofstream(data.mav0("state_groundtruth_estimate0/data.csv"))
             << "#t,px,py,pz,qw,qx,qy,qz,vx,vy,vz,bwx,bwy,bwz,bax,bay,baz\n"
                "1000000000,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n"
                "1005000000,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n";
       }},
      {"TruthNoRotation",
       run({}),
       {"data.csv line 4"},
       line(truth, 4, "4955000000,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0")},
  };
}

inline std::string nested(const std::string& open, const std::string& close, int depth) {
  std::string text;
  for (int i = 0; i < depth; ++i) text += open;
  for (int i = 0; i < depth; ++i) text += close;
  return text;
}

/// Nine levels of nine aliases each: 9⁹ scalars if they were expanded.
inline std::string billion_laughs() {
  std::string text = "a0: &a0 x\n";
  for (int i = 1; i < 10; ++i) {
    text += fmt::format("a{0}: &a{0} [", i);
    for (int k = 0; k < 9; ++k) text += fmt::format("{}*a{}", k == 0 ? "" : ", ", i - 1);
    text += "]\n";
  }
  return text;
}

inline std::vector<Row> texts() {
  std::vector<Row> rows;
  const struct {
    const char* name;
    std::string text;
  } kTexts[] = {
      {"Empty", ""},
      {"Comma", ","},
      {"CommaFirst", ",a,b\n0,1,2\n"},
      {"AfterSequence", "[1],2"},
      {"AfterMapping", "{\"a\":1},\n{\"b\":2}\n"},
      {"Bomb", billion_laughs()},
      {"OwnAlias", "base: &a { platform: *a }\npoints: *a\n"},
      {"Deep", nested("[", "]", 20000)},
      {"DeepMapping", nested("{a: ", "}", 5000)},
      {"NoUtf8", "base: \xff\xfe\n"},
      {"Zeros", std::string(1000, '\0')},
      {"Scalar", "hello\n"},
      {"Unclosed", "base: { a: [1, 2\n"},
      {"Tab", "base:\n\t- a\n"},
  };
  for (const auto& [name, text] : kTexts) {
    rows.push_back({name, on_platform(), {"p.yaml"}, file("p.yaml", text)});
    rows.push_back({name, with_plan(), {"p.yaml"}, file("p.yaml", text)});
  }
  rows.push_back({"UnknownKey",
                  on_platform(),
                  {"p.yaml", "clutser"},
                  file("p.yaml",
                       "name: mine\ndescription: mine\nextends: gap9\nclutser: { workers: { value: "
                       "4, unit: cores } }\n")});
  rows.push_back({"ExtendsItself", on_platform(), {"p.yaml"}, file("p.yaml", "extends: p.yaml\n")});
  rows.push_back({"PlatformIsFolder", on_platform(), {"p.yaml"}, folder_with("p.yaml/x", "")});
  rows.push_back({"PlanIsDevice", {"sweep", "/dev/zero", "--out", "@F/out"}, {"/dev/zero"}});
  rows.push_back(
      {"PlanWithoutTrace",
       with_plan(),
       {"none.trace"},
       file("p.yaml", "base: { trace: none.trace }\npoints: [ { list: [ { seed: 1 } ] } ]\n")});
  rows.push_back(
      {"PlanUnknownKey",
       with_plan(),
       {"platfrom.cluster.clock", "platform.cluster.clock"},
       file("p.yaml",
            "base: { trace: '@T' }\npoints:\n  - grid: { platfrom.cluster.clock: [1] }\n")});
  rows.push_back(
      {"PlanTooManyPoints",
       with_plan(),
       {"points"},
       file("p.yaml",
            "base: { data: x, platform: gap9 }\npoints:\n  - random: { number: 99999999999, "
            "of: { seed: { from: 1, to: 9 } } }\n")});
  return rows;
}

inline std::vector<Row> files() {
  return {
      {"TraceMissing", {"trace", "check", "@F/none"}, {"none"}},
      {"TraceEmpty", {"trace", "check", "@F/f"}, {"f"}, file("f", "")},
      {"TraceText", {"trace", "info", "@F/f"}, {"work trace"}, file("f", "hello, hello, hello\n")},
      {"TraceIsDevice", {"trace", "check", "/dev/zero"}, {"/dev/zero"}},
      {"TraceIsFifo",
       {"trace", "check", "@F/f"},
       {"f"},
       [](const fs::path& folder, const AslFolder&) {
         ASSERT_EQ(::mkfifo((folder / "f").c_str(), 0600), 0);
       }},
      {"ReplayUnknownPlatform", {"replay", "@T", "--platform", "gap", "--out", "@F/out"}, {"gap"}},
      {"EvalMissing", eval("@F/none"), {"none"}},
      {"EvalEmpty", eval("@F/f"), {"f"}, file("f", "")},
      {"EvalText", eval("@F/f"), {"f"}, file("f", "a b c d e f g h\n")},
      {"EvalBinary", eval("@F/f"), {"f"}, file("f", std::string("\x01\x02\x00\xff\x1b[31m", 9))},
      {"EvalHuge",
       eval("@F/f"),
       {"f"},
       file("f", "5.0 1e308 0 0 0 0 0 1\n5.1 0 0 0 0 0 0 1\n5.2 -1e308 0 0 0 0 0 1\n")},
      {"EvalNoOverlap",
       eval("@F/f"),
       {"f"},
       file("f", "900 0 0 0 0 0 0 1\n901 1 0 0 0 0 0 1\n902 2 0 0 0 0 0 1\n")},
      {"EvalOverItsInput", eval("@E", {"--json", "@E", "--force"}), {"--json"}},
      {"EvalOverForeign", eval("@E", {"--json", "@F/f", "--force"}), {"f"}, file("f", "mine")},
      {"EvalAlignUnknown", eval("@E", {"--align", "se4"}), {"se4"}},
      {"EvalRelativeNoNumber", eval("@E", {"--relative", "x"}), {"--relative"}},
      {"EvalJsonIntoNothing", eval("@E", {"--json", "@F/none/a.json"}), {"none"}},
  };
}

inline std::vector<Row> all_rows() {
  std::vector<Row> rows;
  for (auto* part : {&command_lines, &data_sets, &texts, &files})
    for (Row& row : (*part)()) rows.push_back(std::move(row));
  return rows;
}

}  // namespace leviosim::tools::bad_inputs
