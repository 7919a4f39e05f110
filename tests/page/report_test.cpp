// SPDX-License-Identifier: LGPL-2.1-or-later
// The report and the manifest of a run: what they say is what the run's other files say.
#include "page/report.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/xml.hpp"
#include "page/html.hpp"
#include "picture/ink.hpp"
#include "record/history_table.hpp"
#include "record/manifest.hpp"
#include "support/compare.hpp"
#include "support/output.hpp"

namespace hexaplast {
namespace {

using namespace support;
using Json = nlohmann::json;
using output::Manifest;
using output::OutputError;

const std::string kHostile = R"(pull & <hold> "50 %" 'x' </script><script>alert(1)</script>)";

Manifest some_run() {
  return {
      .version = "1.2.3",
      .command = {"hexaplast", "run", "it's.scn"},
      .working_directory = "/somewhere",
      .title = "pull",
      .scene_file = "it's.scn",
      .scene_hash = "0123456789abcdef",
      .overrides = {"bar/material.yieldStress=250"},
      .components = {{"/bar/material", "Tissue", "What it is.", {{"yieldStress", "250", "Pa", "Where flow begins."}}}},
      .threads = 3,
      .simd = "AVX2",
      .precision = "mixed",
      .motion_solver = "EulerImplicitSolver",
      .linear_solver = "CGLinearSolver",
      .processor = "Abacus",
      .cores = 4,
      .memory_bytes = 8'000'000'000,
      .started = "2026-01-31T12:00:00Z",
      .dt = 0.01,
      .steps_asked = 6,
      .state = output::RunState::kFinished,
      .exit_reason = "All steps done",
      .duration = 1.5,
      .steps_done = 6,
      .state_hash = "fedcba9876543210",
      .summary = {{"plastic twist", "+1.000 deg"}},
      .warnings = {"warning: slow"}};
}

/// The report of a short run.
std::string report_of(const Scratch& scratch, const Manifest& manifest = some_run()) {
  Body body = yielding_block();
  output::Recorder recorder(
      scratch / "run", body,
      {.title = manifest.title, .num_steps = 6, .dt = 0.01, .num_frames = 0, .loaded_nodes = {3}});
  record_stretch(recorder, body, 6);
  recorder.finish();
  write_report(scratch / "run", manifest);
  return content(scratch / "run/report.html");
}

/// The report of a run with that table.
std::string report_of_table(const Scratch& scratch, const std::string& history) {
  fs::create_directories(scratch / "run");
  put(scratch / "run/history.csv", history);
  write_report(scratch / "run", some_run());
  return content(scratch / "run/report.html");
}

/// All that stands between `begin` and `end`, in the order of the page.
std::vector<std::string> pieces(const std::string& page, const std::string& begin, const std::string& end,
                                bool with_ends) {
  std::vector<std::string> found;
  for (std::size_t at = page.find(begin); at != page.npos; at = page.find(begin, at + 1)) {
    const std::size_t last = page.find(end, at + begin.size());
    found.push_back(with_ends ? page.substr(at, last + end.size() - at)
                              : page.substr(at + begin.size(), last - at - begin.size()));
  }
  return found;
}

std::vector<Json> charts_of(const std::string& page) {
  std::vector<Json> charts;
  for (const std::string& text : pieces(page, "<script type=\"application/json\">", "</script>", false))
    charts.push_back(Json::parse(text));
  return charts;
}

Json chart_of(const std::string& page, const std::string& quantity) {
  for (const Json& chart : charts_of(page))
    if (chart.at("quantity") == quantity) return chart;
  ADD_FAILURE() << "no chart of " << quantity;
  return {};
}

TEST(Report, HasTheNumbersOfTheHistory) {
  const Scratch scratch;
  const std::string page = report_of(scratch);
  const Csv history(content(scratch / "run/history.csv"));

  struct Expected {
    const char *quantity, *curve, *column;
    double scale, shift;
  };
  for (const Expected& expected : {Expected{"elongation", "current", "current_elongation", 100, 0},
                                   {"elongation", "plastic", "plastic_elongation", 100, 0},
                                   {"volume error", "current", "current_volume_ratio", 100, -1},
                                   {"volume error", "plastic", "plastic_rest_volume_ratio", 100, -1},
                                   {"energy", "elastic", "elastic_energy", 1, 0},
                                   {"energy", "dissipated by flow", "dissipated_energy", 1, 0},
                                   {"energy", "kinetic", "kinetic_energy", 1, 0},
                                   {"displacement of loaded nodes", "mean", "end_displacement", 1000, 0},
                                   {"yielded hexahedra", "yielded", "yielded", 1, 0},
                                   {"solver iterations", "iterations", "solver_iterations", 1, 0},
                                   {"time per step", "step", "step_ms", 1, 0}}) {
    const Json series = chart_of(page, expected.quantity).at("series").at(0);
    const auto& curves = series.at("curves");
    const auto curve =
        std::ranges::find_if(curves, [&](const Json& candidate) { return candidate.at("name") == expected.curve; });
    ASSERT_NE(curve, curves.end()) << expected.quantity << " " << expected.curve;
    ASSERT_EQ(series.at("times").size(), history.num_rows());
    for (std::size_t k = 0; k < history.num_rows(); ++k) {
      const double value = expected.scale * (history.number(k, expected.column) + expected.shift);
      EXPECT_EQ(series.at("steps")[k], history.number(k, "step"));
      EXPECT_NEAR(series.at("times")[k].get<double>(), history.number(k, "time"), 1e-8);
      EXPECT_NEAR(curve->at("values")[k].get<double>(), value, 1e-6 * std::abs(value) + 1e-12) << expected.column;
    }
  }
  const auto sum = chart_of(page, "energy").at("series").at(0).at("curves").at(3);
  EXPECT_EQ(sum.at("name"), "sum");
  double last = 0;
  for (const char* part : {"kinetic_energy", "elastic_energy", "dissipated_energy"})
    last += history.numbers(part).back();
  EXPECT_NEAR(sum.at("values").back().get<double>(), last, 1e-6);
}

TEST(Report, ChartsAreWellFormedXmlWithOneLinePerCurve) {
  const Scratch scratch;
  const std::string page = report_of(scratch);
  const std::vector<std::string> figures = pieces(page, "<figure class=\"chart\">", "</figure>", true);
  const std::vector<Json> charts = charts_of(page);
  ASSERT_GE(figures.size(), 7u);
  ASSERT_EQ(figures.size(), charts.size());
  for (std::size_t k = 0; k < figures.size(); ++k) {
    const XmlElement svg = parse_xml(pieces(figures[k], "<svg", "</svg>", true).at(0)).root;
    EXPECT_EQ(std::ranges::count(svg.children, "polyline", &XmlElement::name),
              charts[k].at("series").at(0).at("curves").size());
  }
}

TEST(Report, ShowsScenesWordsAsWordsWhateverTheyAre) {
  const Scratch scratch;
  Manifest run = some_run();
  run.title = run.exit_reason = run.scene_file = run.working_directory = kHostile;
  run.command.push_back(kHostile);
  run.warnings = {kHostile};
  run.summary = {{kHostile, kHostile}};
  run.components = {{kHostile, kHostile, kHostile, {{kHostile, kHostile, kHostile, kHostile}}}};
  const std::string page = report_of(scratch, run);
  EXPECT_FALSE(has(page, "<hold>"));
  EXPECT_FALSE(has(page, "<script>alert"));
  EXPECT_TRUE(has(page, "<h1>pull &amp; &lt;hold&gt; &quot;50 %&quot; &#39;x&#39; &lt;/script&gt;"));
  EXPECT_EQ(pieces(page, "<script", ">", true).size(),
            charts_of(page).size() + 5);  // and the page's own, the viewer's three and its data
}

TEST(Report, ViewerHasTheInksAndTheLightOfThePictures) {
  const Scratch scratch;
  const std::string page = report_of(scratch);
  EXPECT_TRUE(has(page, output::light_shader()));
  EXPECT_TRUE(has(page, "steel: [0.16,0.36,0.55]"));
}

TEST(Report, BeginsWithWhatTheSceneSaysOfItself) {
  const Scratch scratch;
  Manifest run = some_run();
  run.heading = kHostile;
  run.description = "Forceps lift " + kHostile;
  const std::string page = report_of(scratch, run);
  for (const char* part :
       {"<h1>pull &amp; &lt;hold&gt;", "<p>Forceps lift pull &amp; &lt;hold&gt;", "pull: 6 of 6 steps"})
    EXPECT_TRUE(has(page, part));
  EXPECT_FALSE(has(page, "<hold>"));

  write_manifest(scratch / "run", run);
  const Manifest read = output::read_manifest(scratch / "run").value();
  EXPECT_EQ(read.heading, run.heading);
  EXPECT_EQ(read.description, run.description);
}

TEST(Report, SaysWhatTheRunWas) {
  const Scratch scratch;
  const std::string page = report_of(scratch);
  for (const char* part :
       {"hexaplast run &#39;it&#39;\\&#39;&#39;s.scn&#39;", "6 of 6 steps of 0.01 s. All steps done.", "250 Pa",
        "Where flow begins.", "+1.000 deg", "warning: slow", "Abacus, 4 hardware threads", "7.5 GiB",
        "0123456789abcdef", "fedcba9876543210", "EulerImplicitSolver, CGLinearSolver", "mixed", "AVX2"})
    EXPECT_TRUE(has(page, part));
  // it needs nothing from elsewhere
  for (const char* part : {"src=\"http", "href=", "url(", "@import"}) EXPECT_FALSE(has(page, part));
}

TEST(Report, HoldsEightPicturesOfManyTheLastAmongThem) {
  const Scratch scratch;
  fs::create_directories(scratch / "run/frames");
  for (int step = 1; step <= 21; ++step)
    put(scratch / "run/frames" / ("frame_" + std::string(step < 10 ? "0" : "") + std::to_string(step) + ".png"),
        "picture " + std::to_string(step));
  put(scratch / "run/frames/frame_x.png", "no picture of a run");
  const std::vector<std::string> images =
      pieces(report_of_table(scratch, "step,time\n0,0\n"), "src=\"data:image/png;base64,", "\"", false);
  ASSERT_EQ(images.size(), 8u);
  EXPECT_EQ(images.front(), "cGljdHVyZSAz");     // picture 3
  EXPECT_EQ(images.back(), "cGljdHVyZSAyMQ==");  // picture 21
}

// Of a bar that is only twisted, and one that is only stretched: 1e-14 degrees are rounding.
TEST(Report, LeavesOutChartsWithoutContent) {
  const Scratch scratch;
  const std::string head =
      "step,time,yielded,removed,current_elongation,plastic_elongation,current_twist_deg\n0,0,0,0,0,0,0\n";
  std::string page = report_of_table(scratch, head + "1,0.1,0,0,0,0,30\n2,0.2,0,0,0,0,60\n");
  EXPECT_EQ(chart_of(page, "twist").at("series")[0].at("curves")[0].at("values"), Json({0, 30, 60}));
  for (const char* absent : {"\"elongation\"", "\"yielded hexahedra\"", "\"removed hexahedra\""})
    EXPECT_FALSE(has(page, absent));

  page = report_of_table(scratch, head + "1,0.1,0,0,1e-4,0,1e-14\n2,0.2,0,3,2e-4,0,-2e-14\n");
  EXPECT_EQ(chart_of(page, "elongation").at("series")[0].at("steps"), Json({0, 1, 2}));
  EXPECT_EQ(chart_of(page, "removed hexahedra").at("series")[0].at("curves")[0].at("values"), Json({0, 0, 3}));
  EXPECT_FALSE(has(page, "\"twist\""));
}

TEST(Report, OfALongRunIsSmallAndKeepsItsPeaks) {
  const Scratch scratch;
  constexpr int kSteps = 50'000, kPeak = 23'457;
  std::string rows = "step,time,kinetic_energy,elastic_energy,dissipated_energy,plastic_elongation,step_ms\n";
  for (int step = 0; step <= kSteps; ++step) {
    const double swing = std::sin(0.37 * step);
    rows += std::to_string(step) + ',' + std::to_string(0.01 * step) + ',' + std::to_string(1 + swing) + ',' +
            std::to_string(2 - swing) + ',' + std::to_string(1e-3 * step) + ',' +
            (step == kPeak ? "0.75" : std::to_string(0.1 * swing)) + ',' + std::to_string(step % 100 + 1) + '\n';
  }
  const std::string page = report_of_table(scratch, rows);
  EXPECT_LT(page.size(), 1'000'000u);

  const Json series = chart_of(page, "elongation").at("series")[0];
  const std::vector<long> steps = series.at("steps");
  const std::vector<double> values = series.at("curves")[0].at("values");
  const auto peak = std::ranges::find(steps, kPeak);
  ASSERT_NE(peak, steps.end());
  EXPECT_EQ(values[static_cast<std::size_t>(peak - steps.begin())], 75);
  EXPECT_EQ(steps.front(), 0);
  EXPECT_EQ(steps.back(), kSteps);
  EXPECT_TRUE(std::ranges::is_sorted(steps));

  // 1 to 100 ms, each 500 times, the initial state left out
  for (const char* part : {"p50 50 ms", "p90 90 ms", "p99 99 ms", "The slowest step took 100 ms."})
    EXPECT_TRUE(has(page, part));
}

TEST(Report, OfARunThatFailedShowsWhatWasFinite) {
  const Scratch scratch;
  const std::string page =
      report_of_table(scratch, "step,time,end_displacement,current_elongation\n0,0,0,0\n1,1,2,3\n2,2,inf,4\n");
  EXPECT_EQ(chart_of(page, "displacement of loaded nodes").at("series")[0].at("steps"), Json({0, 1}));
  EXPECT_EQ(chart_of(page, "elongation").at("series")[0].at("steps"), Json({0, 1, 2}));
}

TEST(Report, ShowsTheWorkOfRecoveryAndChangesWhereThereIsAny) {
  const Scratch scratch;
  const auto balance = [&](const std::string& rows) {
    const std::string head = "step,time,load_work,support_work,recovery_work,change_work\n";
    return chart_of(report_of_table(scratch, head + rows), "energy balance").at("series")[0].at("curves");
  };
  EXPECT_EQ(balance("0,0,0,0,0,0\n1,1,2,1,0,0\n").size(), 1u);
  const Json curves = balance("0,0,0,0,0,0\n1,1,2,1,0.25,0\n2,2,2,1,0,4\n");
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_EQ(curves[0].at("values"), Json({0, 3, 3}));
  EXPECT_EQ(curves[1].at("name"), "recovery and changes");
  EXPECT_EQ(curves[1].at("values"), Json({0, 0.25, 4}));
}

TEST(HistoryTable, IsRefusedWhereItIsNone) {
  const Scratch scratch;
  const std::string file = (scratch / "history.csv").string();
  const auto refusal = [&](const std::string& text) {
    put(file, text);
    const std::string error = error_of<OutputError>([&] {
      output::HistoryTable table(file);
      while (!table.next().empty()) continue;
    });
    return error.substr(std::min(error.size(), file.size()));
  };
  EXPECT_EQ(refusal("step,time,a\n0,0,1\n1,0.5,-2e3\n"), "");
  EXPECT_EQ(refusal("step,time,a\n0,0,1\n1,0.5"), "");  // what a killed run may leave
  EXPECT_EQ(refusal(""), ":1: is no history of a run: must begin with step,time");
  EXPECT_EQ(refusal("time,step\n"), ":1: is no history of a run: must begin with step,time");
  EXPECT_EQ(refusal("step,time,a\n0,0,1\n1,0.5\n"), ":3: 2 numbers, must be 3");
  EXPECT_EQ(refusal("step,time,a\n0,0,1x\n"), ":2: a: '1x', must be a number");
  EXPECT_THROW(output::HistoryTable(scratch / "absent.csv"), OutputError);
  EXPECT_THROW(output::HistoryTable(scratch / "."), OutputError);
}

TEST(ManifestFile, ComesBackAsItWas) {
  const Scratch scratch;
  fs::create_directories(scratch / "run");
  EXPECT_FALSE(output::read_manifest(scratch / "run"));
  Manifest run = some_run();
  run.title = kHostile;
  run.state = output::RunState::kInterrupted;
  write_manifest(scratch / "run", run);
  const Json written = Json::parse(content(scratch / "run/manifest.json"));
  EXPECT_EQ(written.at("scene").at("name"), kHostile);
  EXPECT_EQ(written.at("state"), "interrupted");
  EXPECT_EQ(written.at("components")[0].at("attributes").at("yieldStress"), "250");

  const std::optional<Manifest> read = output::read_manifest(scratch / "run");
  ASSERT_TRUE(read);
  write_manifest(scratch / "run", *read);
  EXPECT_EQ(Json::parse(content(scratch / "run/manifest.json")), written);
}

TEST(ManifestFile, OfAnotherKindIsRefused) {
  const Scratch scratch;
  fs::create_directories(scratch / "run");
  for (const char* text : {"", "{", "[]", "{}", R"({"version": 1})"}) {
    put(scratch / "run/manifest.json", text);
    EXPECT_THROW(output::read_manifest(scratch / "run"), OutputError) << text;
  }

  // numbers that no counter holds
  write_manifest(scratch / "run", some_run());
  const Json whole = Json::parse(content(scratch / "run/manifest.json"));
  for (const char* place : {"/threads", "/machine/cores", "/machine/memory_bytes", "/steps/asked", "/steps/done"})
    for (const Json& number : {Json(1e300), Json(-1), Json(0.5), Json(18446744073709551615u), Json("1")}) {
      Json other = whole;
      other[Json::json_pointer(place)] = number;
      put(scratch / "run/manifest.json", other.dump());
      EXPECT_THROW(output::read_manifest(scratch / "run"), OutputError) << place << " " << number;
    }
}

}  // namespace
}  // namespace hexaplast
