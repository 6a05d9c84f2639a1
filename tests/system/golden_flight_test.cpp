// What the whole odometry computes on short flights that are drawn in memory, pinned to the last
// digit: poses and where they come from, keyframes, matches, inliers, landmarks, error, and cycles
// per stage on GAP9. Determinism makes exact values possible, and no data is needed. Whoever means
// to change what is computed makes golden_flight.csv anew, and looks at what has changed:
//   LEVIOSIM_RENEW_GOLDEN=1 build/release/tests/leviosim_system_tests
//   --gtest_filter='*GoldenFlight*'
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>

#include "platform_models/loader/compiled_code.h"
#include "platform_models/loader/loader.h"
#include "sim/soc/job_timer.h"
#include "sim/work/machine.h"
#include "tests/support/paths.h"
#include "tests/workload/short_flight.h"
#include "tools/app/result/summary.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using vio::test::ShortFlight;

/// Figures by name, as text.
using Figures = std::map<std::string, std::string>;

constexpr int kSeconds = 5;

/// At rest for a second, then faster and faster.
const ShortFlight& from_rest() {
  static const ShortFlight flight =
      vio::test::draw_flight(vio::test::PacedFlight(3, vio::test::at_pace(1.2)), kSeconds);
  return flight;
}

/// In motion from the first frame on, with most of what can go wrong on the way.
const ShortFlight& troubled() {
  static const ShortFlight flight = [] {
    ShortFlight f =
        vio::test::draw_flight(vio::test::PacedFlight(5, vio::test::at_pace(1.5, 4)), kSeconds);
    vio::test::blur(f, 30, 36);
    vio::test::darken(f, 50, 58);
    vio::test::cut_imu(f, 66, 69);
    vio::test::saturate(f, 0.9f, 11.0f);
    vio::test::drop_frames(f, [](int i) { return i >= 75 && i < 80; });
    return f;
  }();
  return flight;
}

/// Glides, which the IMU takes for rest, then sees nothing for so long that it recognises too
/// little to tell its pose, and is shown torn images at last.
const ShortFlight& gliding() {
  static const ShortFlight flight = [] {
    ShortFlight f =
        vio::test::draw_flight(vio::test::GlidingFlight(3, vio::test::at_pace(1.2), 3.5, 5), 7);
    vio::test::tear(f, 134, 137);
    vio::test::drop_frames(f, [](int i) { return i >= 98 && i < 124; });
    return f;
  }();
  return flight;
}

/// Adds up what happens on the way.
class CycleBreakdown {
 public:
  CycleBreakdown() : chip_(platform::load_platform("gap9")), timer_(chip_, 8) {}

  void add(const vio::FrameReport& report) {
    count("source " + std::string(name_of(report.source)), 1);
    count("keyframes", report.keyframe ? 1 : 0);
    count("features", report.features);
    count("world matches", report.world_matches);
    count("frame matches", report.frame_matches);
    count("inliers", report.inliers);
    count("landmarks, summed over the frames", report.landmarks);
  }
  void front_end(const work::Job& job) { add(timer_.front_end(job)); }
  void optimiser(const work::Job& job) { add(timer_.optimiser(job)); }

  Figures figures() const {
    Figures texts;
    for (const auto& [name, number] : numbers_) texts[name] = fmt::format("{}", number);
    return texts;
  }

 private:
  void count(const std::string& name, std::int64_t number) { numbers_[name] += number; }
  void add(const sim::JobTiming& timing) {
    for (const sim::StageTiming& stage : timing.stages) {
      count(fmt::format("calls of {}", stage.stage), 1);
      count(fmt::format("cycles of {}", stage.stage), stage.cycles.count());
    }
  }

  sim::ChipConfig chip_;
  soc::JobTimer timer_;
  std::map<std::string, std::int64_t> numbers_;
};

/// The pose of the body that a report has of the camera.
Eigen::Isometry3d body_pose(const vio::FrameReport& report, const ShortFlight& flight) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c)
      T.linear()(r, c) =
          static_cast<double>(report.R_world_camera[static_cast<std::size_t>(3 * r + c)]);
    T.translation()[r] = static_cast<double>(report.p_world_camera[static_cast<std::size_t>(r)]);
  }
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return T * flight.T_body_camera.inverse();
}

