#include "exam/autosave.h"

#include <csignal>
#include <cstdlib>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/error.h"
#include "core/text_file.h"
#include "exam/document.h"
#include "exam/make_exam.h"
#include "exam/state_folder.h"
#include "tests/exam/box_exam.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

class Crash : public ::testing::Test {
 protected:
  Crash() { make_box_exam(folder_); }

  std::filesystem::path exam() const { return folder_ / "exam"; }

  // Lets a child process work on a document, and kills it when it says that it is done: as a crash would, nothing of
  // the program runs after that.
  template <typename Work>
  void killed_after(Work work) {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      const auto kept = work();  // open until the end
      wait_until_written();
      const char done = 1;
      if (::write(ends[1], &done, 1) != 1) ::_exit(2);
      for (;;) ::pause();
    }
    ::close(ends[1]);
    char done = 0;
    EXPECT_EQ(::read(ends[0], &done, 1), 1) << "the child did not do its work";
    ::close(ends[0]);
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status));
  }

  // Until the journals have not grown for a while: much sooner than the ten seconds that are promised.
  void wait_until_written() const {
    const auto size = [&] {
      std::uintmax_t sum = 0;
      for (const auto& folder : {exam(), folder_ / "state/fathom"}) {
        std::error_code code;
        for (const auto& file : std::filesystem::directory_iterator(folder, code)) sum += file.file_size(code);
      }
      return sum;
    };
    std::uintmax_t before = 0;
    for (int i = 0; i < 30 && before != size(); ++i) {
      before = size();
      ::usleep(200'000);
    }
  }

  ScratchFolder folder_;
};

Contour triangle(int frame, double at) { return {frame, {{at, 10}, {at + 30, 12}, {at + 9, 40}}, true, {}, 0}; }

void edit(Document& document) {
  document.add_contour(0, triangle(2, 150));
  document.add_structure({"other", "", {triangle(4, 20)}, {}, {}});
  document.set_text(ExamText::kNotes, "half done");
  document.undo();
  document.remove_contour(0, 0);
}

std::string bytes(const Document& document) {
  return contours_json(document.structures()) + document.text(ExamText::kNotes);
}

TEST_F(Crash, LosesNothingOfAnExam) {
  killed_after([&] {
    auto open = std::make_unique<Document>(exam());
    Document& document = *open;
    edit(document);
    return open;
  });
  DocumentOptions plain;
  plain.autosave = false;
  Document expected(exam(), plain);
  const std::string before = bytes(expected);
  edit(expected);

  Document document(exam());
  ASSERT_TRUE(document.unsaved_work());
  EXPECT_EQ(document.unsaved_work()->actions, 5u);
  EXPECT_EQ(bytes(document), before) << "the exam is as it was saved until the user says what he wants";
  document.recover();
  EXPECT_EQ(bytes(document), bytes(expected));
  EXPECT_TRUE(document.is_modified());
  while (document.undo()) {
  }
  EXPECT_EQ(bytes(document), before) << "what was recovered can be undone";
  while (document.redo()) {
  }
  document.save();
  EXPECT_FALSE(Document(exam()).unsaved_work());
  EXPECT_EQ(bytes(Document(exam())), bytes(expected));
}

TEST_F(Crash, AfterACrashDuringRecoveryLosesNothingEither) {
  killed_after([&] {
    auto open = std::make_unique<Document>(exam());
    Document& document = *open;
    document.add_contour(0, triangle(2, 150));
    return open;
  });
  killed_after([&] {
    auto open = std::make_unique<Document>(exam());
    Document& document = *open;
    document.recover();
    document.add_contour(0, triangle(3, 150));
    return open;
  });
  Document document(exam());
  document.recover();
  EXPECT_EQ(document.structures()[0].contours.size(), 13u);
}

TEST_F(Crash, KeepsWhatWasDoneAfterSaving) {
  std::string saved;
  killed_after([&] {
    auto open = std::make_unique<Document>(exam());
    Document& document = *open;
    edit(document);
    document.save();
    document.add_contour(0, triangle(3, 150));
    return open;
  });
  Document document(exam());
  EXPECT_EQ(document.structures().size(), 2u) << "as saved";
  ASSERT_TRUE(document.unsaved_work());
  document.recover();
  EXPECT_EQ(document.structures()[0].contours.size(), 12u);
}

// The disk holds the new files, but the journal was not dropped yet: its steps must not be done twice.
TEST_F(Crash, BetweenSavingAndDroppingTheJournalDoesNothingTwice) {
  killed_after([&] {
    auto open = std::make_unique<Document>(exam());
    Document& document = *open;
    document.add_contour(0, triangle(2, 150));
    const auto pending = document.begin_save();
    document.add_contour(0, triangle(3, 150));  // meanwhile
    pending->write();
    return open;
  });
  Document document(exam());
  EXPECT_EQ(document.structures()[0].contours.size(), 12u);
  document.recover();
  EXPECT_EQ(document.structures()[0].contours.size(), 13u);
}

