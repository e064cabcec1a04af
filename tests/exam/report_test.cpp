#include <sstream>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/html.h"
#include "core/text_file.h"
#include "exam/exam_report.h"
#include "exam/export_exam.h"
#include "exam/make_exam.h"
#include "exam/results_export.h"
#include "tests/exam/scan.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

// White letters in a corner, as scanners burn them in, on every image; the organ's part is grey.
MemoryRecording labelled_recording() {
  const MemoryRecording box = box_recording();
  RecordingHeader header = box.header();
  header.fields.emplace_back("PatientName", "Secret Smith");
  header.frames[2].fields.emplace_back("Comment", "Smith, left");
  std::vector<cv::Mat> images;
  for (int i = 0; i < header.frame_count(); ++i) {
    images.emplace_back(100, 200, CV_8UC1, cv::Scalar(90));
    images.back()(cv::Rect(0, 0, 40, 10)).setTo(255);
  }
  return MemoryRecording("smith.mha", std::move(header), std::move(images));
}

class Report : public ::testing::Test {
 protected:
  Report() {
    write_recording(labelled_recording(), folder_ / "smith.mha");
    write_text_file(folder_ / "probe.json", calibration_json(box_calibration()));
    write_text_file(folder_ / "contours.json", contours_json({box_structure()}));
    ExamParts parts;
    parts.recordings = {folder_ / "smith.mha"};
    parts.calibration = folder_ / "probe.json";
    parts.contours = folder_ / "contours.json";
    parts.patient = "Smith & <script>alert(1)</script>";
    parts.operator_name = "Operator Jones";
    parts.date = "2026-01-31";
    parts.notes = "Smith's notes";
    create_exam(folder_ / "smith-exam", parts);
  }

  DocumentSnapshot snapshot() const {
    DocumentOptions options;
    options.autosave = false;
    return Document(folder_ / "smith-exam", options).snapshot();
  }

  static ReportOptions anonymous() {
    ReportOptions options;
    options.program = "Fathom test";
    options.anonymous = true;
    options.area = SafeArea{{0, 20, 200, 80}, {}};
    return options;
  }

  // Without pictures, whose letters may spell anything.
  static std::string words(std::string html) {
    for (std::size_t at = html.find("base64,"); at != std::string::npos; at = html.find("base64,", at + 1)) {
      html.erase(at + 7, html.find('"', at) - at - 7);
    }
    return html;
  }

  ScratchFolder folder_;
};

