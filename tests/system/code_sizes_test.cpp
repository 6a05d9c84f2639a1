// What a run executes under a name has a size: a function that the sources name and the table of
// compiled code does not would fetch nothing, and so cost too little.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>

#include "platform_models/loader/compiled_code.h"
#include "sim/work/machine.h"
#include "tests/support/named_functions.h"
#include "tests/workload/short_flight.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

using Names = std::set<std::string>;

/// What was entered and is not in the map; library routines too.
Names entered_without_size(const std::set<std::uint64_t>& pieces) {
  std::map<std::uint32_t, std::string> name_of;
  for (const std::string& name : leviosim::tests::named_functions())
    name_of[work::CodeName(std::string_view(name)).key] = name;
  Names names;
  for (const std::uint64_t piece : pieces) {
    const auto function = static_cast<std::uint32_t>(piece >> 32);
    if (piece != work::CodeMap::piece_key(function, work::CodeMap::kEntry)) continue;
    const auto found = name_of.find(function);
    names.insert(found != name_of.end() ? found->second : fmt::format("code {:#x}", function));
  }
  return names;
}

/// At rest for a second, then faster and faster.
const vio::test::ShortFlight& flight() {
  static const vio::test::ShortFlight drawn =
      vio::test::draw_flight(vio::test::PacedFlight(3, vio::test::at_pace(1.2)), 4);
  return drawn;
}

/// Of both cores of a flight.
Names without_size(const char* profile_name, const work::CodeMap& code) {
  const vio::Profile profile = vio::profile_named(profile_name, 1);
  work::Machine cluster({8, "L1", Bytes(1 << 24), profile.l1_alignment, true, false, &code});
  work::Machine controller({1, "L2", Bytes(1 << 24), 4, true, false, &code});
  const auto odometry = vio::make_odometry(true, profile, flight().rig, cluster, controller);
  std::int64_t before_ns = flight().frames.front().t_ns;
  for (const vio::test::ShortFlight::Frame& frame : flight().frames) {
    const auto dt = static_cast<float>(static_cast<double>(frame.t_ns - before_ns) * 1e-9);
    before_ns = frame.t_ns;
    const bool optimises = odometry->begin_optimisation();
    odometry->process_frame(
        {frame.pixels.data(), flight().rig.width, flight().rig.height, dt, frame.imu});
    for (int k = 0; optimises && k < profile.optimiser_iterations; ++k) odometry->optimise();
    if (optimises) odometry->publish();
    cluster.take_job();
    controller.take_job();
  }
  Names names = entered_without_size(cluster.code_without_size());
  names.merge(entered_without_size(controller.code_without_size()));
  return names;
}

TEST(CodeSizes, AreKnownOfAllThatTheProfilesExecute) {
  EXPECT_EQ(without_size("levio", platform::compiled_code()), Names{});
  EXPECT_EQ(without_size("levio-no-imu", platform::compiled_code()), Names{});
  EXPECT_EQ(without_size("next", platform::compiled_code()), Names{});
}

TEST(CodeSizes, OfFunctionsThatTheTableLacksAreMissed) {
  work::CodeMap less;
  less.add("mat3_multiply", "", 16);
  const Names names = without_size("levio", less);
  EXPECT_TRUE(names.contains("levio_jacobi_eigen"));
  EXPECT_TRUE(names.contains("levio_optimise_once"));
  EXPECT_FALSE(names.contains("mat3_multiply"));
}

}  // namespace
}  // namespace leviosim::tools
