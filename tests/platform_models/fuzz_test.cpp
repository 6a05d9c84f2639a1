// Damaged platform files and overrides: each either loads or is an InputError; nothing else is
// thrown and nothing crashes. What loads, reads back.
#include <cstdint>

#include "tests/platform_models/platform_test.h"

namespace leviosim::platform {
namespace {

/// SplitMix64, by Steele, Lea and Flood.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(next() % n); }

 private:
  std::uint64_t state_;
};

/// What YAML or the reader gives a meaning to.
std::string token(Random& random) {
  static constexpr std::string_view kTokens[] = {"{",     "}",        "[",
                                                 "]",     ":",        ": ",
                                                 "\n",    "  ",       "\t",
                                                 "#",     "- ",       "? ",
                                                 "&a ",   "*a",       "<<: ",
                                                 "!x ",   "|\n",      ">\n",
                                                 "\"",    "'",        "%",
                                                 "@",     "---\n",    "...\n",
                                                 "~",     "nan",      "1e999",
                                                 "-1",    "0",        "\\x0",
                                                 ",",     "\r",       "value:",
                                                 "unit:", "9",        ".",
                                                 "\x80",  "\xc3\xa9", "\xef\xbb\xbf",
                                                 "null"};
  if (random.below(8) == 0) return std::string(1, static_cast<char>(random.below(256)));
  return std::string(kTokens[random.below(std::size(kTokens))]);
}

void mutate(std::string& text, Random& random) {
  const std::size_t at = random.below(text.size());
  const std::size_t length = std::min<std::size_t>(random.below(40), text.size() - at);
  switch (random.below(5)) {
    case 0:
      text[at] = static_cast<char>(random.below(256));
      break;
    case 1:
      text.insert(at, token(random));
      break;
    case 2:
      text.replace(at, 1, token(random));
      break;
    case 3:
      text.erase(at, length);
      break;
    default:
      text.insert(random.below(text.size()), text.substr(at, length));
  }
  if (text.empty()) text.push_back('x');
}

bool loads(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    const ResolvedPlatform platform = resolve_platform_text("fuzz.yaml", text, overrides);
    const ResolvedPlatform again = resolve_platform_text("again.yaml", to_yaml(platform));
    EXPECT_EQ(numbers_of(again.config), numbers_of(platform.config));
    return true;
  } catch (const InputError& e) {
    EXPECT_FALSE(std::string(e.what()).empty());
    EXPECT_EQ(std::string(e.what()).find("again.yaml"), std::string::npos) << e.what();
    return false;
  }
}

TEST(Fuzz, DamagedFilesNeverCrash) {
  const std::string original = gap9_text();
  ASSERT_TRUE(loads(original));
  Random random(1);
  int loaded = 0;
  constexpr int kRounds = 200;
  for (int round = 0; round < kRounds; ++round) {
    std::string text = original;
    for (std::size_t edits = 1 + random.below(3); edits > 0; --edits) mutate(text, random);
    loaded += loads(text);
  }
  EXPECT_GT(loaded, 0);
  EXPECT_LT(loaded, kRounds);
}

TEST(Fuzz, TruncatedFilesAreRefused) {
  const std::string text = gap9_text();
  // Supply and energies are optional and come last: a file that ends before them is whole.
  const std::size_t last_brace = text.rfind('}', text.find("\nsupply:"));
  Random random(2);
  for (int round = 0; round < 50; ++round) {
    const std::size_t size = random.below(last_brace);
    EXPECT_FALSE(loads(text.substr(0, size))) << "the first " << size << " bytes";
  }
}

TEST(Fuzz, NestingIsRefusedNotFollowed) {
  for (const char* open : {"[", "{", "- ", "? ", "a: {"}) {
    std::string text;
    for (int i = 0; i < 5000; ++i) text += open;
    EXPECT_FALSE(loads(text));
  }
  EXPECT_FALSE(loads("cluster: &a { cluster: *a }\nname: x\ndescription: y\nsources: {}\n"));
  EXPECT_FALSE(loads("&a ? *a\n: *a\n"));
}

TEST(Fuzz, DamagedOverridesNeverCrash) {
  const Schema schema;
  const std::string text = gap9_text();
  Random random(3);
  for (int round = 0; round < 200; ++round) {
    const Field& field = schema.fields()[random.below(schema.fields().size())];
    std::string override = field.path + "=12 " + token(random);
    mutate(override, random);
    loads(text, {override});
  }
}

}  // namespace
}  // namespace leviosim::platform
