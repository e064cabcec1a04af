#include "exam/document.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "core/text_file.h"
#include "exam/make_exam.h"
#include "tests/exam/box_exam.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

class Documents : public ::testing::Test {
 protected:
  Documents() { make_box_exam(folder_); }

  std::filesystem::path exam() const { return folder_ / "exam"; }
  static std::string bytes(const Document& document) {
    return contours_json(document.structures()) + digest_text(document.content());
  }

  ScratchFolder folder_;
};

Contour triangle(int frame, double at) { return {frame, {{at, 10}, {at + 30, 12}, {at + 9, 40}}, true, {}, 0}; }

// Two hundred actions of all kinds, as a person without a plan would do them. Some are refused.
void work_at_random(Document& document, std::uint64_t seed) {
  Random random(seed);
  const auto below = [&](std::size_t n) {
    return n == 0 ? 0 : static_cast<std::size_t>(random.uniform() * static_cast<double>(n));
  };
  for (int i = 0; i < 200; ++i) {
    const std::size_t s = below(document.structures().size());
    const Eigen::Vector2d point(200.0 * random.uniform(), 100.0 * random.uniform());
    const int frame = static_cast<int>(below(11));
    const std::size_t contours = document.structures().empty() ? 0 : document.structures()[s].contours.size();
    const std::size_t c = below(contours);
    try {
      switch (below(14)) {
        case 0:
          document.add_structure({"organ " + std::to_string(i), "", {triangle(frame, 20)}, {}, {}});
          break;
        case 1:
          document.remove_structure(s);
          break;
        case 2:
          document.rename_structure(s, "name " + std::to_string(below(5)));
          break;
        case 3:
          document.recolor_structure(s, "#00ff0" + std::to_string(below(9)));
          document.set_opacity(s, 0.25 * static_cast<double>(below(5)));
          break;
        case 4:
          document.add_contour(s, triangle(frame, point.x()));
          break;
        case 5:
          document.remove_contour(s, c);
          break;
        case 6:
          document.move_point(s, c, below(3), point);
          break;
        case 7:
          document.insert_point(s, c, below(4), point);
          break;
        case 8:
          document.remove_point(s, c, below(4));
          break;
        case 9:
          document.set_absent(s, 0, frame, below(2) == 0);
          break;
        case 10:
          document.set_extremity(s, 0, frame, point);
          break;
        case 11:
          document.add_plane(
              DividingPlane(Eigen::Vector3d(random.normal(), 1, 2).normalized(), 20.0 * random.normal()));
          break;
        case 12:
          document.split_sweep(0, 1 + frame);
          break;
        default:
          document.set_text(ExamText::kNotes, "note " + std::to_string(i));
          break;
      }
    } catch (const Error&) {
      continue;
    }
  }
}

TEST_F(Documents, UndoToNothingAndRedoGiveTheSameBytes) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Document document(exam());
    const std::string before = bytes(document);
    work_at_random(document, seed);
    const std::string after = bytes(document);
    ASSERT_NE(after, before);
    ASSERT_GT(document.history().edits().size(), 60u);
    while (document.undo()) {
    }
    EXPECT_EQ(bytes(document), before);
    EXPECT_FALSE(document.is_modified());
    while (document.redo()) {
    }
    EXPECT_EQ(bytes(document), after);
  }
}

TEST_F(Documents, CanBeUndoneAfterSavingAndOpening) {
  std::string before;
  std::string after;
  {
    Document document(exam());
    before = bytes(document);
    work_at_random(document, 3);
    document.undo();
    after = bytes(document);
    document.save();
    EXPECT_FALSE(document.is_modified());
  }
  Document document(exam());
  EXPECT_TRUE(document.messages().empty()) << document.messages().front();
  EXPECT_EQ(bytes(document), after);
  EXPECT_TRUE(document.redo()) << "what was undone before saving";
  while (document.undo()) {
  }
  EXPECT_EQ(bytes(document), before);
  document.save();
  EXPECT_EQ(bytes(Document(exam())), before);
}

TEST_F(Documents, AnActionThatChangesNothingLeavesNoTrace) {
  Document document(exam());
  const auto revision = document.revision();
  document.set_absent(0, 0, 10, false);
  document.rename_structure(0, "box");
  document.set_text(ExamText::kPatient, "");
  document.move_point(0, 3, 1, document.structures()[0].contours[3].points_px[1]);
  EXPECT_EQ(document.revision(), revision);
  document.begin_action("Drag");
  const Eigen::Vector2d start = document.structures()[0].contours[3].points_px[1];
  for (int i = 1; i <= 20; ++i) document.move_point(0, 3, 1, start + Eigen::Vector2d(i, 0));
  document.move_point(0, 3, 1, start);
  EXPECT_FALSE(document.end_action()) << "dragged back to where it began";
  document.begin_action("Draw and think again");
  const std::size_t contour = document.add_contour(0, triangle(4, 20));
  document.remove_contour(0, contour);
  EXPECT_FALSE(document.end_action());
  EXPECT_FALSE(document.undo_name());
  EXPECT_FALSE(document.is_modified());
}

