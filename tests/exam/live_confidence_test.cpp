#include "exam/live_confidence.h"

#include <gtest/gtest.h>

#include "exam/area_graph.h"
#include "exam/results_export.h"
#include "tests/exam/box_exam.h"

namespace fathom {
namespace {

class ConfidenceOfADocument : public ::testing::Test {
 protected:
  ConfidenceOfADocument() {
    make_box_exam(folder_);
    DocumentOptions options;
    options.autosave = false;
    document_ = std::make_unique<Document>(folder_ / "exam", options);
  }

  bool is_current(LiveConfidences& live) const { return live.of(0).revision == document_->result_revision(0); }

  ScratchFolder folder_;
  std::unique_ptr<Document> document_;
  Worker worker_;
};

TEST_F(ConfidenceOfADocument, IsWhatMeasuringTheExamGivesAndFollowsEdits) {
  LiveConfidences live(*document_, worker_);
  for (int edit = 0; edit < 3; ++edit) {
    live.request();
    EXPECT_FALSE(is_current(live)) << "no frame waits for it";
    worker_.finish();
    ASSERT_TRUE(is_current(live));
    const Confidence expected = measure_document(document_->snapshot())[0].confidence;
    const Confidence& known = live.of(0).confidence;
    ASSERT_TRUE(known.interval && expected.interval);
    EXPECT_EQ(known.interval->low_ml, expected.interval->low_ml);
    EXPECT_EQ(known.interval->high_ml, expected.interval->high_ml);
    ASSERT_EQ(known.missing_ends.size(), expected.missing_ends.size());
    ASSERT_EQ(known.next.has_value(), expected.next.has_value());
    if (known.next) {
      EXPECT_EQ(known.next->frame, expected.next->frame);
    }
    // A larger outline makes the sections less even.
    const Contour& contour = document_->structures()[0].contours[4];
    document_->move_point(0, 4, 0, contour.points_px[0] - Eigen::Vector2d(8.0 * (edit + 1), 0.0));
    EXPECT_FALSE(is_current(live)) << "what is of another state is not shown";
  }
}

TEST_F(ConfidenceOfADocument, SeveralSweepsHaveNoneAndSayWhy) {
  LiveConfidences live(*document_, worker_);
  document_->set_sweeps({{0, 0, 4}, {0, 5, 10}});
  live.request();
  EXPECT_TRUE(is_current(live));
  EXPECT_FALSE(live.of(0).confidence.interval);
  EXPECT_NE(live.of(0).fault.find("several sweeps"), std::string::npos) << live.of(0).fault;
  document_->undo();
  live.request();
  worker_.finish();
  EXPECT_TRUE(live.of(0).confidence.interval);
}

TEST_F(ConfidenceOfADocument, CancelledIsNotStartedAgainUntilTheStructureChanges) {
  LiveConfidences live(*document_, worker_);
  live.request();
  live.cancel(0);
  worker_.finish();
  live.request();
  EXPECT_TRUE(worker_.idle());
  EXPECT_TRUE(live.of(0).cancelled);
  EXPECT_FALSE(live.of(0).confidence.interval);
  document_->move_point(0, 4, 0, {50.0, 40.0});
  live.request();
  worker_.finish();
  EXPECT_FALSE(live.of(0).cancelled);
  EXPECT_TRUE(live.of(0).confidence.interval);
}

// The path's points must lie where the axes say that the values are.
TEST(AreaGraph, DrawsSectionsAtTheirPlaces) {
  const std::vector<SectionRow> rows{{0, 0, 3, 0.0, 0.0}, {0, 0, 5, 4.0, 20.0}, {0, 0, 9, 2.0, 40.0}};
  const std::string svg = area_graph_svg(rows, "#10c020");
  // Ticks of 5 up to 40 mm over 564 units and of 0.5 up to 4 cm2 over 148 units.
  EXPECT_NE(svg.find("d=\"M56.0 160.0L338.0 12.0L620.0 86.0\""), std::string::npos) << svg;
  EXPECT_NE(svg.find(">3.5</text>"), std::string::npos) << svg;
  EXPECT_NE(svg.find(">frame 5</title>"), std::string::npos);
  EXPECT_EQ(area_graph_svg({}, "#10c020"), "");
  EXPECT_EQ(area_graph_svg(std::vector<SectionRow>{{0, 0, 3, 2.0, 0.0}}, "#10c020"), "") << "one point is no line";
}

}  // namespace
}  // namespace fathom
