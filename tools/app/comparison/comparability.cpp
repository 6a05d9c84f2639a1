#include "tools/app/comparison/comparability.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "tools/app/record/record.h"

namespace leviosim::tools {
namespace {

/// A fact that must be the same.
struct Condition {
  const char* key;
  std::string (*text)(const RunFacts&);  ///< of runs that agree it is the same
};

std::string frames_text(const RunFacts& f) {
  return fmt::format("{}:{}", f.first_frame, f.first_frame + f.frames);
}

constexpr std::array kConditions{
    Condition{"frames", frames_text},
    Condition{"profile", [](const RunFacts& f) { return f.profile; }},
    Condition{"seed", [](const RunFacts& f) { return fmt::format("{}", f.seed); }},
    Condition{
        "size",
        [](const RunFacts& f) { return fmt::format("{}x{}", f.image_width, f.image_height); }},
};

/// The first input that differs; empty if all are the same. Images of other frames are other
/// inputs: those are left to the frames.
std::string differing_input(const RunFacts& a, const RunFacts& b, bool other_frames) {
  std::map<std::string, std::pair<std::string, std::string>> all;
  for (const auto& [name, digest] : a.inputs) all[name].first = digest;
  for (const auto& [name, digest] : b.inputs) all[name].second = digest;
  for (const auto& [name, digests] : all)
    if (digests.first != digests.second &&
        !(other_frames && name.find("images concatenated") != std::string::npos))
      return name;
  return {};
}

std::string list_of(const std::vector<std::string>& words) {
  return words.empty() ? "none" : fmt::format("{}", fmt::join(words, ", "));
}

void note_difference(std::vector<std::string>& notes, const char* what, const std::string& a,
                     const std::string& b) {
  const auto shown = [](const std::string& text) { return text.empty() ? "none" : text; };
  if (a != b) notes.push_back(fmt::format("{}: {} in A, {} in B", what, shown(a), shown(b)));
}

[[noreturn]] void refuse(const RunRecord& a, const RunRecord& b,
                         const std::vector<std::string>& differences,
                         const std::vector<std::string>& keys) {
  throw InputError(
      fmt::format("{} and {} cannot be compared: {}; to compare them all the same, --allow {}",
                  a.name, b.name, fmt::join(differences, ", "), fmt::join(keys, ",")));
}

/// What a measurement leaves open, and stages that the other does not have.
void note_measured(std::vector<std::string>& notes, const RunRecord& measured,
                   const RunRecord& other) {
  if (!other.facts.measured)
    notes.push_back(fmt::format("it is not checked that {} was measured on the data of {}",
                                measured.name, other.name));
  std::vector<std::string> known;
  for (const StageName& stage : other.stages) known.push_back(stage.name);
  for (const StageName& stage : measured.stages)
    if (std::none_of(other.stages.begin(), other.stages.end(),
                     [&](const StageName& s) { return s.key == stage.key; }))
      notes.push_back(fmt::format("no stage '{}' in {}{}", stage.name, other.name,
                                  base::did_you_mean(stage.name, known)));
}

}  // namespace

Allowed parse_allowed(const std::string& text) {
  std::vector<std::string> known{"chip", "data"};
  for (const Condition& condition : kConditions) known.emplace_back(condition.key);
  Allowed allowed;
  if (text.empty()) return allowed;
  for (const std::string& word : base::split(text, ',')) {
    if (std::find(known.begin(), known.end(), word) == known.end())
      throw InputError(fmt::format("--allow '{}': expected {}{}", word, fmt::join(known, ", "),
                                   base::did_you_mean(word, known)));
    allowed.insert(word);
  }
  return allowed;
}

std::vector<std::string> check_comparable(const RunRecord& a, const RunRecord& b,
                                          const Allowed& allowed) {
  std::vector<std::string> notes;
  std::vector<std::string> refused;
  std::vector<std::string> keys;
  const auto judge = [&](const char* key, const std::string& difference) {
    if (allowed.count(key) > 0) {
      notes.push_back(difference);
      return;
    }
    refused.push_back(difference);
    keys.emplace_back(key);
  };
  if (a.facts.measured || b.facts.measured) {
    const std::string &in_a = a.facts.profile, &in_b = b.facts.profile;
    if (!in_a.empty() && !in_b.empty() && in_a != in_b)
      judge("profile", fmt::format("other profile ({} and {})", in_a, in_b));
    if (!refused.empty()) refuse(a, b, refused, keys);
    if (a.facts.measured) note_measured(notes, a, b);
    if (b.facts.measured) note_measured(notes, b, a);
    return notes;
  }
  const bool other_frames = frames_text(a.facts) != frames_text(b.facts);
  if (const std::string input = differing_input(a.facts, b.facts, other_frames); !input.empty())
    judge("data", fmt::format("other data ({})", input));
  for (const Condition& condition : kConditions) {
    const std::string in_a = condition.text(a.facts);
    const std::string in_b = condition.text(b.facts);
    if (in_a != in_b)
      judge(condition.key, fmt::format("other {} ({} and {})", condition.key, in_a, in_b));
  }
  if (!refused.empty()) refuse(a, b, refused, keys);
  note_difference(notes, "program", a.facts.program, b.facts.program);
  note_difference(notes, "camera", a.facts.camera, b.facts.camera);
  note_difference(notes, "workload parameters", list_of(a.facts.workload),
                  list_of(b.facts.workload));
  return notes;
}

void check_same_chip(const RunRecord& a, const RunRecord& b, const Allowed& allowed) {
  const auto chip = [](const RunRecord& run) {
    return std::filesystem::path(run.facts.platform).stem().string();
  };
  if (chip(a).empty() || chip(b).empty() || chip(a) == chip(b) || allowed.count("chip") > 0) return;
  refuse(a, b, {fmt::format("other chip ({} and {})", chip(a), chip(b))}, {"chip"});
}

}  // namespace leviosim::tools
