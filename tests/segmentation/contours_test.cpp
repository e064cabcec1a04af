#include "segmentation/contours.h"

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "core/random.h"
#include "core/text_file.h"

namespace fathom {
namespace {

namespace fs = std::filesystem;

class Contours : public testing::Test {
 protected:
  Contours() { fs::create_directories(folder_); }
  ~Contours() override { fs::remove_all(folder_); }

  fs::path file(const std::string& text) {
    const fs::path path = folder_ / "contours.json";
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  // What reading `text` complains about; empty where it does not.
  std::string complaint(const std::string& text) {
    const fs::path path = file(text);
    try {
      read_contours(path);
      return {};
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.rfind(path.string() + ": ", 0), 0u) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      return message;
    }
  }

  // A file with one structure whose list of contours is `contours`.
  static std::string with(const std::string& contours) {
    return R"({"fathom_contours": 1, "structures": [{"name": "bladder", "contours": [)" + contours + "]}]}";
  }

  fs::path folder_ = fs::temp_directory_path() /
                     ("fathom_contours_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) +
                      std::to_string(getpid()));
};

TEST_F(Contours, ReadBackAsTheyWereWrittenToTheLastBit) {
  Random random(3);
  std::vector<Structure> structures(2);
  structures[0].name = "Blase \"ü\" \\";
  structures[0].color = "#A0b1c2";
  for (int frame : {12, 3, 3, 40}) {
    Contour contour;
    contour.frame = frame;
    contour.closed = frame != 40;
    if (frame == 12) contour.confidence = 0.1 + 0.2;
    for (int i = 0; i < 50; ++i) contour.points_px.emplace_back(random.uniform(-9.0, 800.0), random.normal() * 1e-7);
    structures[0].contours.push_back(contour);
  }
  structures[0].contours[3].recording = 2;
  structures[0].absent = {{50, 0}, {7, 1}};
  structures[0].extremities = {{1, {0.1, 1e6}, 0}};
  structures[1].name = "tumour";
  structures[1].opacity = 0.1 + 0.2;

  const std::vector<Structure> read = read_contours(file(contours_json(structures)));

  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].name, structures[0].name);
  EXPECT_EQ(read[0].color, "#A0b1c2");
  EXPECT_EQ(read[1].name, "tumour");
  EXPECT_EQ(read[1].color, Structure().color);
  EXPECT_EQ(read[0].opacity, kUsualOpacity);
  EXPECT_EQ(read[1].opacity, 0.1 + 0.2);
  ASSERT_EQ(read[0].contours.size(), 4u);
  const std::size_t order[] = {1, 2, 0, 3};  // by recording and frame, and as they stood
  for (std::size_t i = 0; i < 4; ++i) {
    const Contour& expected = structures[0].contours[order[i]];
    EXPECT_EQ(read[0].contours[i].frame, expected.frame);
    EXPECT_EQ(read[0].contours[i].recording, expected.recording);
    EXPECT_EQ(read[0].contours[i].closed, expected.closed);
    EXPECT_EQ(read[0].contours[i].confidence, expected.confidence);
    EXPECT_EQ(read[0].contours[i].points_px, expected.points_px);
  }
  ASSERT_EQ(read[0].absent.size(), 2u);
  EXPECT_EQ(read[0].absent[0].frame, 50);
  EXPECT_EQ(read[0].absent[1].recording, 1);
  ASSERT_EQ(read[0].extremities.size(), 1u);
  EXPECT_EQ(read[0].extremities[0].point_px, Eigen::Vector2d(0.1, 1e6));
}

TEST_F(Contours, PassOverKeysThatLaterVersionsMayAdd) {
  const auto read = read_contours(file(R"({"fathom_contours": 1, "by": {"a": [1]}, "structures": [{"name": "a", "x": 1,
      "contours": [{"frame": 2, "points": [[0, 0], [1, 0], [0, 1]], "tool": "pen"}]}]})"));
  ASSERT_EQ(read.size(), 1u);
  ASSERT_EQ(read[0].contours.size(), 1u);
  EXPECT_TRUE(read[0].contours[0].closed);
  EXPECT_FALSE(read[0].contours[0].confidence);
}

