#include "tools/app/study/flights/flight_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>
#include <set>

#include "platform_models/loader/instruction_set.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/nearest_name.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/run/run_options.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/workload_options.h"
#include "tools/app/run/yaml_map.h"
#include "traces/trajectories/trajectory.h"

namespace leviosim::tools {
namespace {

using platform::Place;
using platform::YamlEntry;
using platform::YamlNode;

constexpr std::int64_t kMostFrames = 1'000'000;
constexpr double kLeastEvery = 0.01;
constexpr double kMostEvery = 86'400;

/// A value of a list and where it stands.
struct Item {
  std::string text;
  Place place;
};

class PlanReader {
 public:
  PlanReader(const std::string& file, const std::string& text) : file_(file) {
    plan_.name = file;
    plan_.text = text;
  }

  FlightPlan read() {
    const YamlMap root(platform::parse_yaml(file_, plan_.text), file_, "");
    root.check_keys({"motions", "worlds", "recordings", "starts", "pieces", "every", "seeds",
                     "size", "disturbances", "variants"});
    for (const YamlEntry& entry : root.entries()) read_key(root, entry);
    const auto has = [&](const char* key) { return root.find(key) != nullptr; };
    const auto need = [&](const char* key) {
      if (!has(key)) Place{file_}.fail(fmt::format("missing key '{}'", key));
    };
    if (has("motions") || has("worlds") || !has("recordings"))
      for (const char* key : {"motions", "worlds"}) need(key);
    if (has("recordings") || has("starts"))
      for (const char* key : {"recordings", "starts"}) need(key);
    need("pieces");
    if (plan_.disturbances.empty()) plan_.disturbances.emplace_back();
    if (plan_.variants.empty()) plan_.variants = {{"next", {}}};
    return std::move(plan_);
  }

 private:
  void read_key(const YamlMap& root, const YamlEntry& entry) {
    const Place at = root.place(entry);
    if (entry.key == "motions") {
      for (const Item& item : items(entry, at)) plan_.motions.push_back(plain_name(item));
    } else if (entry.key == "recordings") {
      for (const Item& item : items(entry, at)) plan_.recordings.push_back(plain_name(item));
    } else if (entry.key == "worlds" || entry.key == "starts") {
      read_sets(root.below(entry), entry.key, at);
    } else if (entry.key == "pieces") {
      for (const Item& item : items(entry, at))
        plan_.lengths.push_back(item.text == "whole" ? kWholeFlight
                                : item.text == "rest"
                                    ? kRest
                                    : whole<std::size_t>("frames", item, kFewestFrames, kMostFrames,
                                                         ", rest, or whole"));
    } else if (entry.key == "disturbances") {
      for (const Item& item : items(entry, at))
        read_at(at, [&] { plan_.disturbances.push_back(traces::parse_disturbance(item.text)); });
    } else if (entry.key == "seeds") {
      plan_.seeds.clear();
      for (const Item& item : items(entry, at))
        plan_.seeds.push_back(
            whole<std::uint32_t>("a seed", item, 0, std::numeric_limits<std::uint32_t>::max()));
    } else if (entry.key == "every") {
      plan_.every_s = seconds({root.text(entry), at});
    } else if (entry.key == "size") {
      const std::string text = root.text(entry);
      plan_.size = read_at(at, [&] { return parse_size(text); });
    } else {
      read_variants(entry.value, at);
    }
  }

  /// The values of a list: at least one, none twice.
  std::vector<Item> items(const YamlEntry& entry, const Place& at) const {
    if (!entry.value.is_sequence())
      at.fail(fmt::format("is {}; expected a list", platform::kind_of(entry.value)));
    std::vector<Item> all;
    for (const YamlNode& node : entry.value.items()) {
      Item item{platform::scalar(node, at), at};
      for (const Item& other : all)
        if (other.text == item.text) at.fail(fmt::format("'{}' is given twice", item.text));
      all.push_back(std::move(item));
    }
    if (all.empty()) at.fail("is empty; expected at least one value");
    return all;
  }

  template <class Number>
  static Number whole(const char* what, const Item& item, std::int64_t low, std::int64_t high,
                      std::string_view about_max = {}) {
    return static_cast<Number>(
        read_at(item.place, [&] { return parse_whole(what, item.text, low, high, about_max); }));
  }

  static double seconds(const Item& item) {
    const double value =
        read_at(item.place, [&] { return parse_positive("a time in seconds", item.text); });
    if (value < kLeastEvery || value > kMostEvery)
      item.place.fail(
          fmt::format("{} s; expected {:g} to {:g} s", item.text, kLeastEvery, kMostEvery));
    return value;
  }

  /// Of a folder or a set, as it stands in tables.
  static std::string plain_name(const Item& item) {
    if (item.text.empty() || item.text.front() == '.' ||
        item.text.find_first_of("/,\"|\n\r") != std::string::npos)
      item.place.fail(fmt::format("'{}' is no plain name, such as MH_01_easy", item.text));
    return item.text;
  }

