// The model of instruction caches (sim/chip/instruction_cache.h) against caches that are stepped
// line by line, on the code that both RANSACs execute.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "platform_models/loader/builtin.h"
#include "platform_models/loader/compiled_code.h"
#include "platform_models/loader/loader.h"
#include "sim/base/csv.h"
#include "sim/chip/chip.h"
#include "sim/work/machine.h"
#include "tests/support/code_lines.h"
#include "tests/workload/levio/two_view_scene.h"
#include "workload/levio/geometry/epnp_ransac.h"
#include "workload/levio/geometry/essential_ransac.h"

namespace leviosim::vio::test {
namespace {

using Counted = work::Counting;
using tests::CodeLayout;
using tests::CodeWalk;
using tests::LineCaches;
using tests::LineList;
using tests::Walker;

/// What a team did: its job, and the functions that each core went through.
struct Recording {
  work::Job job;
  std::vector<work::CodeTracker::EventsOfSegments> events;  ///< by core, fork by fork
  int cores = 0;
};

/// The workload's code, each piece of it larger by a factor.
const work::CodeMap& scaled_code(double factor) {
  static std::map<double, work::CodeMap> maps;
  const auto [found, is_new] = maps.try_emplace(factor);
  if (!is_new) return found->second;
  std::string scaled =
      "function,after,lines,visits,refetches,executed,priced,loads,used_at_once,"
      "executed_loops,priced_loops\n";
  for (const base::BuiltinFile& file : platform::builtin_code()) {
    if (file.name != platform::kCompiledCode) continue;
    base::CsvReader csv(file.name, base::Separator::comma,
                        {"function", "after", "lines", "visits", "refetches", "executed", "priced",
                         "loads", "used_at_once", "executed_loops", "priced_loops"},
                        std::string(file.text));
    csv.next();  // titles
    while (const base::CsvRow* row = csv.next())
      scaled +=
          fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", row->text(0), row->text(1),
                      factor * row->number(2), row->text(3), factor * row->number(4), row->text(5),
                      row->text(6), row->text(7), row->text(8), row->text(9), row->text(10));
  }
  work::CodeMap& map = found->second = platform::code_map_from("scaled", scaled);
  // What is executed stays as it is, on all instruction sets.
  for (std::size_t i = 0; i < map.pieces().size(); ++i)
    for (std::size_t set = 0; set < work::kCompiledFor.size(); ++set) {
      const auto executed_on = static_cast<work::CompiledFor>(set);
      map.set_compiled(
          static_cast<int>(i), executed_on,
          work::compiled_of(platform::compiled_code().pieces()[i].compiled, executed_on));
    }
  return map;
}

template <class Body>
Recording recorded(int cores, const work::CodeMap& code, const Body& body) {
  Recording recording;
  recording.cores = cores;
  recording.events.resize(static_cast<std::size_t>(cores) + 1);
  work::Machine machine(
      {.cores = cores, .memory = "L1", .capacity = Bytes(1 << 20), .record = true, .code = &code});
  {
    const auto stage = machine.stage("RANSAC");
    work::current_code->keep_events(&recording.events);
    body(machine);
  }
  recording.job = machine.take_job();
  return recording;
}

/// The points of the first view as landmarks, the second view as the camera that is looked for.
struct LandmarkScene {
  const TwoViewScene scene =
      make_two_view_scene(3, {.matches = 54, .outliers = 0.3, .rounded = true});
  std::vector<Counted::F32> points, pixels;