/// Flies on counted scalars, as a run on the chip does.
Figures figures_of(const ShortFlight& flight, const vio::Profile& profile) {
  const work::CodeMap& code = platform::compiled_code();
  work::Machine cluster({8, "L1", Bytes(1 << 24), profile.l1_alignment, true, false, &code});
  work::Machine controller({1, "L2", Bytes(1 << 24), 4, true, false, &code});
  const auto odometry = vio::make_odometry(true, profile, flight.rig, cluster, controller);
  CycleBreakdown account;
  traces::Trajectory trajectory;
  std::int64_t before_ns = flight.frames.front().t_ns;
  for (const ShortFlight::Frame& frame : flight.frames) {
    const auto dt = static_cast<float>(static_cast<double>(frame.t_ns - before_ns) * 1e-9);
    before_ns = frame.t_ns;
    const bool optimises = odometry->begin_optimisation();
    const vio::FrameReport report = odometry->process_frame(
        {frame.pixels.data(), flight.rig.width, flight.rig.height, dt, frame.imu});
    account.add(report);
    account.front_end(cluster.take_job());
    for (int k = 0; optimises && k < profile.optimiser_iterations; ++k) {
      odometry->optimise();
      account.optimiser(controller.take_job());
    }
    if (optimises) odometry->publish();
    controller.take_job();
    trajectory.push_back({frame.t_ns, body_pose(report, flight)});
  }
  Figures figures = account.figures();
  // Without an IMU the released program checks no pose, and is lost after frames that show nothing.
  try {
    const traces::Evaluation ate = traces::evaluate(trajectory, flight.truth);
    figures["ATE mm"] = fmt::format("{:.4f}", ate.translation.rmse * 1e3);
    figures["rotation error deg"] = fmt::format("{:.5f}", ate.rotation_rmse_deg);
  } catch (const traces::NotComparable& why) {
    figures["ATE mm"] = why.what();
  }
  return figures;
}

std::filesystem::path golden_file() {
  return leviosim::tests::source_folder() / "tests" / "system" / "golden_flight.csv";
}

constexpr const char* kHeader = "flight,profile,value,figure";

/// All rows of the file: flight and profile, figure, value.
std::map<std::string, Figures> golden() {
  std::map<std::string, Figures> all;
  std::ifstream in(golden_file());
  for (std::string line; std::getline(in, line);) {
    if (line == kHeader) continue;
    const auto profile = line.find(','), value = line.find(',', profile + 1);
    const auto figure = line.find(',', value + 1);
    all[line.substr(0, value)][line.substr(figure + 1)] =
        line.substr(value + 1, figure - value - 1);
  }
  return all;
}

void renew(const std::string& key, const Figures& figures) {
  std::map<std::string, Figures> all = golden();
  all[key] = figures;
  std::string text = std::string(kHeader) + '\n';
  for (const auto& [flown, rows] : all)
    for (const auto& [figure, value] : rows)
      text += fmt::format("{},{},{}\n", flown, value, figure);
  std::ofstream(golden_file()) << text;
}

struct Case {
  const char* flight;
  const ShortFlight& (*draw)();
  const char* profile;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.flight << ", " << c.profile; }

class GoldenFlight : public ::testing::TestWithParam<Case> {};

TEST_P(GoldenFlight, ComputesWhatItDid) {
  vio::Profile profile = vio::profile_named(GetParam().profile, 1);
  profile.imu_uncertainty.gyro_range = 0.9f;
  profile.imu_uncertainty.accel_range = 11.0f;
  const Figures figures = figures_of(GetParam().draw(), profile);
  const std::string key = fmt::format("{},{}", GetParam().flight, GetParam().profile);
  if (std::getenv("LEVIOSIM_RENEW_GOLDEN") != nullptr) renew(key, figures);
  const Figures expected = golden()[key];
  EXPECT_GE(expected.size(), 25u);
  for (const auto& [figure, value] : figures) {
    const auto it = expected.find(figure);
    EXPECT_EQ(value, it == expected.end() ? "(none)" : it->second) << figure;
  }
  for (const auto& [figure, value] : expected)
    EXPECT_TRUE(figures.contains(figure)) << figure << " was " << value;
}

INSTANTIATE_TEST_SUITE_P(
    , GoldenFlight,
    ::testing::Values(Case{"from rest", from_rest, "levio"}, Case{"from rest", from_rest, "next"},
                      Case{"gliding", gliding, "next"}, Case{"troubled", troubled, "levio"},
                      Case{"troubled", troubled, "next"},
                      Case{"troubled", troubled, "levio-no-imu"},
                      Case{"troubled", troubled, "levio-no-imu-no-epnp"}),
    [](const auto& param) {
      std::string name = fmt::format("{}_{}", param.param.flight, param.param.profile);
      for (char& c : name)
        if (c == ' ' || c == '-') c = '_';
      return name;
    });

}  // namespace
}  // namespace leviosim::tools