  void read_sets(const YamlMap& sets, const std::string& kind, const Place& all) {
    for (const YamlEntry& entry : sets.entries()) {
      const Place at = sets.place(entry);
      FlightSet set{plain_name({entry.key, at}), {}};
      for (const FlightSet& other : plan_.sets)
        if (other.name == set.name) at.fail(fmt::format("there is a set '{}' already", set.name));
      if (kind == "worlds")
        read_worlds(items(entry, at), set);
      else
        read_starts(items(entry, at), at, set);
      plan_.sets.push_back(std::move(set));
    }
    if (plan_.sets.empty()) all.fail(fmt::format("is empty; expected sets of {}", kind));
  }

  void read_worlds(const std::vector<Item>& worlds, FlightSet& set) {
    for (const Item& item : worlds) {
      set.worlds.push_back(
          read_at(item.place, [&] { return traces::parse_place("a world", item.text); }));
      if (!worlds_.insert(set.worlds.back()).second)
        item.place.fail(
            fmt::format("world {} is in another set, too; sets share no world", item.text));
    }
  }

  static void read_starts(const std::vector<Item>& starts, const Place& at, FlightSet& set) {
    if (starts.size() != 2)
      at.fail("expected [FIRST, STEP]: the frame of the first start, and frames to the next one");
    set.first = whole<std::size_t>("a frame", starts[0], 0, kMostFrames);
    set.step = whole<std::size_t>("frames", starts[1], 1, kMostFrames);
  }

  void read_variants(const YamlNode& variants, const Place& all) {
    if (!variants.is_sequence())
      all.fail(fmt::format("is {}; expected a list of {{ profile: NAME, workload.NAME: VALUE }}",
                           platform::kind_of(variants)));
    for (const YamlNode& node : variants.items()) {
      FlightVariant& variant = plan_.variants.emplace_back(FlightVariant{"next", {}});
      const YamlMap settings(node, file_, "variants");
      for (const YamlEntry& entry : settings.entries())
        read_setting(settings.text(entry), entry.key, settings.place(entry), variant);
    }
    if (plan_.variants.empty()) all.fail("is empty; expected at least one variant");
  }

  static void read_setting(const std::string& text, const std::string& key, const Place& at,
                           FlightVariant& variant) {
    if (key == "profile") {
      read_at(at, [&] { vio::expect_profile(text); });
      variant.profile = text;
      return;
    }
    const vio::Parameter& parameter = workload_parameter(at.where, key);
    variant.workload.push_back({&parameter, parse_workload_value(at.where, parameter, text)});
  }

  std::string file_;
  FlightPlan plan_;
  std::set<traces::Place> worlds_;  ///< of all sets
};

}  // namespace

std::string length_text(std::size_t frames) {
  if (frames == kRest) return "rest";
  return frames == kWholeFlight ? "whole" : fmt::format("{} frames", frames);
}

std::string FlightSet::text() const {
  std::vector<std::string> names;
  for (const traces::Place& world : worlds) names.push_back(world.text());
  return recorded() ? fmt::format("frames {}, {}, ... of recordings", first, first + step)
                    : fmt::format("worlds {}", fmt::join(names, ", "));
}

std::string FlightVariant::name() const {
  std::string text = profile;
  for (const vio::Assignment& a : workload)
    text += ' ' + a.text().substr(vio::kParameterPrefix.size());
  return text;
}

FlightPlan parse_flight_plan(const std::string& file, const std::string& text) {
  FlightPlan plan = PlanReader(file, text).read();
  check_variants(plan);
  return plan;
}

FlightPlan flight_plan_named(const std::string& name) {
  if (platform::is_path(name))
    return parse_flight_plan(name, base::read_file(name, base::InputKind::plan));
  std::vector<std::string> names;
  for (const base::BuiltinFile& file : builtin_flight_plans()) {
    if (file.name == name) {
      FlightPlan plan = parse_flight_plan(fmt::format("{}.yaml", name), std::string(file.text));
      plan.name = name;
      return plan;
    }
    names.emplace_back(file.name);
  }
  throw InputError(fmt::format("there is no plan '{}'{}; expected {}, or a file", name,
                               base::did_you_mean(name, names), fmt::join(names, ", ")));
}

void check_variants(const FlightPlan& plan) {
  std::set<std::string> names;
  for (const FlightVariant& variant : plan.variants) {
    const std::string name = variant.name();
    if (!names.insert(name).second)
      throw InputError(fmt::format("{}: the variant '{}' is given twice", plan.name, name));
    try {
      RunRequest request;
      request.profile = variant.profile;
      request.workload = variant.workload;
      check_profile(request);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}: {}", plan.name, name, error.what()));
    }
  }
}

}  // namespace leviosim::tools
