// Times small programs on a chip through the interface that workloads use: a Machine records what
// the program does, the chip times it.
//
// Such programs stand for instruction streams that somebody wrote in assembly, so the platform's
// constants of code generation do not apply: no instruction is added by a compiler, only loads that
// are said to be used at once wait, and cores that run the same stream find their turns at units
// and banks that they share.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "platform_models/loader/variants.h"
#include "sim/chip/chip.h"
#include "sim/chip/config.h"
#include "sim/work/machine.h"
#include "sim/work/program.h"
#include "tools/app/table/banded.h"
#include "tools/app/table/table_files.h"
#include "tools/app/validation/references.h"

namespace leviosim::tools {

// One line of a comparison with measured hardware: what was measured or derived elsewhere, and what
// the simulator says.

struct MicrobenchRow {
  std::string group;  ///< heading under which it is shown
  std::string name;
  int cores = 1;
  std::string unit;
  double reference = 0;       ///< or the low end of what the sources allow
  double reference_high = 0;  ///< the same as reference where they agree
  double simulated = 0;
  std::optional<Banded> band = std::nullopt;  ///< of what is simulated
  double tolerance = 0.05;                    ///< largest error that is accepted, relative
  /// Of a row that is known to miss it: the error that it may not exceed.
  std::optional<double> guard = std::nullopt;
  int tier = 1;  ///< 1: behaviour of a unit; 2: includes what a compiler does
  std::string source;

  /// Relative distance from the reference, or from the nearest end of its range; 0 inside.
  double error() const {
    const double nearest = std::clamp(simulated, reference, reference_high);
    return (simulated - nearest) / nearest;
  }
  /// Whether the reference lies in the band, or some of its range does.
  bool is_inside() const { return band && band->low <= reference_high && reference <= band->high; }
  bool met() const { return std::abs(error()) <= tolerance; }
  Verdict verdict() const { return judge(error(), tolerance, guard); }
};

// What the rows of a comparison refer to: tools/app/validation/published/*.csv, compiled into the
// program.

/// The rows of a reference file, with nothing simulated yet: columns group, name, cores, unit,
/// reference, reference_high (empty if the sources agree), tolerance (relative), source.
/// @throws InputError with file, line and column
std::vector<MicrobenchRow> reference_rows(const std::string& file, std::string_view text, int tier);

/// Sets the guards of rows that a file names: columns group, name, cores, unit, guard (relative),
/// reason. A row's name is what stands before its first comma.
/// @throws InputError with file, line and column, also for a row that does not exist
void take_guards(const std::string& file, std::string_view text, std::vector<MicrobenchRow>& rows);

/// The chip without what compilers add, for streams in step.
/// @param loads_used_at_once  share of loads whose result the next instruction uses
sim::ChipConfig as_assembly(sim::ChipConfig chip, double loads_used_at_once = 0);

/// What a program reads, and where its results go.
template <class P, class T>
using In = typename P::template Span<const T>;
template <class P, class T>
using Out = typename P::template Span<T>;

/// A block of memory with values that do not matter for its timing; the host fills it.
template <class Span>
Span block(work::Machine& machine, std::string_view name, int n) {
  const Span span = machine.local().alloc<Span>(name, n);
  for (int i = 0; i < n; ++i) span.data()[i] = {};
  return span;
}

class Bench {
 public:
  /// @param cores  up to the number of workers; one more, and the master takes part
  Bench(const sim::ChipConfig& chip, int cores, const work::CodeMap* code = nullptr);

  /// What the master does in one stage.
  work::Job record(const std::function<void(work::Machine&)>& body);
  sim::StageTiming time(const work::Job& job) const;

  /// Times one stage in which every core runs body(core).
  sim::StageTiming fork(const std::function<void(work::Core&)>& body);
  /// Times one stage in which the master runs body(machine).
  sim::StageTiming run(const std::function<void(work::Machine&)>& body);
  /// Seconds of one stage in which the controller runs body(machine).
  double controller_seconds(const std::function<void(work::Machine&)>& body);
  /// Cycles from the controller's call until it has the result of an empty task, in its own clock.
  double offload_cycles();

