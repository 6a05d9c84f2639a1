#include "tools/app/validation/microbench/library_kernels.h"

#include <fmt/format.h>

#include <string_view>

#include "sim/base/error.h"
#include "sim/chip/account.h"
#include "sim/chip/timing.h"
#include "tools/app/validation/microbench/bench.h"
#include "tools/app/validation/microbench/kernel_job.h"
#include "tools/app/validation/microbench/library_programs.h"
#include "tools/app/validation/microbench/microbench_row.h"
#include "tools/app/validation/microbench/reference_rows.h"
#include "tools/app/validation/published_files.h"

namespace leviosim::tools {
namespace {

using P = work::Counting;

using Pairs = P::Span<work::I16x2<P>>;

using work::Core;

using work::Machine;

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