  LandmarkScene() {
    for (std::size_t i = 0; i < scene.points_a.size(); ++i) {
      for (int c = 0; c < 3; ++c) points.emplace_back(static_cast<float>(scene.points_a[i](c)));
      pixels.emplace_back(static_cast<float>(scene.seen_b[i].x()) * kCamera.fx + kCamera.cx);
      pixels.emplace_back(static_cast<float>(scene.seen_b[i].y()) * kCamera.fy + kCamera.cy);
    }
  }
  Counted::Span<const Counted::F32> all_points() const { return {points.data(), 3 * scene.n}; }
  Counted::Span<const Counted::F32> all_pixels() const { return {pixels.data(), 2 * scene.n}; }
};

Recording epnp(int cores, const work::CodeMap& code) {
  const LandmarkScene landmarks;
  levio::EpnpRansacOptions options;
  options.iterations = 16;
  return recorded(cores, code, [&](work::Machine& machine) {
    levio::ShiftRegister<Counted> random(0x2545f491u);
    levio::estimate_pose_epnp<Counted>(
        machine, {landmarks.all_points(), landmarks.all_pixels(), landmarks.scene.n},
        levio::CameraConstants<Counted>(kCamera), random, options);
  });
}

TwoViewScene scene_of_two_views() {
  return make_two_view_scene(3, {.matches = 60, .outliers = 0.2, .rounded = true});
}

Recording eight_point(int cores, const work::CodeMap& code) {
  const TwoViewScene scene = scene_of_two_views();
  const MatchStorage<Counted> matches(scene);
  constexpr float kThreshold = (0.7f / 114.66f) * (0.7f / 114.66f);
  levio::EssentialRansacOptions options;
  options.iterations = 80;
  return recorded(cores, code, [&](work::Machine& machine) {
    work::Arena& local = machine.local();
    const MatrixView<Counted> E = alloc_matrix<Counted>(local, "E", 3, 3);
    const auto mask = local.alloc<Counted::Span<Counted::Byte>>("mask", scene.n);
    levio::ShiftRegister<Counted> random(7);
    levio::estimate_essential<Counted>(machine, matches.view(), kThreshold, random, options, E,
                                       mask);
  });
}

struct Program {
  const char* name;
  Recording (*record)(int cores, const work::CodeMap& code);

