#include "exam/exam.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/text_file.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

const char* const kWhole = R"({
  "fathom_exam": 1,
  "recordings": ["first.mha", "raw/second.mhd"],
  "calibration": "probe.json",
  "sweeps": [{"recording": 0, "first": 2, "last": 9, "label": "left lobe"},
             {"recording": 1, "first": 0, "last": 4},
             {"recording": 0, "first": 10, "last": 12}],
  "dividing_planes": [{"normal": [0.6, 0.8, 0.0], "offset_mm": 12.5, "drawn_by": "hand"}],
  "structures": "contours.json",
  "results": {"structures": []},
  "patient": "P-17", "operator": "A. Example", "date": "2026-01-31", "notes": "full bladder",
  "another_program": {"kept": [1, 2.5, null, "\u00e9"]}
})";

class ExamFile : public ::testing::Test {
 protected:
  std::filesystem::path with(const std::string& text) {
    write_text_file(folder_ / "exam.json", text);
    return root();
  }

  std::filesystem::path changed(const std::string& from, const std::string& to) {
    std::string text = kWhole;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return with(text.replace(at, from.size(), to));
  }

  std::filesystem::path root() const { return (folder_ / "exam.json").parent_path(); }

  ScratchFolder folder_;
};

TEST_F(ExamFile, HoldsWhatTheInterfaceSays) {
  const Exam exam = read_exam(with(kWhole));
  EXPECT_EQ(exam.recordings, (std::vector<std::string>{"first.mha", "raw/second.mhd"}));
  EXPECT_EQ(exam.calibration, "probe.json");
  EXPECT_EQ(exam.structures, "contours.json");
  ASSERT_EQ(exam.sweeps.size(), 3u);
  EXPECT_EQ(exam.sweeps[1], (Sweep{1, 0, 4}));
  ASSERT_EQ(exam.dividing_planes.size(), 1u);
  EXPECT_NEAR(exam.dividing_planes[0].signedDistance({7.5, 10.0, 3.0}), 0.0, 1e-12) << "normal . x = offset";
  EXPECT_EQ(exam.patient, "P-17");
  EXPECT_EQ(exam.operator_name, "A. Example");
  EXPECT_EQ(exam.date, "2026-01-31");
  EXPECT_EQ(exam.notes, "full bladder");
  EXPECT_EQ(read_exam(folder_ / "exam.json").recordings, exam.recordings) << "the file may be named as well";
}

TEST_F(ExamFile, ReadsBackAsItWasAndKeepsWhatOtherProgramsAdded) {
  Exam exam = read_exam(with(kWhole));
  exam.notes += ", twice";
  exam.sweeps[1].last = 3;
  exam.dividing_planes.emplace_back(Eigen::Vector3d(1, 2, 3).normalized(), -1.0 / 3.0);
  write_exam(exam);
  const Exam again = read_exam(root());
  EXPECT_EQ(again.recordings, exam.recordings);
  EXPECT_EQ(again.sweeps, exam.sweeps);
  EXPECT_EQ(again.notes, "full bladder, twice");
  ASSERT_EQ(again.dividing_planes.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_LT((again.dividing_planes[k].coeffs() - exam.dividing_planes[k].coeffs()).norm(), 1e-15);
  }
  EXPECT_EQ(again.document["another_program"], exam.document["another_program"]);
  EXPECT_EQ(again.document["sweeps"][0]["label"], "left lobe");
  EXPECT_EQ(again.document["dividing_planes"][0]["drawn_by"], "hand");
  EXPECT_EQ(again.document["results"], exam.document["results"]);

  // Written again it is the same to the byte.
  const std::string text = read_text_file(folder_ / "exam.json", 1 << 20);
  EXPECT_EQ(exam_text(again), text);
}

TEST_F(ExamFile, NeedsNoMoreThanARecording) {
  const Exam exam = read_exam(with(R"({"fathom_exam": 1, "recordings": ["a.mha"], "calibration": null})"));
  EXPECT_TRUE(exam.calibration.empty());
  EXPECT_TRUE(exam.sweeps.empty());
  write_exam(exam);
  EXPECT_TRUE(read_exam(root()).document["calibration"].is_null()) << "a null stays one";
}

