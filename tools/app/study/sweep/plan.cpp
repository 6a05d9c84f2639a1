#include "tools/app/study/sweep/points.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>

#include "platform_models/loader/yaml_entries.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/nearest.h"
#include "tools/app/cli/command_line.h"

namespace leviosim::tools {
namespace {

using platform::Place;
using platform::YamlEntry;
using platform::YamlNode;
using MemberKind = SweepMember::Kind;

constexpr std::int64_t kMostDraws = 1'000'000;

struct MemberName {
  const char* name;
  MemberKind kind;
};
constexpr std::array kMembers{MemberName{"grid", MemberKind::grid},
                              MemberName{"list", MemberKind::list},
                              MemberName{"random", MemberKind::random},
                              MemberName{"latin_hypercube", MemberKind::latin_hypercube}};

class PlanReader {
 public:
  PlanReader(const std::string& file, const std::string& text, SweepInputs& inputs)
      : inputs_(inputs) {
    plan_.file = file;
    plan_.text = text;
  }

  SweepPlan read() {
    const std::vector<YamlEntry> root = entries(platform::parse_yaml(plan_.file, plan_.text), "");
    check_keys(root, "", {"base", "points", "impossible"});
    const YamlEntry* base = find(root, "base");
    const YamlEntry* points = find(root, "points");
    if (base == nullptr)
      Place{plan_.file}.fail("missing key 'base'; expected base: { trace: … } or { data: … }");
    if (points == nullptr)
      Place{plan_.file}.fail(
          "missing key 'points'; expected groups of grid, list, random or "
          "latin_hypercube");
    read_impossible(find(root, "impossible"));
    const std::vector<YamlEntry> common = entries(base->value, "base");
    choose_reference(common, points->value);
    read_base(common);
    read_groups(*points);
    return std::move(plan_);
  }

 private:
  std::vector<YamlEntry> entries(const YamlNode& node, const std::string& path) const {
    return platform::entries_of(node, plan_.file, path);
  }
  Place place(const YamlEntry& entry, const std::string& path) const {
    return platform::place_of(plan_.file, entry.line, platform::joined(path, entry.key));
  }
  static const YamlEntry* find(const std::vector<YamlEntry>& all, std::string_view key) {
    const auto it =
        std::find_if(all.begin(), all.end(), [&](const YamlEntry& e) { return e.key == key; });
    return it == all.end() ? nullptr : &*it;
  }
  void check_keys(const std::vector<YamlEntry>& all, const std::string& path,
                  const std::vector<std::string>& known) const {
    for (const YamlEntry& entry : all)
      if (std::find(known.begin(), known.end(), entry.key) == known.end())
        place(entry, path)
            .fail(fmt::format("unknown key{}; expected {}", base::did_you_mean(entry.key, known),
                              fmt::join(known, ", ")));
  }

  void read_impossible(const YamlEntry* entry) {
    if (entry == nullptr) return;
    const Place at = place(*entry, "");
    const std::string text = platform::scalar(entry->value, at);
    if (text != "refuse" && text != "skip")
      at.fail(fmt::format("'{}' is not known; expected refuse or skip", text));
    plan_.skip_impossible = text == "skip";
  }

  /// The first value of a key anywhere in a tree, in the order of the file.
  static std::string first_value(const YamlNode& node, const std::string& key) {
    if (node.is_sequence())
      for (const YamlNode& item : node.items())
        if (std::string found = first_value(item, key); !found.empty()) return found;
    if (!node.is_mapping()) return {};
    for (const YamlEntry& entry : node.entries()) {
      const YamlNode& value = entry.value;
      if (entry.key == key && value.is_scalar()) return value.scalar();
      if (entry.key == key && value.is_sequence() && value.size() > 0 && value[0].is_scalar())
        return value[0].scalar();
      if (std::string found = first_value(value, key); !found.empty()) return found;
    }
    return {};
  }

  /// Numbers without unit are in the units of the first platform that the plan names.
  void choose_reference(const std::vector<YamlEntry>& base, const YamlNode& points) {
    const auto first = [&](const char* key) {
      const YamlEntry* entry = find(base, key);
      return entry != nullptr && entry->value.is_scalar() ? entry->value.scalar()
                                                          : first_value(points, key);
    };
    const auto at = [&](const char* key) {
      const YamlEntry* entry = find(base, key);
      return entry != nullptr ? place(*entry, "base") : Place{plan_.file + ": points"};
    };
    if (const std::string name = first("platform"); !name.empty())
      plan_.reference = &inputs_.platform(name, at("platform"));
    else if (const std::string trace = first("trace"); !trace.empty())
      plan_.reference = &inputs_.trace(trace, at("trace")).platform;
    else
      Place{plan_.file}.fail("base.platform is missing; expected a chip (leviosim platforms)");
  }

  void read_base(const std::vector<YamlEntry>& all) {
    for (const YamlEntry& entry : all) {
      const Place at = place(entry, "base");
      const SweepKey key = find_key(entry.key, plan_.reference->schema(), at);
      plan_.base[entry.key] =
          normal_value(key, platform::scalar(entry.value, at), *plan_.reference, at);
      plan_.base_places.emplace(entry.key, at);
    }
  }