  Recording on(int cores) const { return record(cores, platform::compiled_code()); }
};
constexpr Program kPrograms[] = {{"EPnP", epnp}, {"8-point", eight_point}};

const sim::ChipConfig& gap9() {
  static const sim::ChipConfig chip = platform::load_platform("gap9");
  return chip;
}

/// Cycles that each worker works and waits for code in the forks, by the model.
struct Modelled {
  double work = 0;
  double stall = 0;
};
Modelled modelled(const Recording& recording, int workers) {
  sim::Chip chip(gap9(), workers);
  sim::JobTiming timing;
  const auto body = [&]() -> sim::Process { timing = co_await chip.cluster().run(recording.job); };
  chip.kernel().spawn("test", body());
  chip.kernel().run();
  const sim::MechanismCycles& b = timing.stages.at(0).account.team;
  const double waiting = b[sim::Mechanism::Fetch] + b[sim::Mechanism::FetchContention];
  return {(b.alone() - b[sim::Mechanism::Fetch]) / recording.cores, waiting / recording.cores};
}

/// Lines of every core, fork by fork.
std::vector<std::vector<LineList>> lines_of(const Recording& recording, const CodeLayout& layout) {
  std::vector<std::vector<LineList>> lists;
  for (int core = 0; core < recording.cores; ++core) {
    CodeWalk walk(layout);
    std::vector<LineList>& forks = lists.emplace_back();
    for (const auto& events : recording.events[static_cast<std::size_t>(core)]) {
      walk.follow(events);
      if (LineList lines = walk.take(); !lines.empty()) forks.push_back(std::move(lines));
    }
  }
  return lists;
}

/// Where the linker puts functions moves what a core waits by tens of per cent. So many know the
/// mean within 3 %.
constexpr std::uint64_t kLayouts = 48;

/// @param apart  the cores begin each fork at places of its code by chance, as far apart as this
///               share of it
struct Case {
  const char* name;
  double apart;
  int workers = 0;  ///< kMasterAlone: the master; else those of the recording
};

/// Mean over layouts and cores of what stepped cores wait.
/// @param own  the size of their private caches
double stepped(const Recording& recording, double work, const Case& c, Bytes own) {
  double sum = 0;
  for (std::uint64_t layout = 1; layout <= kLayouts; ++layout) {
    const auto lists = lines_of(recording, CodeLayout(platform::compiled_code(), layout));
    std::size_t lines = 0;
    for (const auto& forks : lists)
      for (const LineList& list : forks) lines += list.size();
    const double per_line = work * recording.cores / static_cast<double>(lines);
    tests::RandomNumbers random(layout);
    LineCaches caches(gap9().cluster.icache, own, layout);
    for (std::size_t fork = 0; fork < lists[0].size(); ++fork) {
      std::vector<Walker> walkers;
      for (const auto& forks : lists) {
        const auto apart =
            static_cast<std::uint32_t>(c.apart * static_cast<double>(forks[fork].size()));
        walkers.push_back({&forks[fork], per_line, apart > 0 ? random.below(apart) : 0});
      }
      sum += caches.run(walkers).mean_stall();
    }
  }
  return sum / kLayouts;
}

/// The same with the work of the first core on all.
Recording in_step(Recording recording) {
  for (int core = 1; core < recording.cores; ++core)
    recording.events[static_cast<std::size_t>(core)] = recording.events[0];
  for (work::Step& step : recording.job.stages[0].steps)
    if (auto* fork = std::get_if<work::Fork>(&step))
      std::fill(fork->shares.begin() + 1, fork->shares.end(), fork->shares[0]);
  return recording;
}

void compare(const char* name, const Recording& recording, const Case& c) {
  const bool is_master = c.workers == sim::Cluster::kMasterAlone;
  const double kTolerance = is_master ? 0.2 : 0.11;
  const sim::InstructionCacheConfig& icache = gap9().cluster.icache;
  const Modelled model = modelled(recording, is_master ? c.workers : recording.cores);
  const double expected =
      stepped(recording, model.work, c, is_master ? icache.master : icache.worker);
  EXPECT_NEAR(model.stall, expected, kTolerance * expected)
      << name << ", " << c.name << ": " << 100 * (model.stall / expected - 1) << " %";
}

TEST(RansacCode, CoresWaitAsSteppedCachesSay) {
  for (const Program& program : kPrograms) {
    const Recording lone = program.on(1);
    compare(program.name, lone, {"a worker alone", 0});
    compare(program.name, lone, {"the master alone", 0, sim::Cluster::kMasterAlone});
    const Recording own = program.on(8);
    const Recording same = in_step(own);
    compare(program.name, own, {"each its own hypotheses", 0});
    compare(program.name, same, {"in step", 0});
    // Some hundreds of lines apart. (Where cores are in different parts of the program, each with a
    // working set of its own, they wait up to a fifth more.)
    compare(program.name, same, {"out of step", 0.02});
  }
}

/// Mean number of adjacent lines among the distinct ones of some ten thousand fetches.
double mean_stretch(const LineList& lines) {
  constexpr std::size_t kWindow = 80'000;  // about a hypothesis of EPnP
  double runs = 0, distinct = 0;
  for (std::size_t at = 0; at + kWindow < lines.size(); at += kWindow) {
    const auto begin = lines.begin() + static_cast<std::ptrdiff_t>(at);
    const std::set<std::uint32_t> window(begin, begin + kWindow);
    distinct += static_cast<double>(window.size());
    for (const std::uint32_t line : window) runs += window.contains(line - 1) ? 0 : 1;
  }
  return distinct / runs;
}

/// The constant of sim/chip/instruction_cache.cpp.
TEST(RansacCode, LinesLieTogetherAsTheCachesTake) {
  double sum = 0;
  for (const Program& program : kPrograms) {
    const Recording recording = program.on(1);
    for (std::uint64_t layout = 1; layout <= kLayouts; ++layout) {
      LineList all;
      const auto lists = lines_of(recording, CodeLayout(platform::compiled_code(), layout));
      for (const LineList& fork : lists[0]) all.insert(all.end(), fork.begin(), fork.end());
      sum += mean_stretch(all);
    }
  }
  EXPECT_NEAR(sum / (std::size(kPrograms) * kLayouts), 33, 1);  // 32.6
}

/// Cycles of the workers by the model.
double cycles(const Recording& recording) {
  const Modelled model = modelled(recording, recording.cores);
  return model.work + model.stall;
}

/// Of a hypothesis alone, without what the master does between the forks. Stepped caches say -5.0
/// and +6.5 % for EPnP on one worker, whose loop is a fifth larger than the common cache.
TEST(RansacCode, AFewPerCentOfCodeChangeAFewPerCentOfCycles) {
  for (const Program& program : kPrograms)
    for (const int cores : {1, 8})
      for (const double factor : {0.95, 1.05})
        EXPECT_NEAR(cycles(program.record(cores, scaled_code(factor))) / cycles(program.on(cores)),
                    1, 0.065)
            << program.name << ", " << cores << " cores, code x " << factor;
}

}  // namespace
}  // namespace leviosim::vio::test
