// Whether a chip with other parameters can be: asked of one that changes, as of one that is
// resolved.
#include "platform_models/loader/varying_chip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "platform_models/loader/loader.h"
#include "platform_models/loader/platform_file.h"
#include "sim/base/error.h"

namespace leviosim::platform {
namespace {

/// A value of the field that is near its own, at an end of what is allowed, or anything between.
std::string some_value(const Field& field, const Setting& own, std::mt19937& random) {
  if (field.is_choice()) return field.choices[random() % field.choices.size()];
  const double factors[] = {0, 0.25, 0.5, 1, 2, 4, 16, 1e3};
  double base = own.base * factors[random() % 8];
  if (random() % 8 == 0) base = random() % 2 == 0 ? field.min : field.max;
  if (field.dimension->whole) base = std::round(base);
  return number_text(base) + std::string(field.dimension->units[0].name);
}

std::optional<ResolvedPlatform> resolved(PlatformFile& file,
                                         const std::vector<std::string>& overrides) {
  try {
    return file.resolve(overrides);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

TEST(VaryingChip, SaysWhatResolvingSaysAndBecomesThatChip) {
  std::mt19937 random(3);
  for (const std::string& name : platform_names()) {
    PlatformFile file = PlatformFile::named(name);
    const Schema& schema = file.schema();
    const Settings own = file.settings_with({});
    std::vector<std::size_t> given;
    for (std::size_t i = 0; i < own.size(); ++i)
      if (own[i]) given.push_back(i);
    int possible = 0;
    int impossible = 0;
    for (int chip = 0; chip < 12; ++chip) {
      std::vector<std::size_t> varied;
      while (varied.size() < 4) {
        // Supply, workers and banks contradict each other more often than latencies do.
        const std::size_t field =
            random() % 2 == 0 ? schema.find(std::vector<std::string>{
                                    "cluster.clock", "cluster.workers", "cluster.max_workers",
                                    "cluster.l1.banks", "cluster.fpu.units"}[random() % 5])
                              : given[random() % given.size()];
        if (std::find(varied.begin(), varied.end(), field) == varied.end()) varied.push_back(field);
      }
      VaryingChip varying(schema, own);
      for (int step = 0; step < 10; ++step) {
        std::vector<std::string> overrides;
        bool read = true;
        for (const std::size_t field : varied) {
          const std::string text = some_value(schema.fields()[field], *own[field], random);
          overrides.push_back(schema.fields()[field].path + "=" + text);
          const std::optional<double> value = varying.value_of(field, text);
          read = read && value;
          if (value) varying.set(field, *value, text);
        }
        const std::optional<ResolvedPlatform> whole = resolved(file, overrides);
        ASSERT_EQ(read && varying.is_possible(), whole.has_value())
            << name << " " << ::testing::PrintToString(overrides);
        ++(whole ? possible : impossible);
        if (!whole) continue;
        for (const Field& field : schema.fields())
          ASSERT_EQ(field.get(varying.config()), field.get(whole->config))
              << name << " " << field.path << " " << ::testing::PrintToString(overrides);
      }
    }
    EXPECT_GT(possible, 0) << name;
    EXPECT_GT(impossible, 0) << name;
  }
}

}  // namespace
}  // namespace leviosim::platform
