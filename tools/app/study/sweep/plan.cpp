#include "tools/app/study/sweep/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "sim/base/input_file.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/run/yaml_map.h"
#include "tools/app/study/sweep/key_domain.h"
#include "tools/app/study/sweep/sweep_inputs.h"
#include "tools/app/study/sweep/sweep_key.h"

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
    const YamlMap root(platform::parse_yaml(plan_.file, plan_.text), plan_.file, "");
    root.check_keys({"base", "points", "impossible"});
    const YamlEntry* base = root.find("base");
    const YamlEntry* points = root.find("points");
    if (base == nullptr)
      Place{plan_.file}.fail("missing key 'base'; expected base: { trace: … } or { data: … }");
    if (points == nullptr)
      Place{plan_.file}.fail(
          "missing key 'points'; expected groups of grid, list, random or "
          "latin_hypercube");
    if (const YamlEntry* impossible = root.find("impossible")) {
      const std::string text = root.text(*impossible);
      if (text != "refuse" && text != "skip")
        root.place(*impossible)
            .fail(fmt::format("'{}' is not known; expected refuse or skip", text));
      plan_.skip_impossible = text == "skip";
    }
    const YamlMap common = root.below(*base);
    choose_reference(common, points->value);
    read_base(common);
    read_groups(points->value, root.place(*points), points->line);
    return std::move(plan_);
  }

 private:
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
  void choose_reference(const YamlMap& base, const YamlNode& points) {
    const auto first = [&](const char* key) {
      const YamlEntry* entry = base.find(key);
      return entry != nullptr && entry->value.is_scalar() ? entry->value.scalar()
                                                          : first_value(points, key);
    };
    const auto at = [&](const char* key) {
      const YamlEntry* entry = base.find(key);
      return entry != nullptr ? base.place(*entry) : Place{plan_.file + ": points"};
    };
    if (const std::string name = first("platform"); !name.empty())
      plan_.reference = &inputs_.platform(name, at("platform"));
    else if (const std::string trace = first("trace"); !trace.empty())
      plan_.reference = &inputs_.trace(trace, at("trace")).platform;
    else
      Place{plan_.file}.fail("base.platform is missing; expected a chip (leviosim platforms)");
  }

  void read_base(const YamlMap& all) {
    for (const YamlEntry& entry : all.entries()) {
      plan_.base[entry.key] = read_value(all, entry).second;
      plan_.base_places.emplace(entry.key, all.place(entry));
    }
  }

  /// A key of the plan with its only value.
  std::pair<SweepKey, std::string> read_value(const YamlMap& all, const YamlEntry& entry) const {
    const Place at = all.place(entry);
    const SweepKey key = find_key(entry.key, plan_.reference->schema(), at);
    return {key, normal_value(key, all.text(entry), *plan_.reference, at)};
  }

  void read_groups(const YamlNode& points, const Place& at, int line) {
    if (points.is_mapping()) {
      read_group(points, line);
    } else if (points.is_sequence()) {
      for (const YamlNode& group : points.items()) read_group(group, group.line());
    } else {
      at.fail(fmt::format("is {}; expected groups", platform::kind_of(points)));
    }
    if (plan_.groups.empty()) at.fail("is empty; expected groups");
  }

  void read_group(const YamlNode& node, int line) {
    SweepGroup group{platform::place_of(plan_.file, line, "points"), {}};
    const YamlMap all(node, plan_.file, "points");
    std::vector<std::string> names;
    for (const MemberName& m : kMembers) names.emplace_back(m.name);
    all.check_keys(names);
    if (all.entries().empty())
      group.place.fail("is empty; expected grid, list, random or latin_hypercube");
    std::map<std::string, Place> given;
    for (const YamlEntry& entry : all.entries()) {
      group.members.push_back(read_member(all, entry));
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

  SweepMember read_member(const YamlMap& group, const YamlEntry& entry) {
    SweepMember member;
    member.place = group.place(entry);
    for (const MemberName& m : kMembers)
      if (entry.key == m.name) member.kind = m.kind;
    if (member.kind == MemberKind::list)
      read_list(entry.value, member);
    else if (member.kind == MemberKind::grid)
      member.axes = read_axes(group.below(entry), false);
    else
      read_draws(group.below(entry), member);
    if (member.axes.empty()) member.place.fail("is empty; expected keys with their values");
    return member;
  }

  std::vector<SweepAxis> read_axes(const YamlMap& all, bool ranges) const {
    std::vector<SweepAxis> axes;
    for (const YamlEntry& entry : all.entries()) {
      const Place at = all.place(entry);
      SweepAxis axis{find_key(entry.key, plan_.reference->schema(), at), at, {}};
      axis.domain = read_domain(axis.key, all, entry, *plan_.reference);
      if (axis.domain.span && !ranges)
        at.fail("is a range without step; expected values, or a step");
      axes.push_back(std::move(axis));
    }
    return axes;
  }

  void read_draws(const YamlMap& all, SweepMember& member) {
    all.check_keys({"number", "seed", "over"});
    const YamlEntry* number = all.find("number");
    const YamlEntry* over = all.find("over");
    if (number == nullptr || over == nullptr)
      member.place.fail("expected number: how many points, and over: { key: values or range }");
    const auto whole = [&](const YamlEntry& entry, std::int64_t low, std::int64_t high) {
      const std::string text = all.text(entry);
      return read_at(all.place(entry), [&] { return parse_whole(entry.key, text, low, high); });
    };
    member.count = static_cast<std::size_t>(whole(*number, 1, kMostDraws));
    if (const YamlEntry* seed = all.find("seed"))
      member.seed =
          static_cast<std::uint64_t>(whole(*seed, 0, std::numeric_limits<std::int64_t>::max()));
    member.axes = read_axes(all.below(*over), true);
  }

  void read_list(const YamlNode& list, SweepMember& member) const {
    if (!list.is_sequence())
      member.place.fail(fmt::format("is {}; expected a list of points, {{ key: value, … }} each",
                                    platform::kind_of(list)));
    for (const YamlNode& row : list.items()) {
      SweepRow& values = member.rows.emplace_back();
      const YamlMap all(row, plan_.file, "points.list");
      for (const YamlEntry& entry : all.entries()) {
        const auto [key, value] = read_value(all, entry);
        values[key.name] = value;
        if (std::none_of(member.axes.begin(), member.axes.end(),
                         [&, &name = key.name](const SweepAxis& a) { return a.key.name == name; }))
          member.axes.push_back({key, all.place(entry), {}});
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