TEST_F(Contours, RefuseWhatIsNoContoursFile) {
  for (const char* text :
       {"", "[]", "{}", "null", "{\"fathom_contours\": 1}", "{\"fathom_contours\": 2}",
        "{\"fathom_contours\": \"1\", \"structures\": []}", "{\"fathom_contours\": 1,",
        "{\"fathom_contours\": 1, \"structures\": {}}", "{\"fathom_contours\": 1, \"structures\": [1]}",
        "{\"fathom_contours\": 1, \"structures\": [{\"name\": \"a\"}]}", "\x80\x81\xff"}) {
    EXPECT_NE(complaint(text), "") << text;
  }
  EXPECT_THROW(read_contours(folder_), Error);
  EXPECT_THROW(read_contours(folder_ / "missing.json"), Error);
}

TEST_F(Contours, RefuseDamagedEntriesAndSayWhere) {
  const std::string triangle = R"("points": [[0, 0], [1, 0], [0, 1]])";
  EXPECT_EQ(complaint(with(R"({"frame": 0, )" + triangle + "}")), "");
  const std::vector<std::string> damaged = {"{\"frame\": 0}",
                                            "{" + triangle + "}",
                                            "{\"frame\": -1, " + triangle + "}",
                                            "{\"frame\": 1.5, " + triangle + "}",
                                            "{\"frame\": \"1\", " + triangle + "}",
                                            "{\"frame\": 99999999999, " + triangle + "}",
                                            "{\"frame\": 0, \"closed\": 1, " + triangle + "}",
                                            "{\"frame\": 0, \"recording\": -1, " + triangle + "}",
                                            "{\"frame\": 0, \"confidence\": 1.5, " + triangle + "}",
                                            "{\"frame\": 0, \"absent\": true, " + triangle + "}",
                                            "{\"frame\": 0, \"absent\": 1}",
                                            "{\"frame\": 0, \"absent\": false}",
                                            "{\"frame\": 0, \"point\": [1]}",
                                            "{\"frame\": 0, \"point\": [1, null]}",
                                            "{\"frame\": 0, \"points\": [[0, 0], [1, 0]]}",
                                            "{\"frame\": 0, \"points\": [[0, 0], [1, 0], [0, 1, 2]]}",
                                            "{\"frame\": 0, \"points\": [[0, 0], [1, 0], [0, 1e400]]}",
                                            "{\"frame\": 0, \"points\": [[0, 0], [1, 0], [0, 1.1e6]]}",
                                            "{\"frame\": 0, \"points\": [[0, 0], [1, 0], [0, NaN]]}",
                                            "{\"frame\": 0, \"points\": [[0, 0], [1, 0], [0, \"1\"]]}",
                                            "7"};
  for (const std::string& entry : damaged) {
    EXPECT_NE(complaint(with(entry)), "") << entry;
  }
  EXPECT_NE(complaint(with(R"({"frame": 0, "points": [[0, 0], [1, 0], [0, "x"]]})"))
                .find("structures[0].contours[0].points[2][1]: must be a number"),
            std::string::npos);
}

TEST_F(Contours, RefuseAFrameThatIsOutlinedAndAbsentOrAnExtremity) {
  const std::string outline = R"({"frame": 5, "points": [[0, 0], [1, 0], [0, 1]]})";
  EXPECT_EQ(complaint(with(outline + "," + outline)), "");
  EXPECT_NE(complaint(with(outline + R"(, {"frame": 5, "absent": true})")), "");
  EXPECT_NE(complaint(with(outline + R"(, {"frame": 5, "point": [1, 2]})")), "");
  EXPECT_NE(complaint(with(R"({"frame": 5, "point": [1, 2]}, {"frame": 5, "point": [1, 2]})")), "");
  EXPECT_NE(complaint(with(R"({"frame": 5, "point": [1, 2]}, {"frame": 5, "absent": true})")), "");
  EXPECT_EQ(complaint(with(outline + R"(, {"frame": 5, "recording": 1, "absent": true})")), "");
}

