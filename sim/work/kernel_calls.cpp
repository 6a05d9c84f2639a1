#include "sim/work/kernel_calls.h"

#include <algorithm>
#include <utility>

#include "sim/base/check.h"

namespace leviosim::work {
namespace {

/// Of one host thread, as the tally is.
struct KernelTally {
  struct Sum {
    std::uint64_t calls = 0;
    std::uint64_t items = 0;
    RawCounts counts{};
  };
  std::array<Sum, kKernelCount> sums{};
  RawCounts at_begin{};  ///< the tally when the present call began
  KernelKind present{};
  int depth = 0;  ///< of marks within marks
  bool any = false;
};
constinit thread_local KernelTally kernel_tally{};

}  // namespace

void begin_kernel(KernelKind kind, std::uint64_t items) {
  KernelTally& t = kernel_tally;
  if (t.depth++ > 0) return;
  t.present = kind;
  t.any = true;
  KernelTally::Sum& sum = t.sums[index(kind)];
  ++sum.calls;
  sum.items += items;
  t.at_begin = {tally.n, branches_not_taken_after_all};
}

void end_kernel() {
  KernelTally& t = kernel_tally;
  if (--t.depth > 0) return;
  RawCounts& sum = t.sums[index(t.present)].counts;
  for (std::size_t i = 0; i < kOpCount; ++i) sum.n[i] += tally.n[i] - t.at_begin.n[i];
  sum.not_taken_after_all += branches_not_taken_after_all - t.at_begin.not_taken_after_all;
}

std::vector<KernelWork> take_kernels() {
  KernelTally& t = kernel_tally;
  if (!t.any) return {};
  check_equal(t.depth, 0, "calls of kernels that go on at the end of a piece of work");
  std::vector<KernelWork> taken;
  for (const KernelInfo& info : kKernels) {
    KernelTally::Sum& sum = t.sums[index(info.kernel)];
    if (sum.calls == 0) continue;
    taken.push_back({info.kernel, sum.calls, sum.items, settled(sum.counts)});
    sum = {};
  }
  t.any = false;
  return taken;
}

Piece& Piece::operator+=(const Piece& other) {
  Counts::operator+=(other);
  for (const KernelWork& more : other.kernels) {
    const auto at = std::find_if(kernels.begin(), kernels.end(), [&](const KernelWork& k) {
      return index(k.kernel) >= index(more.kernel);
    });
    if (at == kernels.end() || at->kernel != more.kernel) {
      kernels.insert(at, more);
      continue;
    }
    at->calls += more.calls;
    at->items += more.items;
    at->counts += more.counts;
  }
  return *this;
}

}  // namespace leviosim::work
