// No command deletes or replaces a file that it did not write: all commands with outputs, in places
// that are full of things of others.
#include <gtest/gtest.h>

#include <functional>

#include "tests/support/run_program.h"
#include "tests/support/scratch.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::ProgramResult;
using testing::run_program;
using tests::picture_of;
using tests::Scratch;
using tests::write_text;
using Picture = std::map<std::string, std::string>;
using Arguments = std::vector<std::string>;

struct OutputCommand {
  std::string name;
  Arguments words;       ///< without the output
  std::string option;    ///< that names the output
  std::string out;       ///< name of the output; a folder if it has no extension
  bool adds_to = false;  ///< what it wrote before
};

/// What all commands read, made once: a short flight and its recorded work.
struct Inputs {
  Scratch folder;
  std::string flight = (folder / "flight").string();
  std::string truth = flight + "/mav0/state_groundtruth_estimate0/data.csv";

  Inputs() {
    traces::SyntheticOptions options;
    options.duration_s = 1.5;  // the first second is at rest
    options.texel_m = 0.05;
    for (double* length :
         {&options.camera.fx, &options.camera.fy, &options.camera.cx, &options.camera.cy})
      *length /= 4;
    options.camera.width = 188;
    options.camera.height = 120;
    traces::write_synthetic_flight(flight, options);
    write_text(folder / "plan.yaml",
               "base: { data: flight, platform: gap9 }\n"
               "points: { grid: { seed: [1] } }\n");
    write_text(folder / "flights.yaml",
               "motions: [flight]\nworlds: { one: [1] }\npieces: [whole]\nseeds: [1]\n");
    write_text(folder / "budgets.yaml", "budgets:\n  - limits: [L1 peak <= 128 KiB]\n");
    const ProgramResult recorded =
        run_program(folder.path(), {"run", "--platform", "gap9", "--data", flight, "--record",
                                    "--quiet", "--out", (folder / "recorded").string()});
    EXPECT_EQ(recorded.status, 0) << recorded.err;
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }

  std::vector<OutputCommand> commands() const {
    const Arguments batch{"--data",    flight,  "--relative", "0.0001",      "--seed", "1",
                          "--profile", "levio", "--cache",    path("cache"), "--quiet"};
    const auto with = [](Arguments words, const Arguments& more) {
      words.insert(words.end(), more.begin(), more.end());
      return words;
    };
    const Arguments data{"--data", flight, "--quiet"};
    return {
        {"run", with({"run", "--native"}, data), "--out", "out"},
        {"flow", with({"flow", "--platform", "gap9"}, data), "--out", "out"},
        {"replay", {"replay", path("recorded"), "--quiet"}, "--out", "out"},
        {"validate", with({"validate"}, data), "--out", "out"},
        {"ablate", with({"ablate"}, batch), "--out", "out"},
        {"ablate --vary", with({"ablate", "--vary", "paper", "--points", "1"}, batch), "--out",
         "out"},
        {"benchmark-flights",
         {"benchmark-flights", path("flights.yaml"), "--motions", folder.path().string(), "--cache",
          path("cache"), "--quiet"},
         "--out",
         "out"},
        {"tune", with({"tune", "--clock", "370", "--cache", path("cache")}, data), "--out", "out"},
        {"synth", {"synth", "--motion", flight, "--frames", "0:2", "--quiet"}, "--out", "out"},
        {"sweep",
         {"sweep", path("plan.yaml"), "--cache", path("cache"), "--quiet"},
         "--out",
         "out",
         true},
        {"sensitivity", with({"sensitivity", "--frames", "0:2"}, data), "--csv", "out.csv"},
        {"feasibility", with({"platforms", "feasibility", "gap9", "--frames", "0:2"}, data),
         "--csv", "out.csv"},
        {"check",
         {"check", path("recorded"), "--budget", path("budgets.yaml"), "--quiet"},
         "--junit",
         "out.xml"},
        {"microbench", {"microbench"}, "--csv", "out.csv"},
        {"eval_json", {"eval", truth, truth, "--relative", "0.0001"}, "--json", "out.json"},
        {"eval_report", {"eval", truth, truth, "--relative", "0.0001"}, "--report", "out.html"}};
  }
};

/// A place for an output, and what there is not leviosim's.
class Place {
 public:
  Place(const Scratch& folder, const OutputCommand& command, std::uint64_t seed)
      : area_(folder / "area"), out_(area_ / command.out), rng_(seed) {
    write_text(folder / "precious/thesis.tex", "work of years");
    fs::create_directories(area_);
  }

  const fs::path& out() const { return out_; }
  const fs::path& area() const { return area_; }

