// Units, numbers and suggestions.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "platform_models/loader/parameter_units.h"
#include "platform_models/loader/schema.h"
#include "platform_models/loader/value.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"

namespace leviosim::platform {
namespace {

double base_of(const char* path, const char* number, const char* unit) {
  const Schema schema;
  return read_value(schema.fields()[schema.find(path)], number, unit, {"test"}).base;
}

TEST(Units, DecimalAndBinaryPrefixes) {
  EXPECT_EQ(base_of("cluster.l1.size", "2", "B"), 2.0);
  EXPECT_EQ(base_of("cluster.l1.size", "2", "kB"), 2000.0);
  EXPECT_EQ(base_of("cluster.l1.size", "2", "KiB"), 2048.0);
  EXPECT_EQ(base_of("cluster.l1.size", "2", "MB"), 2e6);
  EXPECT_EQ(base_of("cluster.l1.size", "2", "MiB"), 2097152.0);
  EXPECT_EQ(base_of("cluster.clock", "5000", "Hz"), 5000.0);
  EXPECT_EQ(base_of("cluster.clock", "5", "kHz"), 5000.0);
  EXPECT_EQ(base_of("cluster.clock", "5", "MHz"), 5e6);
  EXPECT_EQ(base_of("cluster.clock", "5", "GHz"), 5e9);
}

TEST(Units, FractionsThatMeanWholeNumbers) {
  for (int tenths = 1; tenths < 40; ++tenths)
    EXPECT_EQ(base_of("cluster.clock", std::to_string(tenths * 0.1).c_str(), "GHz"), tenths * 1e8);
  EXPECT_EQ(base_of("l2.size", "1.5625", "MiB"), 1638400.0);
  EXPECT_THROW(base_of("cluster.clock", "1000.5", "Hz"), InputError);
  EXPECT_THROW(base_of("cluster.workers", "7.5", "cores"), InputError);
  EXPECT_THROW(base_of("l2.size", "1.0001", "KiB"), InputError);
}

TEST(Units, UnitsOfOneDimensionAreNotThoseOfAnother) {
  EXPECT_THROW(base_of("cluster.clock", "5", "cycles"), InputError);
  EXPECT_THROW(base_of("cluster.l1.size", "5", "MHz"), InputError);
  EXPECT_THROW(base_of("cluster.clock", "5", "mhz"), InputError);
  EXPECT_THROW(base_of("cluster.clock", "5", ""), InputError);
}

TEST(Units, SplitsNumberAndUnit) {
  const auto both = split_measure("  2.5e2 B/cycle ");
  ASSERT_TRUE(both);
  EXPECT_EQ(both->number, 250.0);
  EXPECT_EQ(both->unit, "B/cycle");
  EXPECT_EQ(split_measure("-3")->number, -3.0);
  EXPECT_EQ(split_measure("0x10")->unit, "x10");
  EXPECT_FALSE(split_measure("MHz"));
  EXPECT_FALSE(split_measure(""));
  EXPECT_FALSE(parse_number("3 4"));
  EXPECT_FALSE(parse_number("1e999"));
}

TEST(Units, NumbersReadBackExactly) {
  for (const double x : {0.1, 1.0 / 3, 370.0, 1e-7, 1638400.0, std::nextafter(1.0, 2.0), 1e22,
                         std::numeric_limits<double>::max()}) {
    const auto read = parse_number(number_text(x));
    ASSERT_TRUE(read) << number_text(x);
    EXPECT_EQ(*read, x);
  }
  EXPECT_EQ(number_text(370), "370");
  EXPECT_EQ(number_text(0.25), "0.25");
}

TEST(Nearest, FewestEditsWin) {
  const std::vector<std::string> names = {"workers", "max_workers", "clock"};
  EXPECT_EQ(base::nearest("wrokers", names), "workers");
  EXPECT_EQ(base::nearest("maxworkers", names), "max_workers");
  EXPECT_EQ(base::nearest("clk", names), "clock");
  EXPECT_EQ(base::nearest("workers", names), "workers");
}

TEST(Nearest, NothingAlikeGivesNoSuggestion) {
  EXPECT_EQ(base::nearest("zzzz", {"workers", "clock"}), "");
  EXPECT_EQ(base::did_you_mean("zzzz", {"workers"}), "");
  EXPECT_EQ(base::did_you_mean("worker", {"workers"}), "; did you mean 'workers'?");
  EXPECT_EQ(base::nearest("x", {}), "");
  EXPECT_EQ(base::nearest("clock", {"clock_a", "clock_b"}), "clock_a")
      << "of two as near the first";
  EXPECT_EQ(base::nearest(std::string(100000, 'q'), {"workers"}), "");
}

TEST(Schema, DescribesEveryFieldCompletely) {
  const Schema schema;
  for (const Field& field : schema.fields()) {
    EXPECT_FALSE(field.description.empty()) << field.path;
    EXPECT_LE(field.min, field.max) << field.path;
    EXPECT_EQ(field.is_choice(), field.dimension == &kChoice) << field.path;
    EXPECT_FALSE(schema.is_section(field.path)) << field.path;
    EXPECT_FALSE(schema.is_section(field.record)) << field.path;
    sim::ChipConfig chip;
    field.set(chip, field.max);
    EXPECT_EQ(field.get(chip), field.max) << field.path;
    field.set(chip, field.min);
    EXPECT_EQ(field.get(chip), field.min) << field.path;
  }
}

// Two rows of the schema must not mean the same number: setting one leaves all others alone, but
// for what `isa` says about both kinds of core.
TEST(Schema, FieldsAreIndependent) {
  const Schema schema;
  for (const Field& field : schema.fields()) {
    if (field.path.rfind("isa.", 0) == 0) continue;
    sim::ChipConfig chip;
    std::vector<double> before;
    for (const Field& other : schema.fields()) before.push_back(other.get(chip));
    field.set(chip, field.get(chip) == field.max ? field.min : field.max);
    for (std::size_t i = 0; i < schema.fields().size(); ++i) {
      const Field& other = schema.fields()[i];
      if (other.path == field.path || other.path.rfind("isa.", 0) == 0) continue;
      EXPECT_EQ(other.get(chip), before[i]) << field.path << " changes " << other.path;
    }
  }
}

}  // namespace
}  // namespace leviosim::platform
