// `leviosim eval` as users meet it.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/support/run_program.h"
#include "tests/support/scratch.h"
#include "tools/app/record/statistic_list.h"
#include "traces/synthesis/synthetic.h"
#include "traces/trajectories/trajectory.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using base::read_text_file;
using outputs::write_file_atomically;
using testing::expect_refused;
using testing::ProgramResult;
using testing::run_program;
using traces::Trajectory;
using traces::testing::TempFolder;

/// A spiral of 10 s and about 12 m, 20 poses a second; `error` bends it. [m]
Trajectory spiral(double error, std::int64_t start_ns = 5'000'000'000) {
  Trajectory trajectory;
  for (std::int64_t i = 0; i <= 200; ++i) {
    const double s = 0.05 * static_cast<double>(i);
    trajectory.push_back(
        {start_ns + i * 50'000'000, Eigen::Translation3d(std::cos(s) + error * s, std::sin(s),
                                                         0.6 * s + error * std::sin(2 * s)) *
                                        Eigen::AngleAxisd(s, Eigen::Vector3d::UnitZ())});
  }
  return trajectory;
}

class EvalCommand : public ::testing::Test {
 protected:
  EvalCommand() {
    tests::write_text(folder_ / "est.tum", traces::format_tum(spiral(0.02)));
    tests::write_text(folder_ / "gt.tum", traces::format_tum(spiral(0)));
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  ProgramResult eval(std::vector<std::string> further) {
    std::vector<std::string> words{"eval", path("est.tum"), path("gt.tum")};
    words.insert(words.end(), further.begin(), further.end());
    return run_program(folder_.path(), words);
  }
  /// What a page draws.
  Json page_data(const std::string& name) const {
    constexpr std::string_view kBegin = "id=\"data\">";
    const std::string page = base::read_text_file(folder_ / name);
    const std::size_t begin = page.find(kBegin) + kBegin.size();
    return Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  }
  void expect_files_refused(const std::string& est, const std::string& gt,
                            const std::vector<std::string>& parts) {
    expect_refused(run_program(folder_.path(), {"eval", path(est), path(gt)}), parts);
  }

  TempFolder folder_;
};

void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in:\n" << text;
}

/// The statistics of a file by their names.
std::map<std::string, Json> statistics_in(const fs::path& file) {
  std::map<std::string, Json> values;
  const Json document = Json::parse(base::read_text_file(file));
  for (const auto& [name, statistic] : document.at("statistics").items()) values[name] = statistic;
  return values;
}

