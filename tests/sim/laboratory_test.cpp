#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "core/text_file.h"
#include "sim/laboratory/laboratory_folder.h"
#include "sim/laboratory/study_run.h"
#include "sim/laboratory/table_text.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kVersion = "1.2.3";

/// Every case gives numbers that depend on its seed only; one may be told to fail.
class NumbersStudy final : public Study {
 public:
  std::string name() const override { return "numbers"; }
  std::string title() const override { return "numbers"; }
  int cases(const StudyOptions& options) const override { return 2 * options.samples; }
  std::string case_name(const StudyOptions&, int index) const override { return "number " + std::to_string(index); }
  Json run_case(const StudyOptions& options, int index) const override {
    ++begun;
    if (index >= fails_from) throw Error("no number; try another");
    Random random(case_seed(options, index));
    return {{"x", random.uniform()}, {"a", index}, {"nan", std::numeric_limits<double>::quiet_NaN()}};
  }
  Json rows(const StudyOptions&, const std::vector<Json>& results) const override { return results; }
  StudyReport report(const StudyOptions&, const std::vector<Json>&) const override { return {}; }

  mutable std::atomic<int> begun = 0;
  int fails_from = 1000;
};

StudyRun run_of(int threads, Shard shard = {}) { return {kVersion, "b1", {10, 7}, shard, threads}; }

std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(StudyRun, GivesTheSameBytesWithAnyNumberOfThreads) {
  const NumbersStudy study;
  const std::string text = results_text(run_study(study, run_of(1)));
  EXPECT_EQ(results_text(run_study(study, run_of(4))), text);
  EXPECT_EQ(results_text(run_study(study, run_of(64))), text);
  EXPECT_EQ(study.begun, 3 * 20);
}

TEST(StudyRun, ShardsJoinToTheBytesOfOneRun) {
  const NumbersStudy study;
  for (const int count : {1, 2, 3, 7, 30}) {
    std::vector<StudyResults> parts;
    for (int i = count - 1; i >= 0; --i) parts.push_back(run_study(study, run_of(2, {i, count})));
    EXPECT_EQ(results_text(merged(parts)), results_text(run_study(study, run_of(1)))) << count;
  }
}

TEST(StudyRun, CasesOfAnotherSeedAreOthers) {
  const NumbersStudy study;
  StudyRun other = run_of(1);
  other.options.seed = 8;
  const StudyResults one = run_study(study, run_of(1));
  const StudyResults two = run_study(study, other);
  std::set<double> numbers;
  for (const StudyResults* results : {&one, &two}) {
    for (const auto& [index, value] : results->values) numbers.insert(value.at("x").get<double>());
  }
  EXPECT_EQ(numbers.size(), 40u);
}

TEST(StudyRun, NamesTheFirstCaseThatFails) {
  NumbersStudy study;
  study.fails_from = 5;
  for (const int threads : {1, 4}) {
    EXPECT_EQ(message_of([&] { run_study(study, run_of(threads)); }),
              "study numbers, number 5: no number; try another");
  }
  EXPECT_LT(study.begun, 20) << "the others need not be run";
}

TEST(StudyRun, StopsWhenAsked) {
  const NumbersStudy study;
  EXPECT_THROW(run_study(study, run_of(1), [](double) { return false; }), Cancelled);
}

TEST(StudyRun, RefusesWhatIsOutOfRange) {
  const NumbersStudy study;
  for (const StudyRun& run :
       {run_of(0), run_of(1, {3, 3}), run_of(1, {-1, 3}), run_of(1, {0, 0}), StudyRun{kVersion, "", {0, 1}, {}, 1},
        StudyRun{kVersion, "", {kMostSamples + 1, 1}, {}, 1}}) {
    EXPECT_THROW(run_study(study, run), Error);
  }
}

TEST(Shard, IsTwoWholeNumbersTheFirstBelowTheSecond) {
  const Shard shard = parse_shard("2/3");
  EXPECT_EQ(shard.index, 2);
  EXPECT_EQ(shard.count, 3);
  for (const char* text : {"", "/", "1", "1/", "/2", "3/3", "4/3", "-1/3", "0/0", "0/3/4", "0.5/3", "a/b", " 0/3",
                           "0/3 ", "0/99999999999", "0/-3", "+0/3"}) {
    EXPECT_THROW(parse_shard(text), Error) << text;
  }
}