TEST_F(ExamFile, RefusesWhatIsDamaged) {
  const std::pair<const char*, const char*> damages[] = {
      {"\"fathom_exam\": 1,", ""},
      {"\"fathom_exam\": 1,", "\"fathom_exam\": 2,"},
      {"\"recordings\": [\"first.mha\", \"raw/second.mhd\"]", "\"recordings\": []"},
      {"\"recordings\": [\"first.mha\", \"raw/second.mhd\"]", "\"recordings\": \"first.mha\""},
      {"\"raw/second.mhd\"", "7"},
      {"\"raw/second.mhd\"", "\"\""},
      {"\"raw/second.mhd\"", "\".\""},
      {"\"raw/second.mhd\"", "\"first.mha\""},
      {"\"raw/second.mhd\"", "\"../second.mhd\""},
      {"\"raw/second.mhd\"", "\"raw/../../second.mhd\""},
      {"\"raw/second.mhd\"", "\"/second.mhd\""},
      {"\"raw/second.mhd\"", "\"second\\u0000.mhd\""},
      {"probe.json", "../probe.json"},
      {"contours.json", "/contours.json"},
      {"\"contours.json\"", "{}"},
      {"\"recording\": 1,", "\"recording\": 2,"},
      {"\"recording\": 1,", "\"recording\": -1,"},
      {"\"first\": 2,", "\"first\": 10,"},
      {"\"first\": 2,", "\"first\": -2,"},
      {"\"first\": 2,", "\"first\": 2.5,"},
      {"\"first\": 10,", "\"first\": 9,"},
      {"\"last\": 12", "\"last\": 1e300"},
      {"[0.6, 0.8, 0.0]", "[0.6, 0.8]"},
      {"[0.6, 0.8, 0.0]", "[0, 0, 0]"},
      {"[0.6, 0.8, 0.0]", "[0.7, 0.8, 0]"},
      {"[0.6, 0.8, 0.0]", "[0.6, 0.8, \"0\"]"},
      {"\"offset_mm\": 12.5,", ""},
      {"\"offset_mm\": 12.5", "\"offset_mm\": 1e300"},
      {"\"P-17\"", "17"},
  };
  for (const auto& [from, to] : damages) EXPECT_THROW(read_exam(changed(from, to)), Error) << from << " -> " << to;
  std::string many;
  for (int i = 0; i < 33; ++i) many += R"(, {"normal": [1, 0, 0], "offset_mm": )" + std::to_string(i) + "}";
  EXPECT_THROW(read_exam(changed("\"drawn_by\": \"hand\"}", "\"drawn_by\": \"hand\"}" + many)), Error);
}

TEST_F(ExamFile, FollowsNoLinkOutOfItsFolder) {
  const ScratchFolder elsewhere;
  write_text_file(elsewhere / "secret.mha", "x");
  std::filesystem::create_symlink((elsewhere / "x").parent_path(), folder_ / "raw");
  EXPECT_THROW(read_exam(with(kWhole)), Error);
  std::filesystem::remove(folder_ / "raw");
  std::filesystem::create_symlink(elsewhere / "secret.mha", folder_ / "first.mha");
  EXPECT_THROW(read_exam(with(kWhole)), Error);
  std::filesystem::remove(folder_ / "first.mha");
  std::filesystem::create_symlink("first.mha", folder_ / "first.mha");
  EXPECT_THROW(read_exam(with(kWhole)), Error) << "a link to itself";
  std::filesystem::remove(folder_ / "first.mha");

  // A link that stays inside is as good as a file.
  write_text_file(folder_ / "stored.mha", "x");
  std::filesystem::create_symlink("stored.mha", folder_ / "first.mha");
  const Exam exam = read_exam(with(kWhole));
  EXPECT_EQ(file_of(exam, "first.mha"), folder_ / "first.mha");
  EXPECT_THROW(file_of(exam, "raw/second.mhd"), Error) << "it is missing";
}

}  // namespace
}  // namespace fathom
