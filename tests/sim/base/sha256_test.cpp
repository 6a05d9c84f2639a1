#include "sim/base/sha256.h"

#include <gtest/gtest.h>

namespace leviosim::base {
namespace {

TEST(Sha256, MatchesTheStandardsExamples) {
  // FIPS 180-4 / NIST example values.
  EXPECT_EQ(Sha256().hex(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  const std::string abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  Sha256 sha;
  sha.add("a");
  sha.add("bc");
  EXPECT_EQ(sha.hex(), abc);
  EXPECT_EQ(sha256_of("abc"), abc);
}

}  // namespace
}  // namespace leviosim::base