TEST_F(EvalCommand, PrintsFiguresWithTheirProtocol) {
  const ProgramResult result = eval({"--relative", "2", "--relative", "5"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  expect_parts(
      result.out,
      {"est.tum (TUM, 201 poses)", "gt.tum (TUM, 201 poses)", "ATE: 0.0",
       "\n     SE3-aligned, 201 of 201 poses matched with interpolated truth (a sample "
       "within 10 ms), completion 100.0 % (10.00 s of truth, longest gap 0.05 s), 11.66 m "
       "of path\n",
       "   2 m     166", "   5 m     115",
       "\n  from every matched pose to the first that is the length farther along the true "
       "path; SE3-aligned, 201 of 201"});
}

TEST_F(EvalCommand, SaysWhichLengthsAreTooLong) {
  expect_parts(eval({}).out, {"no relative errors over 40 m: too long for 11.66 m of path"});
  const std::string out = eval({"--relative", "50", "--relative", "3", "--relative", "12"}).out;
  expect_parts(out, {"no relative errors over 12 m, 50 m: too long", "   3 m"});
  EXPECT_EQ(eval({"--relative", "50,3,12"}).out, out);
}

TEST_F(EvalCommand, TakesOtherProtocols) {
  expect_parts(eval({"--align", "none"}).out, {"not aligned, 201 of"});
  expect_parts(eval({"--align", "posyaw"}).out, {"PosYaw-aligned"});
  expect_parts(eval({"--align", "sim3"}).out, {"Sim3-aligned", "scale of the estimate: times "});
  expect_parts(eval({"--max-dt", "0.002s"}).out, {"a sample within 2 ms"});
  expect_parts(eval({"--max-dt", "10ms"}).out, {"a sample within 10 ms"});
  expect_parts(eval({"--max-dt", "2.5"}).out, {"a sample within 2.5 ms"});
  expect_parts(eval({"--max-dt", "0"}).out, {"a sample within 0 ms"});
  expect_parts(eval({"--expected", "402"}).out, {"completion 50.0 % (402 expected poses)"});
}

TEST_F(EvalCommand, WritesTheFiguresItPrints) {
  const ProgramResult result =
      eval({"--relative", "2", "--relative", "99", "--json", path("e.json")});
  EXPECT_EQ(result.status, 0) << result.err;
  std::map<std::string, Json> found = statistics_in(folder_ / "e.json");
  const auto value = [&](const char* name) { return found.at(name).at(0).get<double>(); };
  expect_parts(result.out,
               {fmt::format("ATE: {:.3f} m RMSE", value("accuracy.ate.rmse")), "attitude: tilt ",
                fmt::format("{:.3f}", value("accuracy.relative.2m.translation.rmse")),
                found.at("accuracy.ate.rmse").at(3).get<std::string>(),
                found.at("accuracy.relative.2m.count").at(3).get<std::string>()});
  EXPECT_EQ(value("accuracy.relative.2m.count"), 166);
  EXPECT_EQ(value("accuracy.matched"), 201);
  EXPECT_EQ(value("accuracy.longest_gap"), 0.05);
  EXPECT_EQ(value("accuracy.relative.99m.count"), 0);
  EXPECT_TRUE(found.at("accuracy.relative.99m.translation.mean").at(0).is_null());
  const Json document = Json::parse(base::read_text_file(folder_ / "e.json"));
  EXPECT_EQ(document.at("protocol").at("alignment"), "SE3");
  EXPECT_EQ(document.at("protocol").at("max_dt_ms"), 10);
  EXPECT_EQ(document.at("estimate").at("format"), "TUM");
}

TEST_F(EvalCommand, SetsSeveralEstimatesSideBySide) {
  tests::write_text(folder_ / "worse.tum", traces::format_tum(spiral(0.05)));
  const ProgramResult result =
      eval({"--also", path("worse.tum"), "--relative", "5", "--json", path("both.json")});
  ASSERT_EQ(result.status, 0) << result.err;
  expect_parts(result.out, {"estimate", "drift over 5 m %", "est.tum", "worse.tum"});
  Json both = Json::parse(base::read_text_file(folder_ / "both.json"));
  ASSERT_EQ(both["evaluations"].size(), 2u);
  std::vector<double> errors;
  for (Json& one : both["evaluations"]) errors.push_back(one["statistics"]["accuracy.ate.rmse"][0]);
  ASSERT_EQ(errors.size(), 2u);
  EXPECT_GT(errors[1], 2 * errors[0]);
  expect_parts(result.out, {fmt::format("{:.4f}", errors[0]), fmt::format("{:.4f}", errors[1])});

  expect_refused(eval({"--also", path("none.tum")}), {"none.tum"});
  expect_refused(eval({"--also", path("worse.tum"), "--json", path("worse.tum"), "--force"}),
                 {"--json", "worse.tum"});
}

TEST_F(EvalCommand, WritesTheSamePageAgain) {
  for (const char* name : {"a.html", "b.html"}) EXPECT_EQ(eval({"--report", path(name)}).status, 0);
  EXPECT_EQ(base::read_text_file(folder_ / "a.html"), base::read_text_file(folder_ / "b.html"));
  const Json data = page_data("a.html");
  ASSERT_EQ(data.at("evaluations").size(), 1u);
  const Json& shown = data.at("evaluations")[0];
  EXPECT_EQ(shown.at("time"), "s since the first pose");
  expect_parts(shown.at("protocol").get<std::string>(), {"SE3-aligned, 201 of 201"});
  for (const char* column :
       {"t_s", "position_error_m", "tilt_error_deg", "heading_error_deg", "estimate_x_m",
        "estimate_y_m", "estimate_z_m", "truth_x_m", "truth_y_m", "truth_z_m"})
    EXPECT_EQ(shown.at("tables").at("errors").at(column).size(), 201u) << column;
}

TEST_F(EvalCommand, APageShowsAllEstimates) {
  ASSERT_EQ(eval({"--also", path("gt.tum"), "--report", path("both.html")}).status, 0);
  const Json evaluations = page_data("both.html").at("evaluations");
  ASSERT_EQ(evaluations.size(), 2u);
  expect_parts(evaluations[0].at("name").get<std::string>(), {"est.tum"});
  expect_parts(evaluations[1].at("name").get<std::string>(), {"gt.tum"});
}

TEST_F(EvalCommand, NamesOfFilesMayHoldAnything) {
  const fs::path odd = folder_ / "a <b> & \"c\" \xff.tum";
  fs::copy_file(folder_ / "est.tum", odd);
  const ProgramResult result = run_program(
      folder_.path(),
      {"eval", odd.string(), path("gt.tum"), "--report", path("o.html"), "--json", path("o.json")});
  EXPECT_EQ(result.status, 0) << result.err;
  expect_parts(page_data("o.html").at("evaluations")[0].at("name").get<std::string>(),
               {"a <b> & \"c\" "});
  EXPECT_TRUE(Json::accept(base::read_text_file(folder_ / "o.json")));
}

TEST_F(EvalCommand, KittiFilesNeedNoTimes) {
  outputs::write_file_atomically(folder_ / "k.txt",
                                 "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n"
                                 "1 0 0 1 0 1 0 1 0 0 1 0\n1 0 0 1 0 1 0 1 0 0 1 1\n");
  outputs::write_file_atomically(folder_ / "times.txt", "0\n0.1\n0.2\n0.3\n");
  const std::vector<std::string> words{"eval", path("k.txt"), path("k.txt"), "--relative", "1"};
  ProgramResult result = run_program(folder_.path(), words);
  EXPECT_EQ(result.status, 0) << result.err;
  expect_parts(result.out,
               {"(KITTI, 4 poses)", "4 of 4 poses matched by number", "   1 m       3"});
  std::vector<std::string> timed = words;
  timed.insert(timed.end(), {"--times", path("times.txt"), "--report", path("k.html")});
  result = run_program(folder_.path(), timed);
  EXPECT_EQ(result.status, 0) << result.err;
  expect_parts(result.out, {"(0.30 s of truth, longest gap 0.10 s)"});
  EXPECT_EQ(page_data("k.html").at("evaluations")[0].at("time"), "s since the first pose");
}

TEST_F(EvalCommand, RefusesFiles) {
  expect_files_refused("none.tum", "gt.tum", {"none.tum", "no such file"});
  outputs::write_file_atomically(folder_ / "nan.tum", "1 0 0 0 0 0 0 1\n2 0 nan 0 0 0 0 1\n");
  expect_files_refused("nan.tum", "gt.tum", {"nan.tum line 2, column 3 (ty)", "'nan'"});
  outputs::write_file_atomically(folder_ / "empty.tum", "");
  expect_files_refused("est.tum", "empty.tum", {"empty.tum", "no row"});
  outputs::write_file_atomically(folder_ / "five", "1 2 3 4 5\n");
  expect_files_refused("five", "gt.tum", {"five line 1", "5 columns", "8 (TUM)"});
  tests::write_text(folder_ / "later.tum", traces::format_tum(spiral(0, 90'000'000'000)));
  expect_files_refused("est.tum", "later.tum", {"none of the 201 estimated poses", "10 ms"});
  fs::create_directory(folder_ / "folder");
  expect_files_refused("folder", "gt.tum", {"folder", "trajectory.tum"});
  outputs::write_file_atomically(folder_ / "huge.tum",
                                 "6 1e200 0 0 0 0 0 1\n7 0 1e250 0 0 0 0 1\n8 0 0 0 0 0 0 1\n");
  expect_files_refused("huge.tum", "gt.tum", {"too large"});
}

TEST_F(EvalCommand, RefusesOptions) {
  expect_refused(run_program(folder_.path(), {"eval"}), {"EST is missing"});
  expect_refused(run_program(folder_.path(), {"eval", path("est.tum")}), {"GT is missing"});
  expect_refused(eval({"third"}), {"unexpected argument 'third'"});
  expect_refused(eval({"--alig", "se3"}), {"did you mean '--align'?"});
  expect_refused(eval({"--align", "se4"}), {"'se4'", "none, se3, sim3, posyaw"});
  expect_refused(eval({"--format", "rosbag"}), {"'rosbag'", "tum, euroc, kitti"});
  for (const char* length : {"0", "-1", "far", "nan", "inf"})
    expect_refused(eval({"--relative", length}), {std::string("--relative '") + length + "'"});
  for (const char* time : {"-1ms", "soon", "ms", "2h", "1e300s", "nan"})
    expect_refused(eval({"--max-dt", time}), {std::string("--max-dt '") + time + "'", "10ms"});
  expect_refused(eval({"--expected", "0"}), {"--expected '0'"});
  expect_refused(eval({"--expected", "7"}), {"--expected 7", "201 poses that were matched"});
  expect_refused(eval({"--times", path("gt.tum")}), {"KITTI"});
}

TEST_F(EvalCommand, ReplacesFilesOnlyIfForced) {
  outputs::write_file_atomically(folder_ / "mine.html", "mine");
  expect_refused(eval({"--report", path("mine.html"), "--force"}), {"--report", "exists"});
  expect_refused(eval({"--json", path("mine.html"), "--force"}), {"--json", "exists"});
  expect_refused(eval({"--report", path("none/a.html")}), {"no folder"});
  expect_refused(eval({"--report", path("a.html"), "--json", path("a.html")}), {"--report too"});
  EXPECT_EQ(base::read_text_file(folder_ / "mine.html"), "mine");
  ASSERT_EQ(eval({"--report", path("own.html")}).status, 0);
  expect_refused(eval({"--report", path("own.html")}), {"--report", "exists", "--force"});
  EXPECT_EQ(eval({"--report", path("own.html"), "--force"}).status, 0);
}

/// The figures of a run and of its folder are the same, up to the nine decimals of its trajectory.
TEST_F(EvalCommand, AgreesWithTheRunThatMadeTheTrajectory) {
  traces::write_synthetic_flight(folder_ / "flight", {.duration_s = 3, .texel_m = 0.01});
  const ProgramResult ran = run_program(
      folder_.path(), {"run", "--native", "--quiet", "--data", path("flight"), "--frames", "0:55",
                       "--tables", "trajectory", "--out", path("run")});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const ProgramResult result = run_program(
      folder_.path(),
      {"eval", path("run"), path("flight"), "--expected", "55", "--json", path("e.json")});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto ate = [](const std::string& text) {
    const auto begin = text.find("ATE: ");
    return text.substr(begin, text.find("of path\n", begin) - begin);
  };
  EXPECT_EQ(ate(result.out), ate(ran.out));
  const auto of_run = statistics_in(folder_ / "run/run.json");
  const auto of_eval = statistics_in(folder_ / "e.json");
  int compared = 0;
  for (const auto& [name, entry] : of_run) {
    EXPECT_EQ(name.find("rotation"), std::string::npos) << "tilt and heading are meant";
    if (name.rfind("accuracy.", 0) != 0) continue;
    ++compared;
    EXPECT_NEAR(entry.at(0).get<double>(), of_eval.at(name).at(0).get<double>(), 1e-5) << name;
    EXPECT_EQ(entry.at(3), of_eval.at(name).at(3)) << "the protocol";
  }
  EXPECT_EQ(compared, 8);  // of attitudes only eval says more
}

/// The angle after an alignment of positions is nowhere taken for the error of the attitude.
TEST_F(EvalCommand, GivesTiltAndHeadingEverywhere) {
  const ProgramResult drawn =
      eval({"--report", path("errors.html"), "--json", path("errors.json")});
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  const Json shown = page_data("errors.html").at("evaluations")[0];
  expect_parts(shown.at("sentence").get<std::string>(), {", tilt 0.00°, heading 0.00° RMSE"});
  EXPECT_EQ(shown.dump().find("rotation"), std::string::npos);
  std::map<std::string, Json> found = statistics_in(folder_ / "errors.json");
  EXPECT_NEAR(found.at("accuracy.tilt.rmse").at(0).get<double>(), 0, 1e-6);
  EXPECT_NEAR(found.at("accuracy.heading.rmse").at(0).get<double>(), 0, 1e-6);
  EXPECT_EQ(found.count("accuracy.rotation.rmse"), 0u);
  const std::string rows = eval({"--also", path("gt.tum")}).out;
  expect_parts(rows, {"tilt °", "heading °"});
  EXPECT_EQ(rows.find("rotation °"), std::string::npos) << rows;
}

}  // namespace
}  // namespace leviosim::tools