 private:
  sim::ChipConfig config_;
  bool with_master_;
  int workers_;
  work::Machine machine_;
};

/// Cycles per slot of a stream of `slots` that every core runs, forking left out.
double stream_cycles(const sim::ChipConfig& chip, int cores, int slots,
                     const std::function<void(work::Core&)>& body);

// Kernels with published cycles: what each does is recorded once and timed on any chip, so also
// with every uncertain number of a platform at both ends of its range.

struct KernelJob {
  MicrobenchRow row{};  ///< with nothing simulated yet
  work::Job job{};
  work::Job left_out{};  ///< whose time is not in the published figure: the fork of one core
  double calls = 1;      ///< that the figure is of

  double cycles_on(const sim::ChipConfig& chip) const;
};

/// With the bands that the ranges of the platform's numbers leave.
std::vector<MicrobenchRow> banded_rows(const std::vector<KernelJob>& kernels,
                                       const platform::Variants& platform);

/// isa.unmeasured_instructions of the platform with which every kernel of one core would take what
/// is published, but for kernels that mostly wait for something else than instructions. Rising.
std::vector<double> needed_instructions(const std::vector<KernelJob>& kernels,
                                        const platform::Variants& platform);

// The programs behind the rows of tools/app/validation/published/gap9_units.csv, by name.

/// One program; what it measures is in the unit of its reference.
struct UnitBench {
  std::string_view name;
  double (*measure)(const sim::ChipConfig& chip, int cores);
};

/// Streams of instructions that share units, or run on one core.
std::span<const UnitBench> stream_benches();
/// Memories, caches, synchronisation and transfers.
std::span<const UnitBench> memory_benches();

/// Runs every program that has a reference on the chip.
/// @throws InputError if the reference file names a program that does not exist
std::vector<MicrobenchRow> unit_rows(const sim::ChipConfig& chip);

// The kernels that the vendor measured on a GAP8 board (board_programs.h), timed on a chip and
// compared with tools/app/validation/published/gap8_board.csv.

/// The kernel of every reference: 100 calls, each with its fork.
/// @param references  as reference_rows() gives them: group is the kernel, name the variant
/// @throws InputError if there is no such kernel
std::vector<KernelJob> board_kernels(const sim::ChipConfig& chip,
                                     std::vector<MicrobenchRow> references);
/// Those that are part of the program.
std::vector<KernelJob> board_kernels(const sim::ChipConfig& chip);

/// Cycles with bands, and after them the speed-ups of eight cores, with a tolerance of 0.5; with
/// the guards that are part of the program.
std::vector<MicrobenchRow> board_rows(const std::vector<KernelJob>& kernels,
                                      const platform::Variants& platform);

// Kernels of a public library for which cycles are published (library_programs.h), timed on a chip
// and compared with tools/app/validation/published/pulp_dsp.csv.

/// What the chip of the figures, a sibling of GAP9, has less of; none of it matters to the kernels.
/// They were scheduled by hand.
inline constexpr std::array kLibraryChip{"cluster.l1.size=64KiB", "cluster.fpu.units=2",
                                         "isa.load_use_fraction=0"};

/// The kernel of every reference. @throws InputError if there is no such kernel
std::vector<KernelJob> library_kernels(const sim::ChipConfig& chip);

// Rows of a comparison with hardware, for people and for programs.

/// Grouped, with the error of each row, a line that sums up, and a warning for each row that is
/// worse than its tolerance or guard.
std::string microbench_table(std::string_view chip, const std::vector<MicrobenchRow>& rows);
/// How many references lie inside their bands, and what plain code is short of.
/// @param needed  needed_instructions(), rising
std::string coverage_text(const std::vector<MicrobenchRow>& rows,
                          const std::vector<double>& needed);
/// Whether all rows are as near as they have to be, in a sentence.
std::string microbench_conclusion(const std::vector<MicrobenchRow>& rows);
Table microbench_rows(const std::vector<MicrobenchRow>& rows);

/// Mean of the absolute errors.
double mean_error(const std::vector<MicrobenchRow>& rows);

}  // namespace leviosim::tools
