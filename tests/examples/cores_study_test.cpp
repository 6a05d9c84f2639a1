// A study is one file: cores of a chip, a row each. It has options, page, CSV, JSON and exit status
// from tools/app/study/study.h.
#include <gtest/gtest.h>
#include <CLI/CLI.hpp>

#include "sim/base/csv.h"
#include "tests/support/temporary_folder.h"
#include "tools/app/run/run_session.h"
#include "tools/app/study/feasibility/feasibility.h"
#include "tools/app/study/study.h"
#include "tools/app/table/terminal_table.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

struct CoresRow {
  const Feasibility& one;  ///< on one core
  const Feasibility& here;

  double speedup() const { return one.front_end_ms / here.front_end_ms; }
};

const Columns<CoresRow>& cores_columns() {
  using R = const CoresRow&;
  const auto figure = [](const char* title, const char* key, const char* unit, int decimals) {
    return Head{.title = title, .shown = decimals, .key = key, .decimals = 6, .unit = unit};
  };
  static const Columns<CoresRow> columns{
      {{.title = "cores", .key = "cores", .is_setup = true}, [](R r) { return r.here.cores; }},
      {figure("frame ms", "frame_ms", "ms", 2), [](R r) { return r.here.front_end_ms; }},
      {figure("worst ms", "worst_ms", "ms", 2), [](R r) { return r.here.worst_ms; }},
      {figure("speed-up", "speedup", "×", 2), [](R r) { return r.speedup(); }},
      {figure("of ideal", "efficiency", "1", 2), [](R r) { return r.speedup() / r.here.cores; }},
      {figure("frames/s", "frames_per_s", "frames/s", 1),
       [](R r) { return r.here.frames_per_second(); }},
      {{.title = "mJ/frame", .shown = 3, .key = "frame_mj", .decimals = 6, .is_banded = true},
       [](R r) {
         const auto& e = r.here.energy_per_frame;
         return e ? Cell(1e3 * Banded{e->value.count(), e->low().count(), e->high().count()})
                  : Cell();
       }},
      {{.title = "fits", .key = "fits"}, [](R r) { return r.here.fits() ? "yes" : "no"; }}};
  return columns;
}

Answer cores_answer(const StudyOptions& options, const RunnerOptions& runner, const Arguments&) {
  RunRequest request = make_chip_request(options);
  request.data = data_folder(options, runner.progress);
  ProgressLine line(runner.progress);
  FeasibilityStudy study(request, shown_on(line));
  std::vector<FeasibilityPoint> points;
  for (int cores = 1; cores <= request.platform.config.cluster.max_workers; cores *= 2)
    points.push_back({options.platform, request.platform, cores});
  const std::vector<Feasibility> found = study.on(points, runner);
  std::vector<CoresRow> rows;
  for (const Feasibility& here : found) rows.push_back({found.front(), here});
  const Table table = table_of(cores_columns(), rows);
  Answer answer{
      .parts = {terminal_text(table)},
      .conclusion = fmt::format("in short: {} cores are {:.2f} times as fast as one",
                                found.back().cores, rows.back().speedup()),
      .next = {"leviosim whatif"},
      .rows = table,
      .is_met = std::all_of(found.begin(), found.end(), [](const auto& f) { return f.fits(); })};
  answer.page.x = "cores";
  answer.page.y = "frame_ms";
  return answer;
}

Command add_cores_command(CLI::App& app, const Arguments& words) {
  return add_study<StudyOptions>(
      app, words,
      {"cores", "A workload on one, two, four … cores", "chip", {"leviosim cores --data flight"}},
      [](CLI::App& command, StudyOptions& o) { add_chip_run_options(command, o); },
      [](const StudyOptions& o) { return data_inputs(o.data); }, cores_answer);
}

TEST(CoresStudy, IsOneFileAndLeavesCsvAndPage) {
  const tests::Scratch folder;
  const std::string flight = folder / "flight";
  traces::write_synthetic_flight(flight, {.duration_s = 1, .texel_m = 0.01});
  CLI::App app;
  const Arguments words{"cores"};
  const Command command = add_cores_command(app, words);
  const std::string csv = folder / "cores.csv";
  const std::string page = folder / "cores.html";
  app.parse(fmt::format("cores --data {} --quiet --csv {} --report {}", flight, csv, page));
  command.run();
  const Table rows = read_csv(csv, base::read_text_file(csv));
  ASSERT_EQ(rows.heads().size(), 10u) << "eight columns, one of them with a band";
  ASSERT_EQ(rows.rows().size(), 4u);
  const Json columns = columns_json(rows);
  EXPECT_EQ(columns.at("cores"), (Json{1, 2, 4, 8}));
  EXPECT_EQ(columns.at("speedup")[0], 1);
  EXPECT_GT(columns.at("speedup")[3], 4.0);
  EXPECT_LT(columns.at("frame_mj_low")[0], columns.at("frame_mj")[0]);
  EXPECT_NE(base::read_text_file(page).find("frames_per_s"), std::string::npos);
  EXPECT_THROW(command.run(), InputError) << "the files are there, and --force was not given";
}

}  // namespace
}  // namespace leviosim::tools