TEST_F(Contours, RefuseNamesAndColoursThatCannotBeShown) {
  const auto structure = [](const std::string& members) {
    return "{\"fathom_contours\": 1, \"structures\": [{\"contours\": [], " + members + "}]}";
  };
  EXPECT_EQ(complaint(structure(R"("name": "a", "color": "#00FFaa")")), "");
  for (const char* members :
       {R"("name": "")", R"("name": 1)", R"("name": "a\nb")", R"("name": "a\u009b1m")",
        R"("name": "a", "color": "red")", R"("name": "a", "color": "#12345")", R"("name": "a", "color": "#12345g")",
        R"("name": "a", "opacity": 1.5)", R"("name": "a", "opacity": -0.1)", R"("name": "a", "opacity": "half")"}) {
    EXPECT_NE(complaint(structure(members)), "") << members;
  }
  EXPECT_NE(complaint(structure("\"name\": \"" + std::string(1000, 'a') + "\"")), "");
  EXPECT_NE(complaint(R"({"fathom_contours": 1, "structures": [{"name": "a", "contours": []},
                          {"name": "a", "contours": []}]})"),
            "");
}

TEST_F(Contours, RefuseRubbishThatWouldParseIntoGigabytes) {
  EXPECT_NE(complaint(std::string(20'000'000, '[')).find("nests deeper"), std::string::npos);
  std::string many = "{\"fathom_contours\": 1, \"structures\": [0";
  for (int i = 0; i < 7'000'000; ++i) many += ",0";
  EXPECT_NE(complaint(many + "]}").find("million values"), std::string::npos);
  // Brackets and commas in texts are no values.
  EXPECT_EQ(complaint(R"({"fathom_contours": 1, "structures": [], "note": "\"[[[[)" + std::string(100, '[') + "\"}"),
            "");
}

TEST_F(Contours, OnFramesThatTheRecordingDoesNotHaveAreAnError) {
  auto structures = read_contours(file(with(R"({"frame": 9, "points": [[0, 0], [1, 0], [0, 1]]})")));
  EXPECT_NO_THROW(require_measurable(structures, 10, "c.json"));
  EXPECT_THROW(require_measurable(structures, 9, "c.json"), Error);
  structures[0].extremities.push_back({10, {0.0, 0.0}, 0});
  EXPECT_THROW(require_measurable(structures, 10, "c.json"), Error);
  structures[0].extremities.clear();
  structures[0].absent.push_back({10, 0});
  EXPECT_THROW(require_measurable(structures, 10, "c.json"), Error);
}

TEST_F(Contours, ThatAreOpenOrOfAnotherRecordingAreAnErrorThatNamesTheirFile) {
  const auto complaint_about = [&](const char* entry) -> std::string {
    try {
      require_measurable(read_contours(file(with(entry))), 10, "c.json");
      return {};
    } catch (const Error& error) {
      return error.what();
    }
  };
  EXPECT_EQ(complaint_about(R"({"frame": 9, "closed": false, "points": [[0, 0], [1, 0], [0, 1]]})")
                .rfind("c.json: structure bladder: frame 9 has an open contour", 0),
            0u);
  EXPECT_EQ(complaint_about(R"({"frame": 9, "recording": 2, "point": [0, 0]})")
                .rfind("c.json: structure bladder: frame 9 stands on recording 2", 0),
            0u);
}

TEST_F(Contours, FarOutsideOfTheImageAreAWarningThatNamesTheFrames) {
  auto structures = read_contours(file(with(R"({"frame": 9, "points": [[-10, 0], [110, 0], [0, 60]]})")));
  EXPECT_FALSE(outside_image_warning(structures[0], 100, 50));
  structures[0].contours[0].points_px[1].x() = 126.0;
  const auto warning = outside_image_warning(structures[0], 100, 50);
  ASSERT_TRUE(warning);
  EXPECT_NE(warning->find("frame 9"), std::string::npos);
}

}  // namespace
}  // namespace fathom