  void read_groups(const YamlEntry& points) {
    const Place at = place(points, "");
    if (points.value.is_mapping()) {
      read_group(points.value, "points", points.line);
    } else if (points.value.is_sequence()) {
      for (const YamlNode& group : points.value.items()) read_group(group, "points", group.line());
    } else {
      at.fail(fmt::format("is {}; expected groups", platform::kind_of(points.value)));
    }
    if (plan_.groups.empty()) at.fail("is empty; expected groups");
  }

  void read_group(const YamlNode& node, const std::string& path, int line) {
    SweepGroup group{platform::place_of(plan_.file, line, path), {}};
    const std::vector<YamlEntry> all = entries(node, path);
    std::vector<std::string> names;
    for (const MemberName& m : kMembers) names.emplace_back(m.name);
    check_keys(all, path, names);
    if (all.empty()) group.place.fail("is empty; expected grid, list, random or latin_hypercube");
    std::map<std::string, Place> given;
    for (const YamlEntry& entry : all) {
      group.members.push_back(read_member(entry, path));
      for (const SweepAxis& axis : group.members.back().axes) {
        const auto [it, is_new] = given.emplace(axis.key.name, axis.place);
        if (!is_new)
          axis.place.fail(fmt::format("is already set in this group, at {}", it->second.where));
        remember(axis.key);
      }
    }
    plan_.groups.push_back(std::move(group));
  }

  void remember(const SweepKey& key) {
    for (const SweepKey& known : plan_.keys)
      if (known.name == key.name) return;
    plan_.keys.push_back(key);
  }

  SweepMember read_member(const YamlEntry& entry, const std::string& path) {
    const std::string inner = platform::joined(path, entry.key);
    SweepMember member;
    member.place = place(entry, path);
    for (const MemberName& m : kMembers)
      if (entry.key == m.name) member.kind = m.kind;
    if (member.kind == MemberKind::list)
      read_list(entry, inner, member);
    else if (member.kind == MemberKind::grid)
      member.axes = read_axes(entries(entry.value, inner), inner, false);
    else
      read_draws(entries(entry.value, inner), inner, member);
    if (member.axes.empty()) member.place.fail("is empty; expected keys with their values");
    return member;
  }

  std::vector<SweepAxis> read_axes(const std::vector<YamlEntry>& all, const std::string& path,
                                   bool ranges) const {
    std::vector<SweepAxis> axes;
    for (const YamlEntry& entry : all) {
      const Place at = place(entry, path);
      SweepAxis axis{find_key(entry.key, plan_.reference->schema(), at), at, {}};
      axis.domain = read_domain(axis.key, entry.value, plan_.file, entry.line,
                                platform::joined(path, entry.key), *plan_.reference);
      if (axis.domain.span && !ranges)
        at.fail("is a range without step; expected values, or a step");
      axes.push_back(std::move(axis));
    }
    return axes;
  }

  void read_draws(const std::vector<YamlEntry>& all, const std::string& path, SweepMember& member) {
    check_keys(all, path, {"number", "seed", "over"});
    const YamlEntry* number = find(all, "number");
    const YamlEntry* over = find(all, "over");
    if (number == nullptr || over == nullptr)
      member.place.fail("expected number: how many points, and over: { key: values or range }");
    member.count = static_cast<std::size_t>(whole(*number, path, 1, kMostDraws));
    if (const YamlEntry* seed = find(all, "seed"))
      member.seed = static_cast<std::uint64_t>(
          whole(*seed, path, 0, std::numeric_limits<std::int64_t>::max()));
    const std::string inner = platform::joined(path, "over");
    member.axes = read_axes(entries(over->value, inner), inner, true);
  }

  std::int64_t whole(const YamlEntry& entry, const std::string& path, std::int64_t low,
                     std::int64_t high) const {
    const Place at = place(entry, path);
    try {
      return parse_whole(entry.key, platform::scalar(entry.value, at), low, high);
    } catch (const InputError& error) {
      at.fail(error.what());
    }
  }

  void read_list(const YamlEntry& list, const std::string& path, SweepMember& member) const {
    if (!list.value.is_sequence())
      member.place.fail(fmt::format("is {}; expected a list of points, {{ key: value, … }} each",
                                    platform::kind_of(list.value)));
    for (const YamlNode& row : list.value.items()) {
      SweepRow& values = member.rows.emplace_back();
      for (const YamlEntry& entry : entries(row, path)) {
        const Place at = place(entry, path);
        const SweepKey key = find_key(entry.key, plan_.reference->schema(), at);
        values[key.name] =
            normal_value(key, platform::scalar(entry.value, at), *plan_.reference, at);
        if (std::none_of(member.axes.begin(), member.axes.end(),
                         [&](const SweepAxis& a) { return a.key.name == key.name; }))
          member.axes.push_back({key, at, {}});
      }
    }
  }

  SweepInputs& inputs_;
  SweepPlan plan_;
};

}  // namespace

SweepPlan parse_plan(const std::string& file, const std::string& text, SweepInputs& inputs) {
  return PlanReader(file, text, inputs).read();
}

SweepPlan read_plan(const std::string& file, SweepInputs& inputs) {
  return parse_plan(file, base::read_file(file, base::InputKind::plan), inputs);
}

}  // namespace leviosim::tools