// Parts of a study are merged from files of the studies that there are; "truth" is not run here, only named.
StudyResults part_of_truth(int index, int count, int cases = 6) {
  StudyResults part;
  part.version = kVersion;
  part.build = "b1";
  part.study = "truth";
  part.cases = cases;
  part.shard = {index, count};
  for (int i = index; i < cases; i += count) part.values[i] = {{"counted_ml", i}, {"true_ml", 1.5}};
  return part;
}

TEST(MergedResults, RefusesPartsThatDoNotGoTogether) {
  const StudyResults first = part_of_truth(0, 3);
  const auto refused = [&](const std::vector<StudyResults>& parts, const std::string& why) {
    EXPECT_NE(message_of([&] { merged(parts); }).find(why), std::string::npos)
        << why << ": " << message_of([&] { merged(parts); });
  };
  const StudyResults second = part_of_truth(1, 3);
  const StudyResults third = part_of_truth(2, 3);
  EXPECT_EQ(message_of([&] { merged({first, second, third}); }), "");
  refused({first, third}, "shards 1/3 of study truth are missing");
  refused({first, second, third, second}, "case 1 of study truth is in truth.shard-1-of-3.json too");
  refused({first, part_of_truth(1, 2), third}, "case 3");
  refused({first, part_of_truth(1, 4)}, "cases 2, 4 of study truth are missing");
  StudyResults other = second;
  other.version = "1.2.4";
  refused({first, other, third}, "version 1.2.4, but truth.shard-0-of-3.json is of version 1.2.3");
  other = second;
  other.build = "b2";
  refused({first, other, third}, "build b2, but");
  other = second;
  other.options.seed = 2;
  refused({first, other, third}, "seed 2");
  other = second;
  other.options.samples = 21;
  refused({first, other, third}, "samples 21");
  other = second;
  other.study = "2.1";
  refused({first, other, third}, "study 2.1");
  refused({first, part_of_truth(1, 3, 7), third}, "cases 7");
}

TEST(ResultsFile, ReadsBackAsItWasWritten) {
  const ScratchFolder scratch;
  StudyResults part = part_of_truth(1, 3);
  part.options.seed = 18446744073709551615u;
  const auto file = scratch / results_file_name(part);
  write_text_file(file, results_text(part));
  const StudyResults read = read_results(file);
  EXPECT_EQ(results_text(read), results_text(part));
  EXPECT_EQ(read.options.seed, part.options.seed);
}

TEST(ResultsFile, IsReadAsHostileInput) {
  const ScratchFolder scratch;
  const auto file = scratch / "damaged.json";
  const std::string good = results_text(part_of_truth(1, 3));
  const auto read_with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    write_text_file(file, text);
    return message_of([&] { read_results(file); });
  };
  EXPECT_EQ(read_with("1.2.3", "1.2.3"), "");
  const std::vector<std::pair<std::string, std::string>> damages = {
      {"\"fathom_accuracy\": 1", "\"fathom_accuracy\": 2"},
      {"fathom_accuracy", "fathom_contours"},
      {"\"1.2.3\"", "123"},
      {"\"b1\"", "null"},
      {"\"truth\"", "\"banana\""},
      {"\"truth\"", "[]"},
      {"\"samples\": 20", "\"samples\": 0"},
      {"\"samples\": 20", "\"samples\": 1e99"},
      {"\"seed\": 1", "\"seed\": -1"},
      {"\"seed\": 1", "\"seed\": 1.5"},
      {"\"cases\": 6", "\"cases\": -6"},
      {"\"cases\": 6", "\"cases\": 1e300"},
      {"\"cases\": 6", "\"cases\": 4"},
      {"\"cases\": 6", "\"cases\": 9"},
      {"  3\n", "  0\n"},
      {"  1,\n  3", "  3,\n  3"},
      {"  1,\n  3", "  0,\n  3"},
      {"  1,\n  3", "  1"},
      {"\"case\":4", "\"case\":1"},
      {"\"case\":4", "\"case\":5"},
      {"\"case\":4", "\"case\":-2"},
      {"\"case\":4", "\"case\":\"4\""},
      {"\"value\":", "\"valeu\":"},
      {"\"results\": [", "\"results\": 7, \"x\": ["},
      {"]\n}\n", "]\n"},
  };
  for (const auto& [from, to] : damages) {
    const std::string message = read_with(from, to);
    EXPECT_NE(message.find("damaged.json"), std::string::npos) << from << " -> " << to << ": " << message;
    EXPECT_NE(message.find("; "), std::string::npos) << message;
  }
}

