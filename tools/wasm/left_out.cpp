// What the engine of pages has none of, in the place of the files that have it on a host: files, the
// user's Ctrl-C, workloads that compute, bands of times. Where it matters, asking is a fault.
#include "platform_models/loader/builtin.h"
#include "sim/base/check.h"
#include "sim/base/input_file.h"
#include "sim/base/interruption.h"
#include "tools/app/run/time_bands.h"
#include "workload/vio/parameters.h"

namespace leviosim {

void throw_if_interrupted() {}

namespace base {

PathKind kind_of(const std::filesystem::path&) { return PathKind::missing; }
std::string read_file(const std::filesystem::path&, InputKind) {
  check(false, "the engine has files");
  return {};
}

}  // namespace base

/// The platform of a page is whole: it names no file that it builds on.
namespace platform {

std::span<const base::BuiltinFile> builtin_platforms() { return {}; }
std::span<const base::BuiltinFile> builtin_instruction_sets() { return {}; }
std::span<const base::BuiltinFile> builtin_code() { return {}; }

}  // namespace platform

namespace vio {

std::string_view default_profile() { return "recorded"; }

}  // namespace vio

namespace tools {

void JobSample::add_frame(const work::Job&, Cycles) {}
void JobSample::add_iteration(const work::Job&, const sim::JobTiming&) {}
TimeBands time_bands(const platform::ResolvedPlatform&, int, const JobSample&, TimeBandsOf,
                     unsigned) {
  check(false, "the engine has bands of times");
  return {};
}

}  // namespace tools
}  // namespace leviosim