TEST_F(Documents, ADragIsOneAction) {
  Document document(exam());
  const std::string before = bytes(document);
  document.begin_action("Drag point");
  for (int i = 1; i <= 500; ++i) document.move_point(0, 3, 1, {100.0 + 0.1 * i, 40.0});
  EXPECT_TRUE(document.is_modified()) << "while it goes on";
  EXPECT_TRUE(document.end_action());
  EXPECT_EQ(document.history().edits().size(), 1u);
  EXPECT_LT(document.history().bytes(), 1500u) << "two outlines, not five hundred";
  EXPECT_EQ(document.undo_name(), "Drag point");
  document.undo();
  EXPECT_EQ(bytes(document), before);
  document.begin_action("Drag point");
  document.move_point(0, 3, 1, {150, 40});
  document.cancel_action();
  EXPECT_EQ(bytes(document), before);
  EXPECT_EQ(document.redo_name(), "Drag point") << "nothing was done instead";
}

TEST_F(Documents, TellsWhatChanged) {
  Document document(exam());
  document.add_structure({"other", "", {}, {}, {}});
  const auto id = document.content().ids[1];
  const auto box = document.structure_revision(0);
  const auto other = document.structure_revision(1);
  const auto division = document.division_revision();
  document.add_contour(1, triangle(2, 50));
  EXPECT_EQ(document.structure_revision(0), box);
  EXPECT_GT(document.structure_revision(1), other);
  EXPECT_EQ(document.division_revision(), division);
  const auto drawn = document.structure_revision(1);
  document.undo();
  EXPECT_GT(document.structure_revision(1), drawn) << "undoing is a change";
  const auto seen = document.revision();
  document.set_opacity(1, 0.25);
  document.recolor_structure(1, "#112233");
  EXPECT_GT(document.revision(), seen);
  EXPECT_EQ(document.structure_revision(0), box) << "how it looks is no matter of volumes and surfaces";
  EXPECT_GT(document.revision(), document.structure_revision(1));
  document.split_sweep(0, 5);
  EXPECT_GT(document.division_revision(), division);
  document.remove_structure(0);
  EXPECT_EQ(document.index_of(id), 0u) << "a selection follows its structure";
  document.remove_structure(0);
  EXPECT_FALSE(document.index_of(id));
  document.undo();
  document.undo();
  EXPECT_EQ(document.index_of(id), 1u);
}