  /// In place of the output, @param own  what the command left elsewhere
  void fill(const fs::path& own) {
    switch (rng_.below(8)) {
      case 0:
        return;
      case 1:
        fs::create_symlink("../precious", out_);
        return;
      case 2:
        fs::create_symlink("../precious/thesis.tex", out_);
        return;
      case 3:
        fs::create_symlink("nowhere", out_);
        return;
      case 4:
        write_text(out_, "mine");
        return;
      case 5:
        fs::create_directory(out_);
        return add_to(out_);
      default:
        copy_results(own);
    }
  }
  void add_neighbours() {
    const std::string name = out_.filename().string();
    for (const std::string& hidden :
         {"." + name + ".leviosim", out_.stem().string() + "-2" + out_.extension().string()})
      if (rng_.below(4) == 0) add_one(area_ / hidden);
    if (rng_.below(6) == 0) write_text(area_ / ".leviosim-files", "mine\n");
    add_to(area_);
  }

 private:
  /// With something of others among them, or changed.
  void copy_results(const fs::path& own) {
    if (!fs::exists(own / out_.filename())) return;
    fs::copy(own, area_, fs::copy_options::recursive);
    if (!fs::is_directory(out_)) {
      if (rng_.below(2) == 0) write_text(out_, "edited");
      return;
    }
    if (rng_.below(2) == 0) return add_to(out_);
    std::vector<fs::path> files;
    for (const auto& [name, what] : picture_of(out_))
      if (what != "folder" && name != ".leviosim-files") files.push_back(out_ / name);
    write_text(files[static_cast<std::size_t>(rng_.below(static_cast<int>(files.size())))],
               "edited");
  }
  void add_to(const fs::path& folder) {
    constexpr const char* kNames[] = {"notes.md",     "manifest.json", "mav0",      "run.json",
                                      "points.jsonl", "sweep.csv",     "deep/dive", "x\ny",
                                      "sweep.sqlite", ".hidden",       "chosen"};
    for (const char* name : kNames)
      if (rng_.below(4) == 0 && !fs::exists(fs::symlink_status(folder / name)))
        add_one(folder / name);
    add_one(folder / "z");  // at least one
  }
  void add_one(const fs::path& path) {
    fs::create_directories(path.parent_path());
    switch (rng_.below(5)) {
      case 0:
        fs::create_symlink("../precious/thesis.tex", path);
        return;
      case 1:
        fs::create_symlink("nowhere", path);
        return;
      case 2:
        write_text(path / "data", "mine");
        return;
      default:
        write_text(path, "mine");
    }
  }

  fs::path area_;
  fs::path out_;
  traces::Rng rng_;
};

/// What was there and is not leviosim's, or must stay since nothing was to be replaced.
void expect_kept(const Picture& before, const Picture& after, const Picture& own, bool force,
                 const std::string& out) {
  for (const auto& [name, what] : before) {
    const auto written = own.find(name);
    const bool is_own = written != own.end() && written->second == what;
    if (is_own && (force || name == ".leviosim-files")) continue;
    const auto left = after.find(name);
    EXPECT_TRUE(left != after.end()) << name << " is gone (" << out << ")";
    if (left != after.end()) {
      EXPECT_EQ(left->second, what) << name;
    }
  }
}

TEST(OutputsProperty, NoCommandTouchesWhatItDidNotWrite) {
  const Inputs inputs;
  for (const OutputCommand& command : inputs.commands()) {
    SCOPED_TRACE(command.name);
    const Scratch log;
    const Scratch own;
    const auto words = [&](const fs::path& out, bool force) {
      Arguments all = command.words;
      all.insert(all.end(), {command.option, out.string()});
      if (force) all.push_back("--force");
      return all;
    };
    const ProgramResult clean = run_program(log.path(), words(own / command.out, false));
    const bool is_beyond_limits = command.name == "tune" || command.name == "validate";
    EXPECT_EQ(clean.status, is_beyond_limits ? 1 : 0) << clean.err;
    const Picture own_files = picture_of(own.path());
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      SCOPED_TRACE(seed);
      const bool force = seed % 3 != 0;
      const Scratch folder;
      Place place(folder, command, seed + 100);
      place.fill(own.path());
      place.add_neighbours();
      const Picture before = picture_of(place.area());
      const Picture precious = picture_of(folder / "precious");
      const ProgramResult result = run_program(log.path(), words(place.out(), force));
      EXPECT_TRUE(result.status >= 0 && result.status <= 2) << result.status << result.err;
      EXPECT_EQ(picture_of(folder / "precious"), precious);
      expect_kept(before, picture_of(place.area()), own_files, force || command.adds_to,
                  result.err);
    }
  }
}

}  // namespace
}  // namespace leviosim::tools
