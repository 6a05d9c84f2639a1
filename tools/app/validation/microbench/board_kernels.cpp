#include "tools/app/validation/microbench/board_kernels.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "sim/base/error.h"
#include "tools/app/validation/microbench/bench.h"
#include "tools/app/validation/microbench/board_programs.h"
#include "tools/app/validation/microbench/kernel_job.h"
#include "tools/app/validation/microbench/microbench_row.h"
#include "tools/app/validation/microbench/reference_rows.h"
#include "tools/app/validation/published_files.h"

namespace leviosim::tools {
namespace {

using P = work::Counting;

using Samples = P::Span<Sample>;

using Words = P::Span<work::I8x4<P>>;

using Pairs = P::Span<work::I16x2<P>>;

using work::Core;

using work::Machine;

constexpr std::string_view kBoardReferences = "gap8_board";

constexpr std::string_view kBoardGuards = "gap8_board_guards";

constexpr double kCalls = 100;

constexpr double kSpeedUpTolerance = 0.5;  // of a factor

constexpr int kImage = kPoolSize * kPoolSize;

void run_max_pool(Machine& m) {
  const auto in = block<Samples>(m, "image", kImage);
  const auto out = block<Samples>(m, "pooled", kPooled * kPooled);
  m.fork("max pool", [&](Core& core) { max_pool<P>(in, out, core.share(kPooled)); });
}

void run_average_pool(Machine& m) {
  const auto in = block<Samples>(m, "image", kImage);
  const auto out = block<Samples>(m, "pooled", kPooled * kPooled);
  m.fork("average pool", [&](Core& core) { average_pool<P>(in, out, core.share(kPooled)); });
}

void run_max_pool_simd(Machine& m) {
  const auto in = block<Pairs>(m, "image", kImage / 2);
  const auto out = block<Samples>(m, "pooled", kPooled * kPooled);
  m.fork("max pool", [&](Core& core) { max_pool_simd<P>(in, out, core.share(kPooled)); });
}

void run_average_pool_simd(Machine& m) {
  const auto in = block<Pairs>(m, "image", kImage / 2);
  const auto out = block<Samples>(m, "pooled", kPooled * kPooled);
  m.fork("average pool", [&](Core& core) { average_pool_simd<P>(in, out, core.share(kPooled)); });
}

void run_convolve(Machine& m) {
  const auto in = block<Samples>(m, "image", kImage);
  const auto kernel = block<Samples>(m, "kernel", kWindow * kWindow);
  const auto out = block<Samples>(m, "convolved", kConvolved * kConvolved);
  m.fork("convolve", [&](Core& core) { convolve<P>(in, kernel, out, core.share(kConvolved)); });
}

void run_convolve_simd(Machine& m) {
  const auto in = block<Words>(m, "image", kImage / 4);
  const auto kernel = block<Words>(m, "kernel", kWindow + 2);
  const auto out = block<Samples>(m, "convolved", kConvolved * kConvolved);
  m.fork("convolve",
         [&](Core& core) { convolve_simd<P>(in, kernel, out, core.share(kConvolved)); });
}

void run_linear(Machine& m) {
  const auto in = block<Samples>(m, "input", kInputs);
  const auto weights = block<Samples>(m, "weights", kInputs * kOutputs);
  const auto out = block<Samples>(m, "output", kOutputs);
  m.fork("linear", [&](Core& core) { linear<P>(in, weights, out, core.share(kOutputs)); });
}

void run_linear_simd(Machine& m) {
  const auto in = block<Words>(m, "input", kInputs / 4);
  const auto weights = block<Words>(m, "weights", kInputs * kOutputs / 4);
  const auto out = block<Samples>(m, "output", kOutputs);
  m.fork("linear", [&](Core& core) { linear_simd<P>(in, weights, out, core.share(kOutputs)); });
}

void run_xnor_convolve(Machine& m) {
  const auto in = block<P::Span<P::U32>>(m, "image", kBinarySize * kBinaryWords);
  const auto out = block<Samples>(m, "convolved", kBinaryOut * kBinaryOut);
  m.fork("XNOR", [&](Core& core) { xnor_convolve<P>(in, P::U32(0), out, core.share(kBinaryOut)); });
}

struct Kernel {
  std::string_view group;
  std::string_view name;
  void (*run)(Machine&);
};

constexpr Kernel kKernels[] = {
    {"2x2 max pool 112x112", "scalar", run_max_pool},
    {"2x2 max pool 112x112", "SIMD", run_max_pool_simd},
    {"2x2 average pool 112x112", "scalar", run_average_pool},
    {"2x2 average pool 112x112", "SIMD", run_average_pool_simd},
    {"5x5 convolution 112x112", "scalar", run_convolve},
    {"5x5 convolution 112x112", "SIMD", run_convolve_simd},
    {"linear 1024 to 16", "scalar", run_linear},
    {"linear 1024 to 16", "SIMD", run_linear_simd},
    {"XNOR convolution 5x5 100x100", "scalar", run_xnor_convolve},
};

const Kernel& kernel_of(const MicrobenchRow& row) {
  for (const Kernel& kernel : kKernels)
    if (kernel.group == row.group && kernel.name == row.name) return kernel;
  throw InputError(
      fmt::format("{}.csv: there is no kernel \"{}, {}\"", kBoardReferences, row.group, row.name));
}

/// What eight cores gain over one. Where the board gains more than there are cores, because the two
/// programs were compiled differently, the number of cores is as good.
MicrobenchRow speed_up(const MicrobenchRow& one, const MicrobenchRow& many) {
  MicrobenchRow row = many;
  row.name += ", speed-up";
  row.unit = std::string("x");
  row.band.reset();
  const double measured = one.reference / many.reference;
  row.reference = std::min(measured, static_cast<double>(many.cores));
  row.reference_high = measured;
  row.simulated = one.simulated / many.simulated;
  row.tolerance = kSpeedUpTolerance / row.reference;
  return row;
}

}  // namespace

std::vector<KernelJob> board_kernels(const sim::ChipConfig& chip,
                                     std::vector<MicrobenchRow> references) {
  std::vector<KernelJob> kernels;
  for (MicrobenchRow& row : references) {
    const work::Job job = Bench(chip, row.cores).record(kernel_of(row).run);
    kernels.push_back({.row = std::move(row), .job = job, .calls = kCalls});
  }
  return kernels;
}

std::vector<KernelJob> board_kernels(const sim::ChipConfig& chip) {
  return board_kernels(chip, reference_rows(fmt::format("{}.csv", kBoardReferences),
                                            reference_text(kBoardReferences), 2));
}

std::vector<MicrobenchRow> board_rows(const std::vector<KernelJob>& kernels,
                                      const platform::Variants& platform) {
  std::vector<MicrobenchRow> rows = banded_rows(kernels, platform);
  const std::size_t timed = rows.size();
  for (std::size_t i = 0; i < timed; ++i)
    for (std::size_t j = 0; j < timed; ++j)
      if (rows[i].cores == 1 && rows[j].cores > 1 && rows[i].group == rows[j].group &&
          rows[i].name == rows[j].name)
        rows.push_back(speed_up(rows[i], rows[j]));
  take_guards(fmt::format("{}.csv", kBoardGuards), reference_text(kBoardGuards), rows);
  return rows;
}

}  // namespace leviosim::tools
