// Energy of a run: every joule once, per frame, over time, at other points, and in the files.
#include "sim/work/op.h"
#include "tools/app/result/energy_summary.h"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/sim/energy_test_config.h"
#include "tests/tools/example_run.h"
#include "tools/app/record/statistics.h"
#include "tools/app/report/energy_tables.h"
#include "tools/app/report/tables.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_tables.h"

namespace leviosim::tools {
namespace {

/// The example on a chip with energy figures: 100 MHz cluster, 50 MHz controller, 1 V.
RunResult example_with_energy() {
  RunResult run = testing::example_run();
  run.chip = sim::energy_chip();
  run.chip.controller.clock = Hertz(50'000'000);
  run.chip.energy.low.core.instruction = Joules(4e-12);
  run.chip.energy.high.core.instruction = Joules(7e-12);
  run.chip.energy.high.soc.cycle = Joules(30e-12);
  run.stages[0].counts[work::Op::IntAlu] = 6'000'000;
  run.stages[0].transfers = {2, Bytes(38'400), Bytes(0)};
  run.stages[2].counts[work::Op::F32Fma] = 900'000;
  return run;
}

double total(const EnergyRow& row) { return row.energy.total().value.count(); }

TEST(RunEnergy, TimeIsTheCamerasAndEveryCycleOfTheClusterIsInOneRow) {
  const RunEnergy energy = energy_of(example_with_energy()).value();
  ASSERT_EQ(energy.rows.size(), 4u);
  EXPECT_DOUBLE_EQ(energy.time.count(), 5 * 0.05);
  double cluster = 0;
  for (const EnergyRow& row : energy.rows)
    if (!row.on_controller) cluster += row.time.count();
  EXPECT_DOUBLE_EQ(cluster, energy.time.count());
  EXPECT_DOUBLE_EQ(energy.rows[0].time.count(), 2e6 / 1e8);
  EXPECT_DOUBLE_EQ(energy.rows[2].time.count(), 1.5e6 / 5e7);
  EXPECT_EQ(energy.rows[3].name, kIdle);
}

TEST(RunEnergy, RowsAndDomainsAddUpToTheTotal) {
  const RunEnergy energy = energy_of(example_with_energy()).value();
  double rows = 0;
  for (const EnergyRow& row : energy.rows) rows += total(row);
  const sim::Estimate<Joules> all = energy.total().total();
  EXPECT_NEAR(rows, all.value.count(), 1e-15);
  EXPECT_DOUBLE_EQ(energy.per_frame()->value.count() * 5, all.value.count());
  EXPECT_DOUBLE_EQ(energy.mean_power()->value.count() * 0.25, all.value.count());
  EXPECT_LT(all.low(), all.value);
  EXPECT_GT(all.high(), all.value);
  // Static power of the chip flows all the time, and no longer.
  EXPECT_NEAR(energy.total()[sim::Domain::Soc].value.count(), 0.25 * 3e-3 + 0.25 * 5e7 * 20e-12,
              1e-15);
}

TEST(RunEnergy, PowerIsEnergyOverTheTimeOfAStage) {
  const RunEnergy energy = energy_of(example_with_energy()).value();
  const EnergyRow& stage = energy.rows[0];
  EXPECT_DOUBLE_EQ(stage.per_call()->value.count(), total(stage) / 2);
  EXPECT_DOUBLE_EQ(stage.power()->value.count(), total(stage) / 0.02);
  EXPECT_DOUBLE_EQ(energy.power_of_front_end()->value.count(), total(stage) / 0.02);
  EXPECT_DOUBLE_EQ(energy.power_of_controller()->value.count(), total(energy.rows[2]) / 0.03);
  EXPECT_FALSE(energy.rows[1].per_call());
  EXPECT_FALSE(energy.rows[1].power());
}

TEST(RunEnergy, AFrontEndThatIsTooSlowHasNoIdleTime) {
  RunResult run = example_with_energy();
  for (FrameResult& frame : run.frames) frame.cycles = Cycles(10'000'000);
  run.stages[0].parallel = Cycles(50'000'000);
  const RunEnergy energy = energy_of(run).value();
  EXPECT_DOUBLE_EQ(energy.time.count(), 0.5);
  EXPECT_EQ(energy.rows.back().time, Seconds(0));
  EXPECT_EQ(total(energy.rows.back()), 0);
}

/// Its core does one after the other: the run takes as long as both, with no time left.
TEST(RunEnergy, OfAChipWithOneCoreTakesTheTimeOfBothItsJobs) {
  RunResult run = example_with_energy();
  for (FrameResult& frame : run.frames) frame.cycles = Cycles(10'000'000);
  run.stages[0].parallel = Cycles(50'000'000);
  run.chip.controller.shares_core = true;
  const RunEnergy energy = energy_of(run).value();
  EXPECT_DOUBLE_EQ(energy.time.count(), 0.5 + energy.rows[2].time.count());
  EXPECT_GT(energy.rows[2].time.count(), 0);
}

TEST(RunEnergy, TakesAnotherTimeThanTheRuns) {
  const RunResult run = example_with_energy();
  const RunEnergy longer = energy_of(run, Seconds(1)).value();
  EXPECT_EQ(longer.time, Seconds(1));
  EXPECT_EQ(longer.rows[0].energy.total().value, energy_of(run)->rows[0].energy.total().value);
  EXPECT_NEAR(longer.rows.back().time.count() - energy_of(run)->rows.back().time.count(), 0.75,
              1e-12);
}

TEST(RunEnergy, AtItsOwnPointIsTheRunsAndAtHalfTheClockStagesTakeTwiceAsLong) {
  const RunResult run = example_with_energy();
  const RunEnergy own = energy_of(run).value();
  const RunEnergy same = energy_at(run, {Volts(1), Hertz(100'000'000)}).value();
  const RunEnergy half = energy_at(run, {Volts(1), Hertz(50'000'000)}).value();
  EXPECT_EQ(same.total().total().value, own.total().total().value);
  EXPECT_DOUBLE_EQ(half.rows[0].time.count(), 2 * own.rows[0].time.count());
  EXPECT_DOUBLE_EQ(half.rows[2].time.count(), 2 * own.rows[2].time.count());
  EXPECT_LT(half.mean_power()->value, own.mean_power()->value);
}

TEST(RunEnergy, WithoutFiguresOrTimingThereIsNone) {
  EXPECT_FALSE(energy_of(testing::example_run()));
  EXPECT_EQ(energy_table(testing::example_run()), "");
  EXPECT_EQ(power_table(testing::example_run()), "");
  EXPECT_EQ(operating_point_table(testing::example_run()), "");
  EXPECT_EQ(csv_text(energy_rows(testing::example_run())), "");
  RunResult native = example_with_energy();
  native.timed = false;
  EXPECT_FALSE(energy_of(native));
}

TEST(RunEnergy, OfARunWithoutFramesIsStillText) {
  RunResult run;
  run.chip = sim::energy_chip();
  EXPECT_NE(report(run).find("frames: 0"), std::string::npos);
  EXPECT_FALSE(energy_of(run)->per_frame());
}

TEST(EnergyTables, ShowStagesDomainsAndOperatingPoints) {
  const std::string text = report(example_with_energy());
  for (const char* part : {"energy at 1 V, cluster 100 MHz, controller 50 MHz", kIdle,
                           "while the optimiser runs, it adds", "controller", "all the time",
                           "0.65 V", "240 MHz", "1.25 V", "400 MHz"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

struct CsvRow {
  std::string stage, quantity, domain, value, unit, low, high;
};
std::vector<CsvRow> rows_of(const std::string& csv) {
  std::istringstream in(csv);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "stage,quantity,domain,value,unit,low,high");
  std::vector<CsvRow> rows;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    CsvRow row;
    for (std::string CsvRow::*cell : {&CsvRow::stage, &CsvRow::quantity, &CsvRow::domain,
                                      &CsvRow::value, &CsvRow::unit, &CsvRow::low, &CsvRow::high})
      std::getline(cells, row.*cell, ',');
    rows.push_back(row);
  }
  return rows;
}

TEST(EnergyCsv, DomainsAndStagesAddUp) {
  double domains = 0;
  double stages = 0;
  double domain_total = 0;
  double all = 0;
  for (const CsvRow& row : rows_of(csv_text(energy_rows(example_with_energy())))) {
    const double value = std::stod(row.value);
    EXPECT_LE(std::stod(row.low), value);
    EXPECT_GE(std::stod(row.high), value);
    if (row.quantity != "energy") continue;
    EXPECT_EQ(row.unit, "mJ");
    if (row.stage == "all" && row.domain == "total") all = value;
    if (row.stage == "all" && row.domain != "total") domain_total += value;
    if (row.stage != "all" && row.domain == "total") stages += value;
    if (row.stage != "all" && row.domain != "total") domains += value;
  }
  EXPECT_GT(all, 0);
  for (const double sum : {domains, stages, domain_total}) EXPECT_NEAR(sum, all, 2e-5);
}

TEST(EnergyStatistics, AreThoseOfTheRun) {
  const RunResult run = example_with_energy();
  const RunEnergy energy = energy_of(run).value();
  const RunFigures figures = figures_of(run);
  const auto value = [&](const std::string& name) { return figures.find(name)->value; };
  EXPECT_EQ(value("energy.frame"), energy.per_frame()->value.count() * 1e3);
  EXPECT_EQ(value("energy.frame.low"), energy.per_frame()->low().count() * 1e3);
  EXPECT_EQ(value("energy.mean_power.high"), energy.mean_power()->high().count() * 1e3);
  EXPECT_EQ(value("energy.feature_extraction.call"),
            energy.rows[0].per_call()->value.count() * 1e6);
  EXPECT_FALSE(value("energy.epnp_ransac.power"));
  EXPECT_EQ(value("run.voltage"), 1);
}

}  // namespace
}  // namespace leviosim::tools
