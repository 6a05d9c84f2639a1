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
  svg.polyline({{0, 0}, {5, 5}, {5.01, 5}, {9, 9}}, {"#ff0000", 2, "3 2"});
  svg.begin_clip({1, 2, 3, 4});
  svg.circle({5, 5}, 2, "#ffffff", {});
  svg.end_group();
  svg.polygon({{1, 1}, {2, 2}, {1, 3}}, "#00ff00", {});
  svg.frame({1, 1, 8, 8}, {});
  svg.text({3, -0.001}, "\"quoted\" <b>", {12, Anchor::end, "#000000", true, true});
  const std::string text = svg.str();
  EXPECT_EQ(xml_fault(text), "") << text;
  EXPECT_NE(text.find("points=\"0.00,0.00 5.00,5.00 9.00,9.00\""), std::string::npos) << text;
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

TEST(Axes, MapTheRangeToTheBoxWithYUpwards) {
  const Axes axes({10, 20, 100, 50}, {0, 1}, {-1, 1});
  EXPECT_DOUBLE_EQ(axes.at(0, -1).x, 10);
  EXPECT_DOUBLE_EQ(axes.at(0, -1).y, 70);
  EXPECT_DOUBLE_EQ(axes.at(1, 1).x, 110);
  EXPECT_DOUBLE_EQ(axes.at(1, 1).y, 20);
}

TEST(Axes, LogarithmicOnesMapRatiosToDistances) {
  const Axes axes({0, 0, 300, 100}, {1, 1000}, {0.1, 10}, Scale::logarithmic);
  EXPECT_NEAR(axes.at(10, 1).x, 100, 1e-9);
  EXPECT_NEAR(axes.at(100, 1).x, 200, 1e-9);
  EXPECT_NEAR(axes.at(10, 1).y, 50, 1e-9);
}

TEST(Ticks, OfLogarithmicAxesAreRound) {
  const std::vector<double> all = logarithmic_ticks({0.9, 60}, 10);
  ASSERT_EQ(all.size(), 6u);
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_NEAR(all[i], (std::vector<double>{1, 2, 5, 10, 20, 50})[i], 1e-12);
  EXPECT_EQ(logarithmic_ticks({0.9, 6000}, 5).size(), 4u);  // powers only
  EXPECT_GE(logarithmic_ticks({6.1, 6.4}, 6).size(), 2u);   // less than a step of 1, 2, 5
  const Range wide = widened_logarithmically({1, 100}, 0.5);
  EXPECT_NEAR(wide.low, 0.1, 1e-12);
  EXPECT_NEAR(wide.high, 1000, 1e-9);
}

TEST(Axes, EqualAspectShowsCirclesAsCircles) {
  const Box box{0, 0, 400, 200};
  const auto [x, y] = equal_aspect(box, {0, 10}, {-1, 9});
  EXPECT_DOUBLE_EQ(x.length() / box.width, y.length() / box.height);
  EXPECT_LE(x.low, 0);
  EXPECT_GE(x.high, 10);
  EXPECT_DOUBLE_EQ(y.low, -1);
  EXPECT_DOUBLE_EQ(y.high, 9);
}

TEST(Axes, ARangeWithoutLengthIsWidened) {
  const Range range = widened({5, 5}, 0.1);
  EXPECT_LT(range.low, 5);
  EXPECT_GT(range.high, 5);
  EXPECT_FALSE(round_ticks(range, 5).values.empty());
}

TEST(ColourScale, CoversItsRange) {
  EXPECT_EQ(colour_index(0, 2), 0);
  EXPECT_EQ(colour_index(2, 2), kColours - 1);
  EXPECT_EQ(colour_index(1, 2), kColours / 2);
  EXPECT_EQ(colour_index(3, 2), kColours - 1);
  EXPECT_EQ(colour_index(0, 0), 0);
  EXPECT_EQ(colour(0), "#203e8c");
  EXPECT_EQ(colour(kColours - 1), "#be202e");
}

}  // namespace
}  // namespace leviosim::tools::plot