TEST_F(Crash, KeepsAnActionThatIsStillGoingOn) {
  killed_after([&] {
    auto open = std::make_unique<Document>(exam());
    Document& document = *open;
    document.begin_action("Long drag");
    for (int i = 0; i < 14; ++i) {
      document.move_point(0, 3, 1, {100.0 + i, 40.0});
      document.poll();
      ::usleep(100'000);
    }
    return open;
  });
  Document document(exam());
  document.recover();
  EXPECT_GT(document.structures()[0].contours[3].points_px[1].x(), 105.0)
      << "nothing older than a second or two is lost";
  EXPECT_EQ(document.undo_name(), "Long drag");
}

TEST_F(Crash, LosesNothingOfARecordingThatIsNoExamYet) {
  DocumentOptions options;
  options.calibration = folder_ / "probe.json";
  killed_after([&] {
    auto open = std::make_unique<Document>(folder_ / "box.mha", options);
    Document& document = *open;
    document.add_structure(box_structure());
    document.add_contour(0, triangle(2, 150));
    return open;
  });
  const std::vector<UnsavedWork> found = find_unsaved_work();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].recordings, std::vector{folder_ / "box.mha"});
  Document document(folder_ / "box.mha", options);
  ASSERT_TRUE(document.unsaved_work());
  document.recover();
  EXPECT_EQ(document.structures()[0].contours.size(), 12u);
  EXPECT_TRUE(find_unsaved_work().empty()) << "it is being worked on";
  document.save_as(folder_ / "made");
  EXPECT_TRUE(find_unsaved_work().empty());
  EXPECT_EQ(Document(folder_ / "made").structures()[0].contours.size(), 12u);
}

TEST_F(Crash, LeavesALastLineThatIsNotWhole) {
  killed_after([&] {
    auto open = std::make_unique<Document>(exam());
    Document& document = *open;
    document.add_contour(0, triangle(2, 150));
    document.add_contour(0, triangle(3, 150));
    return open;
  });
  const std::string whole = content_of(exam() / "autosave.jsonl");
  put(exam() / "autosave.jsonl", whole.substr(0, whole.size() - 30));
  Document document(exam());
  document.recover();
  EXPECT_EQ(document.structures()[0].contours.size(), 12u) << "the first action";
  document.add_contour(0, triangle(4, 150));
  Document second(exam());
  EXPECT_FALSE(second.unsaved_work());
  EXPECT_EQ(second.messages().size(), 1u) << "it is open in another window";
}

TEST_F(Crash, OffersNothingAfterACleanEnd) {
  {
    Document document(exam());
    edit(document);
    ::usleep(200'000);
    EXPECT_TRUE(std::filesystem::exists(exam() / "autosave.jsonl"));
  }
  EXPECT_FALSE(std::filesystem::exists(exam() / "autosave.jsonl"));
  EXPECT_FALSE(Document(exam()).unsaved_work());
}

TEST_F(Crash, JournalsThatDoNotFitAreRefusedAndKept) {
  killed_after([&] {
    auto open = std::make_unique<Document>(exam());
    Document& document = *open;
    edit(document);
    return open;
  });
  const std::string whole = content_of(exam() / "autosave.jsonl");
  const auto refused = [&](const std::string& text) {
    put(exam() / "autosave.jsonl", text);
    Document document(exam());
    const std::string before = bytes(document);
    EXPECT_FALSE(message_of<Error>([&] { document.recover(); }).empty());
    EXPECT_EQ(bytes(document), before);
    EXPECT_FALSE(document.undo_name());
    EXPECT_EQ(content_of(exam() / "autosave.jsonl"), text);
  };
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    refused(text.replace(at, from.size(), to));
  };
  changed("\"fathom_autosave\":1", "\"fathom_autosave\":2");
  changed("\"content\":\"", "\"content\":\"0");
  changed("\"frame\": 2", "\"frame\": 200");
  changed("\"at\": 1", "\"at\": 7");
  changed("{\"do\"", "{\"dance\"");
  changed("{\"do\"", "[\"do\"");
  changed("\"points\": [[", "\"points\": [[[");
  refused(whole + std::string(100'000, '[') + "\n");
  refused("");
  put(exam() / "autosave.jsonl", whole);
  Document document(exam());
  document.discard_unsaved();
  EXPECT_FALSE(std::filesystem::exists(exam() / "autosave.jsonl"));
}

TEST_F(Crash, WorkThatNobodyAskedForIsPutAside) {
  killed_after([&] {
    auto open = std::make_unique<Document>(exam());
    Document& document = *open;
    edit(document);
    return open;
  });
  Document document(exam());
  document.add_contour(0, triangle(5, 150));
  EXPECT_TRUE(std::filesystem::exists(exam() / "autosave-1.jsonl"));
  EXPECT_EQ(document.messages().size(), 1u);
}

TEST_F(Crash, AFolderThatCannotBeWrittenStillOpens) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  std::filesystem::permissions(exam(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  {
    Document document(exam());
    edit(document);
    EXPECT_EQ(document.messages().size(), 1u) << "said once";
  }
  std::filesystem::permissions(exam(), std::filesystem::perms::owner_all);
}

TEST_F(Crash, RecentFilesAreListedOnceTheLastFirst) {
  EXPECT_TRUE(recent_files().empty());
  remember_recent(exam());
  remember_recent(folder_ / "box.mha");
  remember_recent(exam() / "exam.json");
  EXPECT_EQ(recent_files(), (std::vector{exam(), folder_ / "box.mha"}));
  std::filesystem::remove(folder_ / "box.mha");
  EXPECT_EQ(recent_files(), std::vector{exam()});
  put(folder_ / "state/fathom/recent.json", "{\"fathom_recent\": 1, \"files\": [7]}");
  EXPECT_TRUE(recent_files().empty());
}

}  // namespace
}  // namespace fathom
