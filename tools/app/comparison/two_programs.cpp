#include "tools/app/comparison/two_programs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "sim/base/error.h"
#include "sim/base/text.h"
#include "tools/app/cli/child_programs.h"
#include "tools/app/run/run_folder.h"

namespace leviosim::tools {
namespace {

constexpr const char* kFrameCycles = "frame.cycles.parallel.mean";

std::filesystem::path new_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "leviosim-programs-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw InputError(fmt::format("{}: cannot be made", name));
  return name;
}

/// Work of closed loops cannot be recorded.
bool is_recorded(const std::vector<std::string>& arguments) {
  return std::none_of(arguments.begin(), arguments.end(), [](const std::string& word) {
    return word.starts_with("--fps") || word.starts_with("--deadline") || word == "--native";
  });
}

}  // namespace

TwoPrograms::TwoPrograms(const std::vector<std::string>& programs,
                         const std::vector<std::string>& arguments) {
  if (programs.size() != 2)
    throw InputError(fmt::format("--programs: expected two programs, found {}", programs.size()));
  new_program_ = programs.back();
  place_ = new_folder();
  try {
    for (const std::string& program : programs) {
      folders_.push_back((place_ / (folders_.empty() ? "A" : "B")).string());
      std::vector<std::string> words{program, "run"};
      words.insert(words.end(), arguments.begin(), arguments.end());
      if (is_recorded(arguments)) words.emplace_back("--record");
      words.insert(words.end(), {"--quiet", "--out", folders_.back()});
      if (const int status = run_child(words, true); status != 0)
        throw InputError(fmt::format("{}: run ended with status {}", program, status));
    }
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove_all(place_, ignored);
    throw;
  }
}

TwoPrograms::~TwoPrograms() {
  std::error_code ignored;
  std::filesystem::remove_all(place_, ignored);
}

std::optional<double> TwoPrograms::cycles_of_replay(const std::string& platform) const {
  const std::string out = (place_ / "replay").string();
  if (run_child({new_program_, "replay", folders_[0] + '/' + kWorkTraceFile, "--platform", platform,
                 "--quiet", "--force", "--out", out},
                true) != 0)
    return std::nullopt;
  return read_run_folder(out, false).record.value(kFrameCycles);
}

std::string TwoPrograms::split() const {
  if (!std::filesystem::exists(folders_[0] + '/' + kWorkTraceFile)) return {};
  const auto a = read_run_folder(folders_[0], false).record.value(kFrameCycles);
  const auto b = read_run_folder(folders_[1], false).record.value(kFrameCycles);
  const auto timed = cycles_of_replay(folders_[0] + "/platform.yaml");
  const auto on_new_chip = cycles_of_replay(folders_[1] + "/platform.yaml");
  if (!a || !b || !timed || !on_new_chip || *a == 0) return {};
  const auto percent = [&](double from, double to) {
    const std::string text = fmt::format("{:+.2f} %", 100 * (to - from) / *a);
    return from == to ? std::string("0") : text;
  };
  return fmt::format("of {}: other work {}, cost of the same {}, chip {}", percent(*a, *b),
                     percent(*on_new_chip, *b), percent(*a, *timed), percent(*timed, *on_new_chip));
}

}  // namespace leviosim::tools