TEST(LaboratoryFolder, RefusesValuesThatAreNotTheStudys) {
  StudyResults results = part_of_truth(0, 1, study_of("truth").cases({}));
  for (auto& [index, value] : results.values) value["object"] = "sphere";
  EXPECT_EQ(study_rows(results).size(), results.values.size());
  const std::vector<Json> hostile = {{}, 7, "x", Json::array(), {{"true_ml", "much"}, {"counted_ml", 1}}, nullptr};
  for (const Json& value : hostile) {
    results.values[0] = value;
    EXPECT_THROW(study_rows(results), Error) << value;
    EXPECT_THROW(study_report(results), Error) << value;
  }
}

TEST(LaboratoryFolder, RefusesResultsOfAnotherProgram) {
  StudyResults results = part_of_truth(0, 1, study_of("truth").cases({}));
  EXPECT_NO_THROW(require_current(results, kVersion));
  EXPECT_THROW(require_current(results, "1.2.4"), Error);
  results.cases += 1;
  EXPECT_THROW(require_current(results, kVersion), Error);
}

TEST(LaboratoryFolder, HoldsTablesAndAPageThatNeedsNoOtherFile) {
  const ScratchFolder scratch;
  StudyResults results = part_of_truth(0, 1, study_of("truth").cases({}));
  for (auto& [index, value] : results.values) value["object"] = "<b>, \"sphere\" | " + std::to_string(index);
  LaboratoryFolder(scratch / "out", kVersion).write({results});
  const auto text_of = [&](const char* name) { return read_text_file(scratch / "out" / name, 1u << 24); };
  EXPECT_EQ(text_of("truth.json"), results_text(results));
  const std::string csv = text_of("truth.volumes.csv");
  EXPECT_NE(csv.find("\r\n\"<b>, \"\"sphere\"\" | 3\",1.5000,3.0000,100.0000\r\n"), std::string::npos) << csv;
  EXPECT_NE(text_of("truth.volumes.txt").find("<b>, \"sphere\" \\| 3"), std::string::npos);
  const std::string page = text_of("index.html");
  EXPECT_NE(page.find("&lt;b&gt;, &quot;sphere&quot; | 3"), std::string::npos);
  EXPECT_NE(page.find("not met"), std::string::npos);
  EXPECT_EQ(page.find("<b>"), std::string::npos);
  EXPECT_EQ(page.find("src=\"h"), std::string::npos);
  EXPECT_NE(page.find("Fathom 1.2.3, 14 cases, samples 20, seed 1, build b1"), std::string::npos);
}

TEST(StudySeeds, AreUnlikeEachOther) {
  std::set<std::uint64_t> seeds;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (int i = 0; i < 500; ++i) seeds.insert(case_seed({20, seed}, i));
  }
  EXPECT_EQ(seeds.size(), 10000u);
}

TEST(Studies, HaveNamesOfTheirOwnAndCases) {
  std::set<std::string> names;
  for (const Study* study : all_studies()) {
    names.insert(study->name());
    EXPECT_EQ(study->name().find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789.-"), std::string::npos);
    EXPECT_EQ(&study_of(study->name()), study);
    const int cases = study->cases({});
    ASSERT_GT(cases, 0) << study->name();
    EXPECT_FALSE(study->case_name({}, 0).empty());
    EXPECT_FALSE(study->case_name({}, cases - 1).empty());
  }
  EXPECT_EQ(names.size(), all_studies().size());
  EXPECT_NE(message_of([] { study_of("2.2"); }).find("2.1, 2.13, 2.14"), std::string::npos);
}

}  // namespace
}  // namespace fathom
