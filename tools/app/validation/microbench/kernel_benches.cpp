#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "sim/base/error.h"
#include "tools/app/validation/microbench/bench.h"
#include "tools/app/validation/microbench/board_programs.h"
#include "tools/app/validation/microbench/library_programs.h"
#include "tools/app/validation/references.h"

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

using I32 = P::I32;
using Integers = P::Span<I32>;

constexpr std::string_view kLibraryReferences = "pulp_dsp";
constexpr std::string_view kLibraryGuards = "pulp_dsp_guards";

void run_int32_product(Machine& m, int n) {
  const auto a = block<Integers>(m, "a", n * n), b = block<Integers>(m, "b", n * n);
  const auto c = block<Integers>(m, "c", n * n);
  m.fork("product", [&](Core& core) { multiply_int32<P>(a, b, c, n, core); });
}

void run_int16_product(Machine& m, int n) {
  const auto a = block<Pairs>(m, "a", n * n / 2), b = block<Pairs>(m, "b", n * n / 2);
  const auto c = block<Integers>(m, "c", n * n);
  m.fork("product", [&](Core& core) { multiply_int16<P>(a, b, c, n, core); });
}

/// Each core convolves its part of one operand; then each adds up its part of the results.
void run_convolution(Machine& m, int n) {
  const auto x = block<Integers>(m, "x", n), taps = block<Integers>(m, "taps", n);
  const int part = n / m.cores();
  const int results = part + n - 1;
  const auto parts = block<Integers>(m, "parts", m.cores() * results);
  const auto out = block<Integers>(m, "out", 2 * n - 1);
  m.fork("convolve", [&](Core& core) {
    convolve_int32<P>(taps, x.subspan(core.id * part, part),
                      parts.subspan(core.id * results, results));
  });
  if (m.cores() == 1) return;
  m.fork("add", [&](Core& core) {
    const work::Share share = core.share(2 * n - 1);
    for (const int t : P::range(share.begin, share.end)) {
      I32 sum = 0;
      for (int k = 0; k < m.cores(); ++k)
        if (const int at = t - k * part; at >= 0 && at < results) sum += parts[k * results + at];
      out[t] = sum;
    }
  });
}

/// The sum of the cores' sums is the master's.
void run_dot(Machine& m, int n) {
  const auto a = block<Integers>(m, "a", n), b = block<Integers>(m, "b", n);
  const auto sums = block<Integers>(m, "sums", m.cores());
  m.fork("dot", [&](Core& core) {
    const work::Share share = core.share(n);
    sums[core.id] = dot_int32<P, P::Span<const I32>>(a, b, share.begin, share.end);
  });
  I32 sum = 0;
  for (int core = 0; core < m.cores() && m.cores() > 1; ++core) sum += sums[core];
}

void run_dot_in_l2(Machine& m, int n) {
  static std::vector<I32> values(2 * 80);
  using Far = P::L2Span<const I32>;
  m.fork("dot",
         [&](Core&) { dot_int32<P, Far>(Far(values.data(), n), Far(values.data() + n, n), 0, n); });
}

/// What one pass through all of a kernel's code is: the smallest problem, and how many passes that
/// is.
struct OnePass {
  std::string_view function;
  void (*run)(Machine&, int);
  int size;
  int passes;
};
constexpr OnePass kInt32Product{"multiply_int32", run_int32_product, 2, 1};
constexpr OnePass kInt16Product{"multiply_int16", run_int16_product, 4, 2};
/// Four blocks: two of the rising edge, two of the falling one, which have loops of their own.
constexpr OnePass kConvolution{"convolve_int32", run_convolution, 8, 2};
constexpr OnePass kDot{"dot_int32", run_dot, 2, 1};

struct LibraryKernel {
  std::string_view group;
  std::string_view name;
  void (*run)(Machine&, int);
  int size;
  const OnePass& code;
};
constexpr LibraryKernel kLibraryKernels[] = {
    {"int32 matrix product", "n = 16", run_int32_product, 16, kInt32Product},
    {"int32 matrix product", "n = 32", run_int32_product, 32, kInt32Product},
    {"int32 matrix product", "n = 48", run_int32_product, 48, kInt32Product},
    {"int16 matrix product", "n = 16", run_int16_product, 16, kInt16Product},
    {"int16 matrix product", "n = 32", run_int16_product, 32, kInt16Product},
    {"int32 convolution", "512 with 512", run_convolution, 512, kConvolution},
    {"int32 dot product", "6960", run_dot, 6960, kDot},
    {"int32 dot product", "80", run_dot, 80, kDot},
    {"int32 dot product", "80 in L2", run_dot_in_l2, 80, kDot},
};

const LibraryKernel& library_kernel_of(const MicrobenchRow& row) {
  for (const LibraryKernel& kernel : kLibraryKernels)
    if (kernel.group == row.group && kernel.name == row.name) return kernel;
  throw InputError(fmt::format("{}.csv: there is no kernel \"{}, {}\"", kLibraryReferences,
                               row.group, row.name));
}

/// Bytes of code of a kernel, whose compiled form is not known: four for each instruction that it
/// executes in one pass.
std::uint32_t bytes_of(const sim::ChipConfig& chip, const OnePass& code) {
  constexpr double kInstruction = 4;
  const sim::StageTiming pass = Bench(chip, 1).run([&](Machine& m) { code.run(m, code.size); });
  return static_cast<std::uint32_t>(kInstruction * pass.account.team[sim::Mechanism::Issue] /
                                    code.passes);
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

std::vector<KernelJob> library_kernels(const sim::ChipConfig& chip) {
  std::vector<KernelJob> kernels;
  std::vector<MicrobenchRow> rows = reference_rows(fmt::format("{}.csv", kLibraryReferences),
                                                   reference_text(kLibraryReferences), 2);
  take_guards(fmt::format("{}.csv", kLibraryGuards), reference_text(kLibraryGuards), rows);
  for (const MicrobenchRow& row : rows) {
    const LibraryKernel& kernel = library_kernel_of(row);
    work::CodeMap code;
    code.add(kernel.code.function, "", bytes_of(chip, kernel.code));
    Bench bench(chip, row.cores, &code);
    KernelJob& job = kernels.emplace_back(KernelJob{.row = row});
    job.job = bench.record([&](Machine& m) { kernel.run(m, kernel.size); });
    // One core is not forked.
    if (row.cores == 1)
      job.left_out = Bench(chip, 1).record([](Machine& m) { m.fork("nothing", [](Core&) {}); });
  }
  return kernels;
}

}  // namespace leviosim::tools
