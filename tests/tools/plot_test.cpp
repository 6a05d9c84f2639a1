#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/well_formed.h"
#include "tools/app/report/plot/plot.h"

namespace leviosim::tools::plot {
namespace {

using tools::testing::xml_fault;

TEST(XmlFault, IsSeen) {
  const auto fault = [](const std::string& body) {
    return xml_fault("<?xml version=\"1.0\"?>\n" + body);
  };
  EXPECT_EQ(fault("<a x=\"1\"><b/>&amp;</a>"), "");
  for (const char* broken : {"<a>", "<a></b>", "<a/><a/>", "<a>&</a>", "<a>&nbsp;</a>", "<a x=1/>",
                             "<a x=\"1\" x=\"2\"/>", "<a/>text", "<a>\x01</a>", ""})
    EXPECT_NE(fault(broken), "") << broken;
}

TEST(Svg, EscapesText) {
  EXPECT_EQ(escape_xml("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &apos;d&apos;");
  EXPECT_EQ(escape_xml("10.5° – 🛸\t\n"), "10.5° – 🛸\t\n");
  const std::string replaced = "\xEF\xBF\xBD";
  EXPECT_EQ(escape_xml("\x01x\x7f"), replaced + "x\x7f");
  EXPECT_EQ(escape_xml("\xff\xc3"), replaced + replaced);  // no UTF-8, and one cut off
  EXPECT_EQ(escape_xml("\xc0\x80"), replaced + replaced);  // an overlong zero
  EXPECT_EQ(escape_xml("\xed\xa0\x80"), replaced + replaced + replaced);  // half a surrogate pair
}

TEST(Svg, IsWellFormedWhateverItHolds) {
  Svg svg(100, 50, "<title> & more");
  svg.line({0, 0}, {1, 1}, {});
  svg.rectangle({1, 1, 8, 8}, "#00ff00");
  svg.rectangles({{1, 2, 3, 4}, {5, 6, 7, 8}}, "#ff0000");
  svg.text({3, -0.001}, "\"quoted\" <b>", {12, Anchor::end, "#000000", true, true});
  const std::string text = svg.str();
  EXPECT_EQ(xml_fault(text), "") << text;
  EXPECT_EQ(text.find("-0.00"), std::string::npos) << text;
}

TEST(Ticks, AreRoundAndWithinTheRange) {
  for (const double low : {-1234.5, -1.0, 0.0, 0.013, 4.4e5})
    for (const double length : {1e-4, 0.07, 1.0, 3.3, 99.9, 1e7}) {
      const Range range{low, low + length};
      const Ticks ticks = round_ticks(range, 6);
      ASSERT_FALSE(ticks.values.empty()) << low << ' ' << length;
      EXPECT_LE(ticks.values.size(), 6u);
      const double mantissa = ticks.step / std::pow(10, std::floor(std::log10(ticks.step) + 1e-9));
      EXPECT_TRUE(std::abs(mantissa - 1) < 1e-9 || std::abs(mantissa - 2) < 1e-9 ||
                  std::abs(mantissa - 5) < 1e-9)
          << ticks.step;
      for (const double value : ticks.values) {
        EXPECT_GE(value, range.low - 1e-6 * length);
        EXPECT_LE(value, range.high + 1e-6 * length);
        EXPECT_NEAR(value / ticks.step, std::round(value / ticks.step), 1e-6);
      }
    }
  EXPECT_EQ(round_ticks({0, 10}, 6).values, (std::vector<double>{0, 2, 4, 6, 8, 10}));
}

TEST(Ticks, AreLabelledWithTheDecimalsOfTheirStep) {
  EXPECT_EQ(tick_label(0.30000000000000004, 0.1), "0.3");
  EXPECT_EQ(tick_label(-0.0, 0.5), "0.0");
  EXPECT_EQ(tick_label(20, 5), "20");
  EXPECT_EQ(tick_label(-0.02, 0.01), "-0.02");
}

}  // namespace
}  // namespace leviosim::tools::plot