TEST_F(Report, HoldsTextsVolumesSectionsAndPicturesInOneFile) {
  const DocumentSnapshot document = snapshot();
  const ReportContent content = report_content(document);
  const std::string html = report_html(document, content, {"Fathom test", false, {}});
  EXPECT_NE(html.find("Smith &amp; &lt;script&gt;"), std::string::npos);
  EXPECT_EQ(html.find("<script>"), std::string::npos) << "what people type is not run";
  const std::size_t first =
      html.find("<tr><td>quadric planimetry</td><td>8.00</td></tr>\n<tr><td>its 95 % interval</td>");
  EXPECT_NE(first, std::string::npos) << "the number to quote comes first, with its interval";
  EXPECT_LT(first, html.find("<tr><td>linear planimetry</td><td>8.00</td></tr>"));
  EXPECT_NE(html.find("how much of it lies before that frame cannot be told"), std::string::npos) << "missing ends";
  EXPECT_NE(html.find("fill=\"#10c020\""), std::string::npos) << "the graph of areas";
  // Eleven sections of 2 cm2, 4 mm apart.
  EXPECT_NE(html.find("<tr><td>1</td><td>1</td><td>10</td><td>40.0</td><td>2.00</td></tr>"), std::string::npos);
  EXPECT_NE(html.find("still large"), std::string::npos) << "warnings";
  EXPECT_NE(html.find("Fathom test"), std::string::npos);
  const auto count = [&](const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = html.find(what); at != std::string::npos; at = html.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<img "), 2u);
  EXPECT_EQ(count("src=\"data:image/png;base64,"), 2u) << "no other file is needed";
  EXPECT_EQ(words(html).find("http"), std::string::npos);
}

TEST_F(Report, AnonymousTellsNoNames) {
  const DocumentSnapshot document = snapshot();
  ReportContent content = report_content(document);
  content.results[0].measurement.warnings.push_back(document.scan->recordings[0]->name() + ": a fault");
  const std::string html = words(report_html(document, content, anonymous()));
  for (const char* name : {"mith", "Jones", "2026"}) EXPECT_EQ(html.find(name), std::string::npos) << name;
  EXPECT_NE(html.find("recording 1: a fault"), std::string::npos);
}

TEST_F(Report, AnonymousPicturesAreBlackOutsideOfTheArea) {
  const DocumentSnapshot document = snapshot();
  const MaskedRecording masked(*document.scan->recordings[0], *anonymous().area, "masked");
  const cv::Mat image = masked.image(3);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) ASSERT_EQ(image.at<unsigned char>(y, x), y < 20 ? 0 : 90);
  }
  EXPECT_TRUE(masked.header().fields.empty());
  EXPECT_TRUE(masked.header().frames[2].fields.empty());
  EXPECT_EQ(masked.header().frames[2].poses, document.scan->recordings[0]->header().frames[2].poses);
  ReportOptions options = anonymous();
  EXPECT_FALSE(outlines_picture(document, 0, options).empty());
  options.area.reset();
  EXPECT_TRUE(outlines_picture(document, 0, options).empty()) << "unknown what may be shown: nothing is";
  EXPECT_FALSE(message_of<Error>([&] {
                 MaskedRecording(*document.scan->recordings[0], {{0, 0, 300, 80}, {}}, "masked");
               }).empty());
}

TEST_F(Report, AnExportedExamHasNoNamesAndTheSameVolumes) {
  const DocumentSnapshot document = snapshot();
  ExportOptions options;
  options.report = anonymous();
  options.recordings = true;
  const std::vector<std::string> names = export_exam(document, folder_ / "out", options);
  EXPECT_EQ(names, (std::vector<std::string>{"results.json", "results.csv", "report.html", "surface.ply", "surface.png",
                                             "outlines.png", "exam"}));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "out")) {
    EXPECT_EQ(entry.path().filename().string().find("smith"), std::string::npos);
    if (!entry.is_regular_file() || entry.path().extension() == ".png") continue;
    const std::string content = words(content_of(entry.path()));
    for (const char* name : {"mith", "Jones", "2026-01"}) EXPECT_EQ(content.find(name), std::string::npos) << entry;
  }
  DocumentOptions plain;
  plain.autosave = false;
  const DocumentSnapshot copy = Document(folder_ / "out" / "exam", plain).snapshot();
  EXPECT_EQ(measure_document(copy)[0].measurement.volumes.cubic_ml,
            measure_document(document)[0].measurement.volumes.cubic_ml);
  options.report.area.reset();
  EXPECT_FALSE(message_of<Error>([&] { export_exam(document, folder_ / "other", options); }).empty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other"));
}

TEST_F(Report, ResultsAsCsvHaveALineForEachStructure) {
  StructureResult result;
  result.name = "cyst, \"left\"";
  result.measurement.sections = 7;
  result.measurement.volumes.cubic_ml = 12.5;
  result.measurement.warnings = {"one", "two"};
  const std::string csv = results_csv({result});
  const std::size_t second = csv.find("\r\n") + 2;
  const std::string head = csv.substr(0, second);
  const std::string line = csv.substr(second);
  EXPECT_EQ(line.rfind("\"cyst, \"\"left\"\"\",,7,", 0), 0u) << line;
  EXPECT_NE(line.find(",12.5,"), std::string::npos);
  EXPECT_NE(line.find(",\"one; two\"\r\n"), std::string::npos);
  EXPECT_EQ(std::count(head.begin(), head.end(), ','), std::count(line.begin(), line.end(), ',') - 1);
}

TEST(Base64, IsThatOfRfc4648) {
  const auto of = [](const std::string& text) {
    return base64({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
  };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace fathom