TEST_F(Documents, RefusesWhatAnExamCannotHoldAndStaysAsItWas) {
  Document document(exam());
  document.add_structure({"other", "", {}, {}, {}});
  const std::string before = bytes(document);
  const auto refused = [&](auto command) {
    EXPECT_FALSE(message_of<Error>([&] { command(); }).empty());
    EXPECT_EQ(bytes(document), before);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([&] { document.add_structure({"box", "", {}, {}, {}}); });
  refused([&] { document.add_structure({"new", "red", {}, {}, {}}); });
  refused([&] { document.add_structure({"new\n", "", {}, {}, {}}); });
  refused([&] { document.add_structure({"new", "", {triangle(99, 0)}, {}, {}}); });
  refused([&] { document.rename_structure(0, "other"); });
  refused([&] { document.add_contour(0, {2, {{1, 1}, {2, 2}}, true, {}, 0}); });
  refused([&] { document.add_contour(0, triangle(-1, 0)); });
  refused([&] { document.add_contour(7, triangle(1, 0)); });
  refused([&] { document.add_contour(0, {2, {{1, 1}, {2, 2}, {nan, 1}}, true, {}, 0}); });
  refused([&] { document.add_contour(0, {2, {{1, 1}, {2, 2}, {3, 1}}, true, {}, 1}); });
  refused([&] { document.move_point(0, 0, 9, {1, 1}); });
  refused([&] { document.move_point(0, 0, 0, {1e7, 1}); });
  refused([&] { document.set_absent(0, 0, 3, true); });
  refused([&] { document.set_extremity(0, 0, 3, Eigen::Vector2d(1, 1)); });
  refused([&] { document.split_sweep(3, 1); });
  refused([&] { document.move_plane(0, DividingPlane(Eigen::Vector3d::UnitX(), 0.0)); });
  refused([&] { document.add_plane(DividingPlane(Eigen::Vector3d(nan, 0, 0), 0.0)); });
  refused([&] { document.set_text(ExamText::kNotes, "\xff\xfe"); });
  refused([&] { document.save_as(exam()); });
}

TEST_F(Documents, ForgetsTheOldestActionsBeyondTheBudget) {
  DocumentOptions options;
  options.history_bytes = 20'000;
  Document document(exam(), options);
  for (int i = 0; i < 200; ++i) document.move_point(0, 3, 1, {100.0 + i, 40.0});
  EXPECT_LE(document.history().bytes(), 20'000u);
  int undone = 0;
  while (document.undo()) ++undone;
  EXPECT_GT(undone, 10);
  EXPECT_LT(undone, 100);
  EXPECT_TRUE(document.is_modified()) << "what was forgotten is not undone";
}

TEST_F(Documents, OfARecordingBecomesAnExamOfItsOwn) {
  DocumentOptions options;
  options.calibration = folder_ / "probe.json";
  Document document(folder_ / "box.mha", options);
  EXPECT_TRUE(document.is_calibrated());
  document.add_structure(box_structure());
  EXPECT_FALSE(message_of<Error>([&] { document.save(); }).empty());
  document.set_text(ExamText::kPatient, "P-1");
  document.save_as(folder_ / "made");
  EXPECT_FALSE(document.is_modified());
  document.add_contour(0, triangle(2, 150));
  document.save();
  const std::string saved = bytes(document);
  std::filesystem::remove(folder_ / "box.mha");
  std::filesystem::remove(folder_ / "probe.json");
  std::filesystem::rename(folder_ / "made", folder_ / "moved");
  Document moved(folder_ / "moved");
  EXPECT_EQ(bytes(moved), saved) << "nothing outside of the folder is needed";
  EXPECT_EQ(moved.text(ExamText::kPatient), "P-1");
  EXPECT_TRUE(moved.undo());
  EXPECT_TRUE(moved.undo());
}

TEST_F(Documents, LeaveOutAHistoryThatDoesNotFit) {
  Document(exam()).save();
  {
    Document document(exam());
    document.add_contour(0, triangle(2, 150));
    document.save();
  }
  const std::filesystem::path file = exam() / "history.json";
  const std::string whole = content_of(file);
  const auto left_out = [&](const std::string& text) {
    put(file, text);
    Document document(exam());
    EXPECT_EQ(document.messages().size(), 1u) << text;
    EXPECT_FALSE(document.undo_name());
    EXPECT_EQ(document.structures()[0].contours.size(), 12u);
  };
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    left_out(text.replace(at, from.size(), to));
  };
  left_out("");
  left_out(whole.substr(0, whole.size() / 2));
  changed("\"fathom_history\": 1", "\"fathom_history\": 2");
  changed("\"done\": 1", "\"done\": 2");
  changed("\"contour\": 3", "\"contour\": 4");
  changed("\"structure\": 0", "\"structure\": 1");
  changed("\"frame\": 2", "\"frame\": 2000000");
  changed("150", "151");
  changed("\"content\": \"", "\"content\": \"0");
  changed("\"ids\": [1", "\"ids\": [1, 1");
  put(file, whole);
  // Another program changed the outlines.
  std::string outlines = content_of(exam() / "contours.json");
  const auto at = outlines.find("60");
  put(exam() / "contours.json", outlines.replace(at, 2, "61"));
  Document document(exam());
  EXPECT_EQ(document.messages().size(), 1u);
  EXPECT_FALSE(document.undo_name());
}

TEST_F(Documents, AreNotOpenedFromDamagedExams) {
  const std::string whole = content_of(exam() / "exam.json");
  put(exam() / "exam.json", std::string(whole).replace(whole.find("\"fathom_exam\": 1"), 16, "\"fathom_exam\": 9"));
  EXPECT_NE(message_of<Error>([&] { Document{exam()}; }).find("exam.json"), std::string::npos);
  put(exam() / "exam.json", whole.substr(0, whole.size() / 2));
  EXPECT_NE(message_of<Error>([&] { Document{exam()}; }).find("exam.json"), std::string::npos);
  put(exam() / "exam.json", whole);
  std::filesystem::rename(exam() / "box.mha", exam() / "gone.mha");
  EXPECT_NE(message_of<Error>([&] { Document{exam()}; }).find("box.mha"), std::string::npos);
}

TEST_F(Documents, KeepTheOldFilesWhereSavingFails) {
  Document document(exam());
  document.add_contour(0, triangle(2, 150));
  const std::string outlines = content_of(exam() / "contours.json");
  const std::string description = content_of(exam() / "exam.json");
  std::filesystem::create_directory(exam() / "history.json");  // in the way
  EXPECT_FALSE(message_of<Error>([&] { document.save(); }).empty());
  EXPECT_EQ(content_of(exam() / "contours.json"), outlines);
  EXPECT_EQ(content_of(exam() / "exam.json"), description);
  EXPECT_TRUE(document.is_modified());
  std::filesystem::remove(exam() / "history.json");
  document.save();
  EXPECT_NE(content_of(exam() / "contours.json"), outlines);
}

TEST_F(Documents, DropResultsOfOtherOutlines) {
  {
    Document document(exam());
    document.set_results({{"structures", nlohmann::json::array()}});
    document.set_text(ExamText::kNotes, "measured");
    document.save();
  }
  EXPECT_FALSE(read_exam(exam()).results.is_null());
  Document document(exam());
  document.add_contour(0, triangle(2, 150));
  document.undo();
  document.save();
  EXPECT_FALSE(read_exam(exam()).results.is_null()) << "as they were measured";
  document.redo();
  document.save();
  EXPECT_TRUE(read_exam(exam()).results.is_null());
}

}  // namespace
}  // namespace fathom
