// Names of worlds, as plans and command lines have them.
#include "traces/synthesis/place.h"

#include <gtest/gtest.h>

#include "tests/traces/test_folder.h"

namespace leviosim::traces {
namespace {

TEST(Place, IsReadAsItIsWritten) {
  for (const char* text :
       {"0", "4", "workshop:1", "workshop:9223372036854775807", "0.3m:2", "30m:1"})
    EXPECT_EQ(parse_place("a world", text).text(), text);
  EXPECT_EQ(parse_place("a world", "hall:7"), parse_place("a world", "7"));
  EXPECT_EQ(parse_place("a world", "0.3m:2").distance_m, 0.3);
  EXPECT_NE(parse_place("a world", "workshop:1"), parse_place("a world", "1"));
}

TEST(Place, OtherTextIsRefused) {
  const auto refused = [](const char* text, std::initializer_list<std::string> parts) {
    testing::expect_input_error([&] { parse_place("--world", text); }, parts);
  };
  refused("workshp:1", {"--world 'workshp:1'", "did you mean 'workshop'", "0.2m to 100m"});
  refused("workshop", {"--world 'workshop'", "a whole number from 0", "workshop:4"});
  refused("workshop:", {"a whole number"});
  refused("-1", {"a whole number"});
  refused("9223372036854775808", {"a whole number"});
  refused("0.1m:1", {"a distance from 0.2m"});
  refused("nanm:1", {"a distance from 0.2m"});
}

}  // namespace
}  // namespace leviosim::traces
