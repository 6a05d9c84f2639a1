// Kernels that nobody thought of when the model was made, against their compiled code as traced:
// with what leviosim-measure knows of them, and blind, as a user's kernel is before that. On plain
// RV32IMFC, where what GCC compiles is what the core executes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

#include "platform_models/loader/compiled_code.h"
#include "platform_models/loader/loader.h"
#include "sim/chip/timing.h"
#include "sim/work/machine.h"
#include "tests/validation/unseen_kernels_code.h"
#include "tests/validation/unseen_scenes.h"
#include "tools/app/validation/microbench/bench.h"

namespace leviosim::tools {
namespace {

/// What a scene executes (GCC 12.2 -O3, tools/rv32's trace).
struct Traced {
  std::string_view scene;
  double instructions;
  double taken;                       ///< branches
  double jumps;                       ///< with calls and returns
  double at_once;                     ///< loads whose value the next instruction needs
  double divisions, float_divisions;  ///< with roots
  double library_stalls;              ///< of memset

  /// By the core's manual: a taken branch flushes two instructions, a jump one; a division as by a
  /// divisor of 16 bits; the FPU's divider 14 cycles.
  double cycles() const {
    return instructions + 2 * taken + jumps + at_once + 18 * divisions + 13 * float_divisions +
           library_stalls;
  }
};
constexpr std::array kTraced = {
    Traced{"scene: biquads 1024", 77836, 4095, 0, 0, 0, 0, 0},
    Traced{"scene: biquads 256", 19469, 1023, 0, 0, 0, 0, 0},
    Traced{"scene: cholesky 200", 75823, 4999, 800, 0, 0, 3600, 0},
    Traced{"scene: cholesky 50", 19075, 1249, 200, 0, 0, 900, 0},
    Traced{"scene: components 40x30", 22258, 3730, 427, 2885, 0, 0, 44},
    Traced{"scene: components 80x60", 89014, 15021, 1737, 11762, 0, 0, 84},
    Traced{"scene: crc32 1024", 10249, 1024, 0, 1025, 0, 0, 0},
    Traced{"scene: crc32 4096", 40969, 4096, 0, 4097, 0, 0, 0},
    Traced{"scene: dense 128x64", 74908, 8254, 0, 0, 0, 0, 0},
    Traced{"scene: dense 64x32", 19035, 2079, 0, 0, 0, 0, 0},
    Traced{"scene: fft 1024", 158673, 7682, 512, 0, 0, 0, 0},
    Traced{"scene: fft 256", 33423, 1659, 256, 0, 0, 0, 0},
    Traced{"scene: histogram 1024", 10270, 1278, 1, 1024, 0, 0, 516},
    Traced{"scene: histogram 4096", 34841, 4350, 1, 4096, 0, 0, 516},
    Traced{"scene: median 24", 126605, 7207, 4690, 93, 0, 0, 0},
    Traced{"scene: median 48", 555739, 31502, 20361, 460, 0, 0, 0},
    Traced{"scene: product 256", 150279, 13823, 3840, 256, 0, 0, 0},
    Traced{"scene: product 64", 37575, 3455, 960, 64, 0, 0, 0},
    Traced{"scene: range decoder 1600", 94668, 14666, 0, 1600, 3200, 0, 0},
    Traced{"scene: range decoder 400", 25022, 3924, 0, 400, 800, 0, 0},
};

/// One stage a scene, by its name.
work::Machine* machine_of_scenes = nullptr;
struct StageOfScene {
  explicit StageOfScene(work::CodeName name) : stage(machine_of_scenes->stage(name.text)) {}
  work::Machine::Stage stage;
};

/// Cycles of each scene on one core.
std::map<std::string, double> simulated(const work::CodeMap& code) {
  const sim::ChipConfig chip =
      platform::load_platform("gap9", {"isa.base=rv32imfc", "isa.code=rv32imfc"});
  work::Machine machine({.cores = 1, .record = true, .code = &code});
  machine_of_scenes = &machine;
  unseen::all_scenes<work::Counting, StageOfScene>();
  const Bench bench(chip, 1);
  std::map<std::string, double> cycles;
  for (const work::StageRun& run : machine.take_job().stages) {
    work::Job job;
    job.stages.push_back(run);
    cycles[std::string(run.stage)] = static_cast<double>(bench.time(job).cycles.count());
  }
  return cycles;
}

/// Relative errors by scene, which it prints.
std::map<std::string_view, double> errors(const char* title, const work::CodeMap& code) {
  const std::map<std::string, double> cycles = simulated(code);
  std::map<std::string_view, double> all;
  for (const Traced& traced : kTraced) {
    const double error = cycles.at(std::string(traced.scene)) / traced.cycles() - 1;
    fmt::print("  {}: {} {:+.1f} %\n", title, traced.scene, 100 * error);
    all[traced.scene] = error;
  }
  return all;
}

double mean_of(const std::map<std::string_view, double>& errors) {
  double sum = 0;
  for (const auto& [scene, error] : errors) sum += std::abs(error);
  return sum / static_cast<double>(errors.size());
}

double worst_of(const std::map<std::string_view, double>& errors) {
  double worst = 0;
  for (const auto& [scene, error] : errors) worst = std::max(worst, std::abs(error));
  return worst;
}

/// Code of some elements, called again and again.
bool is_small(std::string_view scene) {
  return scene.find("product") != scene.npos || scene.find("cholesky") != scene.npos;
}

TEST(ValidationUnseenKernels, MeasuredOnesAreWithinEightPerCent) {
  const platform::CodeTable table = unseen_kernels_code().front();
  const auto found =
      errors("measured", platform::code_map_from("unseen_kernels_code.h", table.text));
  EXPECT_LE(mean_of(found), 0.08);
  EXPECT_LE(worst_of(found), 0.15);
}

/// The cascade of biquads is the worst: five coefficients and two states share pointers, which the
/// price of a load cannot know.
TEST(ValidationUnseenKernels, BlindOnesAreWithinTwentyPerCent) {
  const auto found = errors("blind", platform::compiled_code());
  EXPECT_LE(mean_of(found), 0.20);
  for (const auto& [scene, error] : found)
    EXPECT_LE(std::abs(error), is_small(scene) ? 0.15 : 0.30) << scene;
}

}  // namespace
}  // namespace leviosim::tools
